// What the cuts leave. On a pixel's ray a plane leaves the depths t with t * along <= gap; divided by t, this is a
// comparison of two numbers that change evenly over the screen, without a division for a fragment. Surface and count
// compare the same numbers, so between mesh and caps no pixel is left open.
layout(set = 0, binding = 0, std140) uniform Raster { RasterParams raster; };

// How many cuts there are, if the shader is made for so many; 0: for any number.
layout(constant_id = 0) const uint compiled_cuts = 0u;

uint cut_count() { return compiled_cuts != 0u ? compiled_cuts : raster.cut_count; }

// Of the undivided picture.
vec2 pixel_at(vec4 fragment) { return fragment.xy + vec2(raster.tile_x, raster.tile_y); }

// Whether the first `count` planes leave a point.
bool is_left(uint count, vec2 pixel, float inverse_depth) {
  float most = 0.0;
  for (uint i = 0; i < cut_count(); ++i) {
    vec4 cut = raster.cuts[i].along;
    precise float beyond = cut.x * pixel.x + cut.y * pixel.y + cut.z - cut.w * inverse_depth;
    most = i < count ? max(most, beyond) : most;
  }
  return most == 0.0;
}
