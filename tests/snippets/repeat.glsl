// Spheres at the points of a lattice.
vec3 q = mod(p + 0.25, 0.5) - 0.25;
return length(q) - 0.15;
