// A strip of square section that turns half a turn on its way around.
float a = atan(p.z, p.x);
vec2 q = vec2(length(p.xz) - 0.6, p.y);
float c = cos(a * 0.5), s = sin(a * 0.5);
q = abs(vec2(c * q.x + s * q.y, c * q.y - s * q.x)) - vec2(0.25, 0.06);
return 0.7 * (length(max(q, 0.0)) + min(max(q.x, q.y), 0.0));
