// Projection onto a line as a matrix: I - d d^T; a tube.
vec3 d = normalize(vec3(1.0, 0.5, -0.3));
mat3 across = mat3(1.0) - outerProduct(d, d);
return length(across * p) - 0.3;
