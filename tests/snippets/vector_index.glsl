// Components chosen by a computed index, read and written.
vec3 q = abs(p);
int largest = q.x > q.y ? (q.x > q.z ? 0 : 2) : (q.y > q.z ? 1 : 2);
q[largest] -= 0.3;
mat3 m = mat3(0.5);
m[1][2] = 0.25;
return length(m * q) - 0.2 + 0.1 * m[largest][largest];
