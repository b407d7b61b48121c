// Cellular noise (Worley 1996): the nearest of the jittered points of 27 cells.
vec3 jitter(ivec3 at) {
  uint h = uint(at.x * 7 + at.y * 157 + at.z * 113) * 2654435769u;
  return vec3(uvec3(h, h >> 8, h >> 16) & 255u) / 255.0;
}
// ---- body
vec3 x = p * 2.0;
ivec3 cell = ivec3(floor(x));
float nearest = 8.0;
for (int k = -1; k <= 1; ++k) {
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      ivec3 at = cell + ivec3(i, j, k);
      vec3 d = vec3(at) + jitter(at) - x;
      nearest = min(nearest, dot(d, d));
    }
  }
}
return 0.5 * sqrt(nearest) - 0.15;
