// A bar bent in the xy plane.
float k = 0.8;
float c = cos(k * p.x), s = sin(k * p.x);
mat2 m = mat2(c, -s, s, c);
vec3 q = vec3(m * p.xy, p.z);
vec3 d = abs(q) - vec3(0.7, 0.12, 0.2);
return 0.6 * (min(max(d.x, max(d.y, d.z)), 0.0) + length(max(d, 0.0)));
