// Blinn's blobs (1982): sum of Gaussians over an array of centres.
vec3 centres[4] = vec3[4](vec3(-0.4, -0.2, 0.1), vec3(0.4, -0.1, -0.1), vec3(0.0, 0.45, 0.0), vec3(0.1, -0.4, 0.4));
float field = 0.0;
for (int i = 0; i < 4; ++i) {
  vec3 d = p - centres[i];
  field += exp(-8.0 * dot(d, d));
}
return (0.4 - field) * 0.2;
