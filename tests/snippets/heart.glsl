// Taubin's heart, an implicit sextic scaled by a bound of its gradient.
vec3 q = p.xzy * 1.4;
float a = q.x * q.x + 2.25 * q.y * q.y + q.z * q.z - 1.0;
float z3 = q.z * q.z * q.z;
return (a * a * a - q.x * q.x * z3 - 0.1125 * q.y * q.y * z3) * 0.05;
