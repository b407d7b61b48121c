// Box with rounded edges: a smaller box, offset.
float radius = 0.1;
vec3 q = abs(p) - vec3(0.6, 0.4, 0.5) + radius;
return length(max(q, vec3(0.0))) + min(max(q.x, max(q.y, q.z)), 0.0) - radius;
