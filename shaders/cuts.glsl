// What the cuts leave. On a pixel's ray a plane leaves the depths t with t * along <= gap; divided by t, this is a
// comparison of two numbers that change evenly over the screen. Surface and shells compare the same numbers, so between
// mesh and caps no pixel is left open. Comes after shaders/raster.h.
layout(set = 0, binding = DMVV_RASTER_PARAMS, std140) uniform Raster { RasterParams raster; };

const uint any_cuts = 0xffffffffu;
layout(constant_id = DMVV_RASTER_CUTS) const uint compiled_cuts = any_cuts;

uint cut_count() { return compiled_cuts != any_cuts ? compiled_cuts : raster.cut_count; }

// The cuts, read once: lavapipe reads uniforms lane by lane, wherever they stand, which took longer than all else that is
// done to a pixel.
struct Cuts {
  uint count;  // of those that are asked
  vec4 a, b, c;
};

Cuts first_cuts(uint count) {
  const bool is_compiled = compiled_cuts != any_cuts;
  Cuts cuts = Cuts(count, vec4(0.0), vec4(0.0), vec4(0.0));
  if (is_compiled && compiled_cuts > 0u) cuts.a = raster.cuts[0].along;
  if (is_compiled && compiled_cuts > 1u) cuts.b = raster.cuts[1].along;
  if (is_compiled && compiled_cuts > 2u) cuts.c = raster.cuts[2].along;
  return cuts;
}

// How far beyond a plane a point is; at most 0: it is left.
float beyond(vec4 cut, vec2 at, float inverse_depth) {
  precise float beyond = cut.x * at.x + cut.y * at.y + cut.z - cut.w * inverse_depth;
  return beyond;
}

// Whether the planes leave a point; `at` is the pixel's middle, in pixels of the picture.
bool is_left(Cuts cuts, vec2 at, float inverse_depth) {
  float most = 0.0;
  if (compiled_cuts != any_cuts) {
    if (compiled_cuts > 0u && cuts.count > 0u) most = max(most, beyond(cuts.a, at, inverse_depth));
    if (compiled_cuts > 1u && cuts.count > 1u) most = max(most, beyond(cuts.b, at, inverse_depth));
    if (compiled_cuts > 2u && cuts.count > 2u) most = max(most, beyond(cuts.c, at, inverse_depth));
  } else {
    for (uint i = 0; i < cuts.count; ++i) most = max(most, beyond(raster.cuts[i].along, at, inverse_depth));
  }
  return most == 0.0;
}
