// A box whose size depends on time alone.
float s = 0.4 + 0.1 * sin(t * 0.001) * sin(t * 0.001);
vec3 q = abs(p) - vec3(s, 0.5, s * 0.5);
return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
