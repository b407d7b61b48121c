// Distance to a triangle, thickened (Quilez, "Triangle").
vec3 a = vec3(-0.7, -0.5, 0.0), b = vec3(0.6, -0.4, 0.2), c = vec3(0.0, 0.7, -0.1);
vec3 ba = b - a, pa = p - a, cb = c - b, pb = p - b, ac = a - c, pc = p - c;
vec3 n = cross(ba, ac);
bool over = sign(dot(cross(ba, n), pa)) + sign(dot(cross(cb, n), pb)) + sign(dot(cross(ac, n), pc)) < 2.0;
vec3 e0 = ba * clamp(dot(ba, pa) / dot(ba, ba), 0.0, 1.0) - pa;
vec3 e1 = cb * clamp(dot(cb, pb) / dot(cb, cb), 0.0, 1.0) - pb;
vec3 e2 = ac * clamp(dot(ac, pc) / dot(ac, ac), 0.0, 1.0) - pc;
float edges = min(min(dot(e0, e0), dot(e1, e1)), dot(e2, e2));
float face = dot(n, pa) * dot(n, pa) / dot(n, n);
return sqrt(over ? edges : face) - 0.1;
