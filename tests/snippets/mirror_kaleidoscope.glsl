// Reflections in three planes, then a box.
vec3 n1 = normalize(vec3(1.0, 1.0, 0.0)), n2 = normalize(vec3(0.0, 1.0, -1.0));
p = reflect(p, n1 * step(dot(p, n1), 0.0));
p -= 2.0 * min(0.0, dot(p, n2)) * n2;
vec3 q = abs(p - vec3(0.3, 0.3, 0.1)) - vec3(0.2, 0.1, 0.25);
return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
