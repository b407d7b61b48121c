// Quadratic julia set in the plane, lathed: while loop with two ways out.
vec2 z = vec2(length(p.xz), p.y) * 1.3;
float dz = 1.0;
int n = 0;
while (n < 8) {
  float m = dot(z, z);
  if (m > 16.0) break;
  dz = 2.0 * sqrt(m) * dz + 1e-3;
  z = vec2(z.x * z.x - z.y * z.y, 2.0 * z.x * z.y) + vec2(-0.4, 0.3);
  ++n;
}
float r = max(length(z), 1e-3);
return 0.3 * r * log(r + 1.0) / dz - 0.02;
