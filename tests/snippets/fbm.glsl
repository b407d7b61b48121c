// Fractal sum of gradient-free noise: four octaves of value noise in the plane.
float lattice(ivec2 at) {
  uint h = uint(at.x * 1619 + at.y * 31337);
  h ^= h << 13;
  h ^= h >> 17;
  h ^= h << 5;
  return float(h % 1024u) / 1023.0;
}
float noise(vec2 x) {
  ivec2 i = ivec2(floor(x));
  vec2 f = smoothstep(0.0, 1.0, fract(x));
  float a = mix(lattice(i), lattice(i + ivec2(1, 0)), f.x);
  float b = mix(lattice(i + ivec2(0, 1)), lattice(i + ivec2(1, 1)), f.x);
  return mix(a, b, f.y);
}
// ---- body
float height = 0.0, amplitude = 0.5;
vec2 x = p.xz * 2.0;
for (int octave = 0; octave < 4; ++octave) {
  height += amplitude * noise(x);
  amplitude *= 0.5;
  x = mat2(1.6, 1.2, -1.2, 1.6) * x + 0.37;
}
return 0.5 * (p.y + 0.5 - height);
