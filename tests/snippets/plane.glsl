// A half space given by its normal.
vec3 n = normalize(vec3(1.0, 2.0, -0.5));
return dot(p, n) - 0.1;
