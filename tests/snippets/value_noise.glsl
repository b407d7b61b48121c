// Value noise on an integer lattice, hashed by the PCG permutation (O'Neill 2014): exact on every device.
ivec3 cell = ivec3(floor(p * 3.0));
vec3 f = fract(p * 3.0);
vec3 w = f * f * (3.0 - 2.0 * f);
float corner[8];
for (int i = 0; i < 8; ++i) {
  ivec3 at = cell + ivec3(i & 1, (i >> 1) & 1, i >> 2);
  uint h = uint(at.x) * 73856093u ^ uint(at.y) * 19349663u ^ uint(at.z) * 83492791u;
  h = h * 747796405u + 2891336453u;
  h = ((h >> ((h >> 28) + 4u)) ^ h) * 277803737u;
  h = (h >> 22) ^ h;
  corner[i] = float(h & 0xffffu) / 65535.0;
}
float x0 = mix(mix(corner[0], corner[1], w.x), mix(corner[2], corner[3], w.x), w.y);
float x1 = mix(mix(corner[4], corner[5], w.x), mix(corner[6], corner[7], w.x), w.y);
return length(p) - 0.6 - 0.1 * mix(x0, x1, w.z);
