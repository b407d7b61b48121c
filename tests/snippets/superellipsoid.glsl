// |x|^n + |y|^n + |z|^n (Barr 1981), n = 4 by pow.
vec3 q = abs(p / vec3(0.8, 0.6, 0.7));
float s = pow(q.x, 4.0) + pow(q.y, 4.0) + pow(q.z, 4.0);
return (sqrt(sqrt(s)) - 1.0) * 0.6;
