// Built-ins of optics as plain vector algebra.
vec3 n = normalize(p + vec3(1e-3, 2e-3, 1.5e-3));
vec3 r = refract(-n, faceforward(n, -n, n), 0.8);
return length(p + 0.2 * r) - 0.5 + 0.1 * distance(p, vec3(0.3));
