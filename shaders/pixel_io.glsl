// What kernels over pixels share: which pixel is whose, and where the answer goes. Comes after shaders/records.h and
// shaders/surface.glsl.

layout(local_size_x = DMVV_PIXELS_GROUP_SIZE) in;
layout(constant_id = DMVV_CONST_LISTED) const bool listed = false;
layout(constant_id = DMVV_CONST_BYTES) const bool as_bytes = false;
layout(constant_id = DMVV_CONST_REGIONS) const bool with_regions = true;
#ifdef DMVV_DRAWS_SURFACE
layout(set = 1, binding = DMVV_BIND_SURFACE, rgba32ui) uniform uimage2D surface_image;
#else
layout(set = 1, binding = DMVV_BIND_SURFACE, rgba32ui) readonly uniform uimage2D surface_image;
#endif
layout(set = 1, binding = DMVV_BIND_COLOR, rgba32f) writeonly uniform image2D color_image;
layout(set = 1, binding = DMVV_BIND_BYTES, r32ui) writeonly uniform uimage2D bytes_image;
layout(set = 1, binding = DMVV_BIND_REGION, r32ui) writeonly uniform uimage2D region_image;
layout(set = 1, binding = DMVV_BIND_LIST, std430) buffer PixelList {
  PixelListHeader header;
  uint entries[];
} list;
layout(set = 1, binding = DMVV_BIND_KNOWN, std430) buffer Known { uint known_of[]; };
layout(set = 1, binding = DMVV_BIND_LEADER_PLACE, rgba32f) uniform image2D leader_place;
layout(set = 1, binding = DMVV_BIND_LEADER_COLOR, rgba32f) uniform image2D leader_color;
layout(set = 1, binding = DMVV_BIND_LEADER_REGION, r32ui) uniform uimage2D leader_region;
layout(set = 1, binding = DMVV_BIND_FRAME, std140) uniform FrameBlock { FrameParams frame; };
layout(push_constant) uniform StepBlock { StepParams this_step; };

uvec2 unpack_pixel(uint xy) { return uvec2(xy & 0xffffu, xy >> 16u); }

uvec2 listed_pixel(uint entry) { return unpack_pixel(list.entries[entry]); }

// The entry of pixel number i of a list.
uint entry_of(uint kind, uint i) {
  uint pixels = frame.width * frame.height;
  return kind == DMVV_TO_PAINT ? pixels - 1u - i : kind * pixels + i;
}

// The upper left pixel of a block; blocks follow each other row by row.
uvec2 block_corner(uint block) {
  uint blocks_x = (frame.width + DMVV_PIXELS_BLOCK - 1u) / DMVV_PIXELS_BLOCK;
  return uvec2(block % blocks_x, block / blocks_x) * DMVV_PIXELS_BLOCK;
}

bool is_in_picture(uvec2 pixel) { return pixel.x < frame.width && pixel.y < frame.height; }

// The pixel of this invocation; false: there is none.
#ifndef DMVV_STAGE
bool find_pixel(out uvec2 pixel) {
  uint i = gl_GlobalInvocationID.x;
  if (listed) {
    bool there = i < list.header.counts[this_step.listed_kind];
    pixel = listed_pixel(there ? entry_of(this_step.listed_kind, i) : 0u);
    return there;
  }
  uint within = i % DMVV_PIXELS_GROUP_SIZE;
  pixel = block_corner(i / DMVV_PIXELS_GROUP_SIZE) + uvec2(within % DMVV_PIXELS_BLOCK, within / DMVV_PIXELS_BLOCK);
  return is_in_picture(pixel);
}
#endif

// The point of root coordinates that a surface texel stands for.
vec3 surface_point(uvec4 surface) { return clamp(surface_position(surface), frame.bounds_lo.xyz, frame.bounds_hi.xyz); }

// Share of a surface's colour that remains when it faces away from the light.
const float ambient = 0.35;

vec4 shade(vec4 rgba, uvec4 surface) {
  float lit = ambient + (1.0 - ambient) * max(dot(surface_normal(surface), frame.light.xyz), 0.0);
  return vec4(frame.light.w != 0.0 ? rgba.rgb * lit : rgba.rgb, rgba.a);
}

// As runtime::to_byte rounds.
uint pack_bytes(vec4 rgba) {
  uvec4 b = uvec4(clamp(rgba, 0.0, 1.0) * 255.0 + 0.5);
  return b.r | b.g << 8u | b.b << 16u | b.a << 24u;
}

void store_pixel(uvec2 pixel, vec4 rgba, uint region, bool unfinished) {
  if (as_bytes) {
    imageStore(bytes_image, ivec2(pixel), uvec4(pack_bytes(rgba)));
  } else {
    imageStore(color_image, ivec2(pixel), rgba);
  }
  if (with_regions) imageStore(region_image, ivec2(pixel), uvec4(region));
  if (unfinished) atomicAdd(list.header.unfinished, 1u);
}
