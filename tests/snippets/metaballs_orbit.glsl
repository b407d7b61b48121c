// Balls on orbits whose phases differ: t-only values inside a loop over an array.
vec3 centres[3];
centres[0] = vec3(0.4 * cos(t * 0.001), 0.4 * sin(t * 0.001), 0.0);
centres[1] = vec3(0.0, 0.4 * cos(t * 0.0015 + 1.0), 0.4 * sin(t * 0.0015 + 1.0));
centres[2] = vec3(0.4 * sin(t * 0.002), 0.0, 0.4 * cos(t * 0.002));
float field = 0.0;
for (int i = 0; i < 3; i++) {
  vec3 d = p - centres[i];
  field += 0.06 / (dot(d, d) + 0.02);
}
return 0.6 - sqrt(field);
