// Cubes where the bits of three integers agree: a voxel fractal by and, or, exclusive or and shifts.
ivec3 v = ivec3(clamp((p + 1.0) * 8.0, vec3(0.0), vec3(15.0)));
int filled = (v.x & v.y & v.z) == 0 ? 1 : 0;
int parity = (v.x ^ v.y ^ v.z) & 1;
int twisted = ~(v.x << 1 | v.z >> 1) & 3;
return filled == 1 ? -0.02 - 0.005 * float(parity) : 0.02 + 0.001 * float(twisted);
