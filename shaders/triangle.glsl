// A triangle at a pixel, in homogeneous coordinates of the screen (Olano and Greer 1997): nothing is divided or clipped,
// whatever lies behind the eye. Comes after shaders/raster.h, shaders/cuts.glsl; needs
// GL_EXT_shader_explicit_arithmetic_types_int64 and GL_EXT_shader_atomic_int64.
//
// An edge's sign is the same, turned, for both triangles that share it: it is computed from the two corners alone, by the
// same operations in the same order, and where it is 0, a pixel counts as lying a little further to the right, or down. So no
// pixel between them is missed or drawn twice. All of this is `precise`: kernels must agree to the bit.

layout(set = 0, binding = DMVV_RASTER_VERTICES, rgba32ui) readonly uniform uimageBuffer vertices;
layout(set = 0, binding = DMVV_RASTER_INDICES, r32ui) readonly uniform uimageBuffer indices;
layout(set = 0, binding = DMVV_RASTER_NEAREST, std430) buffer Nearest { uint64_t nearest[]; };
layout(set = 0, binding = DMVV_RASTER_SHELLS, std430) buffer Shells { int shells[]; };

// Of each corner: across and down (shaders/raster.h: right, down), both times its depth.
struct Triangle {
  vec3 x, y, w;
};

uvec4 corner_texel(uint triangle, uint corner) {
  return imageLoad(vertices, int(imageLoad(indices, int(3u * triangle + corner)).x));
}

// What all pixels of a tile share, read once (shaders/cuts.glsl).
struct Screen {
  vec2 corner;  // the middle of the tile's first pixel, in pixels of the picture
  vec2 scale;   // -1..1 across the picture, by pixels
  uvec2 size;   // of the tile, pixels
  float near;
  vec3 eye, right, down, forward;  // shaders/raster.h
  bool from_outside;  // are caps seen
  Cuts all, before_cap;
};

Screen this_screen() {
  bool from_outside = raster.front_count != 0;
  return Screen(vec2(raster.tile.xy) + 0.5, 2.0 / raster.picture.xy, raster.tile.zw, raster.right.w, raster.eye.xyz, raster.right.xyz,
                raster.down.xyz, raster.forward.xyz, from_outside,
                first_cuts(cut_count()), first_cuts(from_outside ? raster.front_count : cut_count()));
}

vec3 on_screen(Screen screen, vec3 position) {
  precise vec3 from_eye = position - screen.eye;
  vec3 r = screen.right, d = screen.down, f = screen.forward;
  precise float x = r.x * from_eye.x + r.y * from_eye.y + r.z * from_eye.z;
  precise float y = d.x * from_eye.x + d.y * from_eye.y + d.z * from_eye.z;
  precise float w = f.x * from_eye.x + f.y * from_eye.y + f.z * from_eye.z;
  return vec3(x, y, w);
}

Triangle triangle_of(Screen screen, vec3 a, vec3 b, vec3 c) {
  vec3 p = on_screen(screen, a), q = on_screen(screen, b), r = on_screen(screen, c);
  return Triangle(vec3(p.x, q.x, r.x), vec3(p.y, q.y, r.y), vec3(p.z, q.z, r.z));
}

Triangle triangle_number(Screen screen, uint number) {
  return triangle_of(screen, uintBitsToFloat(corner_texel(number, 0u).xyz), uintBitsToFloat(corner_texel(number, 1u).xyz),
                     uintBitsToFloat(corner_texel(number, 2u).xyz));
}

// Of the edges opposite to the corners: a sign for where they are 0.
bvec3 counts_zero(Triangle t) {
  precise vec3 by_x = t.y.yzx * t.w.zxy - t.w.yzx * t.y.zxy;
  precise vec3 by_y = t.w.yzx * t.x.zxy - t.x.yzx * t.w.zxy;
  return bvec3(by_x.x > 0.0 || (by_x.x == 0.0 && by_y.x > 0.0), by_x.y > 0.0 || (by_x.y == 0.0 && by_y.y > 0.0),
               by_x.z > 0.0 || (by_x.z == 0.0 && by_y.z > 0.0));
}

// The corners' weights at a pixel, their sum not yet 1: the edges opposite to them.
vec3 weights_at(Triangle t, vec2 middle, vec2 scale) {
  precise vec2 at = middle * scale - 1.0;
  precise vec3 x = t.x - at.x * t.w, y = t.y - at.y * t.w;
  precise vec3 weights = x.yzx * y.zxy - y.yzx * x.zxy;
  return weights;
}

// Pixels [lo, hi) of the tile; hi <= lo: none.
struct Box {
  ivec2 lo, hi;
};

void include(inout vec2 lo, inout vec2 hi, vec2 p) {
  lo = min(lo, p);
  hi = max(hi, p);
}

// Around what of the triangle lies beyond the near plane.
Box box_of(Screen screen, Triangle t) {
  float near = screen.near;
  vec2 lo = vec2(3.0e38), hi = vec2(-3.0e38);
  float farthest = 0.0;
  for (int i = 0; i < 3; ++i) {
    int j = i == 2 ? 0 : i + 1;
    vec3 p = vec3(t.x[i], t.y[i], t.w[i]), q = vec3(t.x[j], t.y[j], t.w[j]);
    if (p.z >= near) include(lo, hi, p.xy / p.z);
    bool crosses = (p.z >= near) != (q.z >= near);
    float along = crosses ? (near - p.z) / (q.z - p.z) : 0.0;
    if (crosses) include(lo, hi, mix(p.xy, q.xy, along) / near);
    if (crosses) farthest = max(farthest, max(max(abs(p.x), abs(p.y)), max(abs(q.x), abs(q.y))));
  }
  vec2 margin_px = 1.0 / 64.0 + 1e-6 * farthest / (near * screen.scale);
  vec2 size = vec2(screen.size);
  vec2 first = ceil((lo + 1.0) / screen.scale - margin_px - screen.corner);
  vec2 end = floor((hi + 1.0) / screen.scale + margin_px - screen.corner) + 1.0;
  return Box(ivec2(clamp(first, vec2(0.0), size)), ivec2(clamp(end, vec2(0.0), size)));
}

uint pixel_index(Screen screen, uvec2 pixel) { return pixel.y * screen.size.x + pixel.x; }

layout(constant_id = DMVV_RASTER_COUNTS) const bool counts_shells = false;

// What a triangle does to a pixel; `drawn` is its number | DMVV_DRAWN_*.
void draw_at(Screen screen, uvec2 pixel, Triangle t, bvec3 zero, uint drawn) {
  vec2 middle = vec2(pixel) + screen.corner;
  vec3 weights = weights_at(t, middle, screen.scale);
  bvec3 positive = bvec3(weights.x > 0.0 || (weights.x == 0.0 && zero.x), weights.y > 0.0 || (weights.y == 0.0 && zero.y),
                         weights.z > 0.0 || (weights.z == 0.0 && zero.z));
  precise float sum = weights.x + weights.y + weights.z;
  precise float inverse_depth = sum / (weights.x * t.w.x + weights.y * t.w.y + weights.z * t.w.z);
  bool is_front = !any(positive), is_back = all(positive);
  bool covers = (is_front || is_back) && inverse_depth > 0.0 && inverse_depth * screen.near <= 1.0;
  bool is_cut = (drawn & DMVV_DRAWN_CUT) != 0u;
  if (counts_shells) {
    // The cap is where the ray comes into what is left, or, if the eye is in it, goes out.
    bool is_beyond = !is_cut || is_left(screen.before_cap, middle, inverse_depth) == screen.from_outside;
    bool is_shell = (drawn & DMVV_DRAWN_COUNTED) != 0u && is_beyond;
    if (covers && is_shell) atomicAdd(shells[pixel_index(screen, pixel)], is_back ? 1 : -1);
  }
  bool is_shown = (drawn & DMVV_DRAWN_SEEN) != 0u && (is_front || (drawn & DMVV_DRAWN_BACKS) != 0u);
  bool is_seen = is_shown && (!is_cut || is_left(screen.all, middle, inverse_depth));
  uint64_t key = uint64_t(floatBitsToUint(inverse_depth)) << 32 | uint64_t(~drawn & DMVV_DRAWN_TRIANGLE);
  if (covers && is_seen) atomicMax(nearest[pixel_index(screen, pixel)], key);
}
