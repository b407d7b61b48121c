// Axis-aligned box. Exact, inside and outside.
vec3 q = abs(p) - vec3(0.6, 0.4, 0.5);
return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
