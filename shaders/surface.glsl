// A pixel's visible surface as one texel of four words: the bits of a position in root coordinates, and a unit normal
// towards the viewer, folded onto a square (octahedral, Cigolle et al. 2014) with 16 and 15 bits. w is 0 where there is
// no surface.

vec2 wrap_fold(vec2 n) { return (1.0 - abs(n.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(n, vec2(0.0))); }

// The normal may have any length but 0.
uvec4 pack_surface(vec3 p, vec3 normal) {
  vec2 n = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
  if (normal.z < 0.0) n = wrap_fold(n);
  uvec2 q = uvec2(clamp(0.5 * n + 0.5, 0.0, 1.0) * vec2(65534.0, 32766.0) + 0.5);  // even: 0 stays 0
  return uvec4(floatBitsToUint(p), DMVV_SURFACE_BIT | q.y << 16u | q.x);
}

vec3 surface_position(uvec4 texel) { return uintBitsToFloat(texel.xyz); }

vec3 unfold(vec2 n) {
  float z = 1.0 - abs(n.x) - abs(n.y);
  if (z < 0.0) n = wrap_fold(n);
  return normalize(vec3(n, z));
}

vec3 surface_normal(uvec4 texel) {
  return unfold(vec2(texel.w & 0xffffu, texel.w >> 16u & 0x7fffu) / vec2(32767.0, 16383.0) - 1.0);
}
