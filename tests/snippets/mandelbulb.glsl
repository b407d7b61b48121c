// Mandelbulb of power 8, distance estimate; leaves the loop when it escapes.
vec3 z = p * 1.2, c = z;
float dr = 1.0, r = length(z);
for (int i = 0; i < 4; ++i) {
  if (r > 2.0 || r < 1e-3) break;
  float theta = 8.0 * acos(clamp(z.z / r, -1.0, 1.0));
  float phi = 8.0 * atan(z.y, z.x + 1e-7);
  float r7 = pow(r, 7.0);
  dr = 8.0 * r7 * dr + 1.0;
  z = r7 * r * vec3(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)) + c;
  r = length(z);
}
return r < 1e-3 ? -0.1 : 0.4 * log(r) * r / dr;
