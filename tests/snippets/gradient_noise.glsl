// Gradient noise in the plane (Perlin 1985), its gradients by an integer hash; terrain.
float hash_angle(ivec2 at) {
  uint h = uint(at.x) * 374761393u + uint(at.y) * 668265263u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return float((h ^ (h >> 16)) & 0xffffu) * (6.2831853 / 65536.0);
}
float corner_value(ivec2 cell, vec2 f, ivec2 offset) {
  float a = hash_angle(cell + offset);
  return dot(vec2(cos(a), sin(a)), f - vec2(offset));
}
float noise(vec2 x) {
  ivec2 cell = ivec2(floor(x));
  vec2 f = fract(x);
  vec2 w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  return mix(mix(corner_value(cell, f, ivec2(0, 0)), corner_value(cell, f, ivec2(1, 0)), w.x),
             mix(corner_value(cell, f, ivec2(0, 1)), corner_value(cell, f, ivec2(1, 1)), w.x), w.y);
}
// ---- body
return 0.5 * (p.y - 0.3 * noise(p.xz * 2.5));
