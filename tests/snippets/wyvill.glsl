// Soft objects (Wyvill, McPheeters, Wyvill 1986): a cubic falloff that ends at a radius.
float field = 0.0;
for (int i = 0; i < 5; ++i) {
  float angle = 1.2566371 * float(i);
  vec3 d = p - 0.45 * vec3(cos(angle), sin(angle), 0.0);
  float x = dot(d, d) / 0.36;
  if (x < 1.0) {
    float y = 1.0 - x;
    field += y * y * y;
  }
}
return 0.2 * (0.3 - field);
