// A 2D circle sector, extruded along z.
vec2 q = vec2(abs(p.x), p.y);
vec2 c = vec2(sin(0.9), cos(0.9));
float l = length(q) - 0.7;
float m = length(q - c * clamp(dot(q, c), 0.0, 0.7));
float flat_distance = max(l, m * sign(c.y * q.x - c.x * q.y));
vec2 w = vec2(flat_distance, abs(p.z) - 0.3);
return min(max(w.x, w.y), 0.0) + length(max(w, 0.0));
