// A triangle at a pixel, in homogeneous coordinates of the screen (Olano and Greer 1997): nothing is divided or clipped,
// whatever lies behind the eye. Comes after shaders/raster.h and shaders/cuts.glsl. The mesh is read from texels of storage texel
// buffers (DMVV_TEXELS), or from storage buffers, where texel buffers are short.
//
// An edge's sign is the same, turned, for both triangles that share it: it is computed from the two corners alone, by the
// same operations in the same order, and where it is 0, a pixel counts as lying a little further to the right, or down. So no
// pixel between them is missed or drawn twice. All of this is `precise`: kernels must agree to the bit.

#ifdef DMVV_TEXELS
layout(set = 0, binding = DMVV_RASTER_VERTICES, rgba32ui) readonly uniform uimageBuffer vertices;
layout(set = 0, binding = DMVV_RASTER_INDICES, r32ui) readonly uniform uimageBuffer indices;
uvec4 vertex_at(uint i) { return imageLoad(vertices, int(i)); }
uint index_at(uint i) { return imageLoad(indices, int(i)).x; }
#else
layout(set = 0, binding = DMVV_RASTER_VERTICES, std430) readonly buffer Vertices { uvec4 vertices[]; };
layout(set = 0, binding = DMVV_RASTER_INDICES, std430) readonly buffer Indices { uint indices[]; };
uvec4 vertex_at(uint i) { return vertices[i]; }
uint index_at(uint i) { return indices[i]; }
#endif
layout(set = 0, binding = DMVV_RASTER_SHELLS, std430) buffer Shells { int shells[]; };

// Of each corner: across and down (shaders/raster.h: right, down), both times its depth.
struct Triangle {
  vec3 x, y, w;
};

uvec4 corner_texel(uint triangle, uint corner) { return vertex_at(index_at(3u * triangle + corner)); }

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

// Where a triangle lies in the tile: in the pixels [lo, hi), and in each row between two lines on either side. A line is
// x = at + by * y, in pixels of the tile. A little more than the triangle: which pixels it covers their own weights tell.
struct Outline {
  ivec2 lo, hi;           // hi <= lo: nowhere
  bool is_turned_away;    // shows its back for certain; of others their pixels decide
  vec2 left_at, left_by, right_at, right_by;
};

const float unbounded = 1.0e9;

// Of what lies beyond the near plane. Corners are known to some units of float32, and so are lines that are not much
// shorter than the triangle is high; shorter ones bound nothing.
Outline outline_of(Screen screen, Triangle t) {
  float near = screen.near;
  vec2 from[3], to[3], lo = vec2(unbounded), hi = vec2(-unbounded), clipped = vec2(0.0);
  bool is_there[3], is_clipped = false;
  float farthest = 0.0;
  for (int i = 0; i < 3; ++i) {
    int j = i == 2 ? 0 : i + 1;
    vec3 p = vec3(t.x[i], t.y[i], t.w[i]), q = vec3(t.x[j], t.y[j], t.w[j]);
    bool sees_p = p.z >= near, sees_q = q.z >= near;
    vec2 crossing = mix(p.xy, q.xy, sees_p != sees_q ? (near - p.z) / (q.z - p.z) : 0.0) / near;
    from[i] = ((sees_p ? p.xy / p.z : crossing) + 1.0) / screen.scale - screen.corner;
    to[i] = ((sees_q ? q.xy / q.z : crossing) + 1.0) / screen.scale - screen.corner;
    is_there[i] = sees_p || sees_q;
    if (is_there[i]) lo = min(lo, min(from[i], to[i])), hi = max(hi, max(from[i], to[i]));
    if (sees_p != sees_q) {
      clipped = sees_p ? to[i] : from[i];
      farthest = max(farthest, max(max(abs(p.x), abs(p.y)), max(abs(q.x), abs(q.y))));
      is_clipped = true;
    }
  }
  vec2 margin = 1.0 / 64.0 + 1e-6 * farthest / (near * screen.scale);
  vec2 size = vec2(screen.size);
  Outline outline;
  outline.lo = ivec2(clamp(ceil(lo - margin), vec2(0.0), size));
  outline.hi = ivec2(clamp(floor(hi + margin) + 1.0, vec2(0.0), size));

  vec2 middle = is_clipped ? clipped : from[0];
  float twice_area = 0.0, around = 0.0;
  for (int i = 0; i < 3; ++i) {
    vec2 a = from[i] - middle, b = to[i] - middle;
    if (is_there[i]) twice_area += a.x * b.y - a.y * b.x, around += abs(a.x) + abs(a.y);
  }
  bool is_sure = abs(twice_area) > 1e-2 * around;
  outline.is_turned_away = !is_clipped && is_sure && twice_area > 0.0;

  outline.left_at = vec2(-unbounded), outline.left_by = vec2(0.0);
  outline.right_at = vec2(unbounded), outline.right_by = vec2(0.0);
  float rough = 1.0 / 64.0 + 2e-5 * max(max(size.x, max(-lo.x, hi.x)), max(-lo.y, hi.y)) + max(margin.x, margin.y);
  for (int i = 0; i < 3; ++i) {
    vec2 along = to[i] - from[i];
    bool bounds = is_sure && is_there[i] && abs(along.y) > (hi.y - lo.y) / 32.0;
    float by = bounds ? along.x / along.y : 0.0, at = from[i].x - by * from[i].y, beside = rough * (1.0 + abs(by));
    bool is_left = (along.y > 0.0) != (twice_area > 0.0);
    if (bounds && is_left) {
      outline.left_at = vec2(outline.left_at.y, at - beside);
      outline.left_by = vec2(outline.left_by.y, by);
    }
    if (bounds && !is_left) {
      outline.right_at = vec2(outline.right_at.y, at + beside);
      outline.right_by = vec2(outline.right_by.y, by);
    }
  }
  return outline;
}

// The pixels [x, y) of a row.
ivec2 row_of(Outline outline, int row) {
  vec2 left = outline.left_at + outline.left_by * float(row), right = outline.right_at + outline.right_by * float(row);
  float first = clamp(ceil(max(left.x, left.y)), float(outline.lo.x), float(outline.hi.x));
  float end = clamp(floor(min(right.x, right.y)) + 1.0, float(outline.lo.x), float(outline.hi.x));
  return ivec2(first, end);
}

uint pixel_index(Screen screen, uvec2 pixel) { return pixel.y * screen.size.x + pixel.x; }

layout(constant_id = DMVV_RASTER_COUNTS) const bool counts_shells = false;
