// A sheared sphere, by the inverse of a matrix and its determinant.
mat3 shear = mat3(1.0, 0.2, 0.0, 0.3, 0.9, 0.1, 0.0, -0.2, 1.1);
vec3 q = inverse(shear) * p;
return (length(q) - 0.6) * 0.6 * pow(determinant(shear), 1.0 / 3.0);
