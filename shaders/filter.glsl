// Distance values between texels, with float32 weights: for texture units whose weights are too coarse, and for what
// they do not do at all. In texels: c is the centre of the texel c. The atlas has the border that the filter needs.
// No loops: devices count the rounds of all loops together.

float grid_texel(ivec3 at) { return texelFetch(grid_atlas, at, 0).r; }

#ifdef DMVV_TRICUBIC
float cubic_row(ivec3 at, vec4 w) {
  return w.x * grid_texel(at) + w.y * grid_texel(at + ivec3(1, 0, 0)) + w.z * grid_texel(at + ivec3(2, 0, 0)) +
         w.w * grid_texel(at + ivec3(3, 0, 0));
}

float cubic_slice(ivec3 at, vec4 wx, vec4 wy) {
  return wy.x * cubic_row(at, wx) + wy.y * cubic_row(at + ivec3(0, 1, 0), wx) +
         wy.z * cubic_row(at + ivec3(0, 2, 0), wx) + wy.w * cubic_row(at + ivec3(0, 3, 0), wx);
}

// Catmull-Rom: of the samples at -1, 0, 1, 2 for a point between 0 and 1.
vec4 cubic_weights(float t) {
  return 0.5 * vec4(t * (t * (2.0 - t) - 1.0), 2.0 + t * t * (3.0 * t - 5.0), t * (1.0 + t * (4.0 - 3.0 * t)),
                    t * t * (t - 1.0));
}

float sample_grid(vec3 c) {
  vec3 base = floor(c);
  vec3 t = c - base;
  ivec3 at = ivec3(base) - 1;
  vec4 wx = cubic_weights(t.x);
  vec4 wy = cubic_weights(t.y);
  vec4 wz = cubic_weights(t.z);
  return wz.x * cubic_slice(at, wx, wy) + wz.y * cubic_slice(at + ivec3(0, 0, 1), wx, wy) +
         wz.z * cubic_slice(at + ivec3(0, 0, 2), wx, wy) + wz.w * cubic_slice(at + ivec3(0, 0, 3), wx, wy);
}
#else
float sample_grid(vec3 c) {
  vec3 base = floor(c);
  vec3 t = c - base;
  ivec3 at = ivec3(base);
  float v00 = mix(grid_texel(at), grid_texel(at + ivec3(1, 0, 0)), t.x);
  float v10 = mix(grid_texel(at + ivec3(0, 1, 0)), grid_texel(at + ivec3(1, 1, 0)), t.x);
  float v01 = mix(grid_texel(at + ivec3(0, 0, 1)), grid_texel(at + ivec3(1, 0, 1)), t.x);
  float v11 = mix(grid_texel(at + ivec3(0, 1, 1)), grid_texel(at + ivec3(1, 1, 1)), t.x);
  return mix(mix(v00, v10, t.y), mix(v01, v11, t.y), t.z);
}
#endif
