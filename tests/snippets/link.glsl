// A chain link: a torus stretched along y.
vec3 q = vec3(p.x, max(abs(p.y) - 0.3, 0.0), p.z);
return length(vec2(length(q.xy) - 0.35, q.z)) - 0.12;
