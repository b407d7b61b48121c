// Ellipsoid, first-order bound: k0 (k0 - 1) / k1 (Quilez, "Ellipsoid SDF").
vec3 r = vec3(0.8, 0.5, 0.35);
float k0 = length(p / r);
float k1 = length(p / (r * r));
return k1 > 0.0 ? k0 * (k0 - 1.0) / k1 : -0.35;
