// A box twisted around y.
float k = 1.5;
float c = cos(k * p.y), s = sin(k * p.y);
vec2 xz = mat2(c, -s, s, c) * p.xz;
vec3 q = abs(vec3(xz.x, p.y, xz.y)) - vec3(0.3, 0.7, 0.3);
return 0.6 * (length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0));
