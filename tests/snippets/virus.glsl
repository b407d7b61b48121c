// Spikes over a sphere: icosahedral directions in an array, the nearest found by dot products.
const float g = 0.85065081, h = 0.52573111;
vec3 axes[6] = vec3[6](vec3(0.0, h, g), vec3(0.0, -h, g), vec3(h, g, 0.0), vec3(-h, g, 0.0),
                         vec3(g, 0.0, h), vec3(g, 0.0, -h));
float d = length(p) - 0.5;
for (int i = 0; i < axes.length(); ++i) {
  float s = clamp(abs(dot(p, axes[i])), 0.4, 0.8);
  float side = dot(p, axes[i]) < 0.0 ? -1.0 : 1.0;
  d = min(d, length(p - side * s * axes[i]) - 0.07);
}
return d;
