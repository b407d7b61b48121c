// Kernel `pixels`: the scene at the visible surface of the support mesh, one point a pixel. Comes after the evaluation
// and shaders/pixel_io.glsl. DMVV_QUERY_RADIUS: kernel `leaders`, which tells the pixel's tile as well. DMVV_STAGE: a stage of it
// alone; DMVV_STAGES_FOLLOW: from which pixels may go on.

#ifdef DMVV_STAGE
bool find_pixel(out uvec2 pixel) {
  uint i = gl_GlobalInvocationID.x;
  bool there = i < pixels_of_stage(DMVV_STAGE);
  pixel = unpack_pixel(pixel_of_stage(DMVV_STAGE, there ? i : 0u));
  return there;
}
#endif

void main() {
  uvec2 pixel;
  if (!find_pixel(pixel)) return;
  uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  vec3 p = surface_point(surface);
  if (surface.w != 0u && in_cube(p)) evaluate(p);
#ifdef DMVV_STAGES_FOLLOW
  if (hit_unfinished) next_stage = 0u;
  next_stages[gl_GlobalInvocationID.x] = next_stage;
  if (next_stage != 0u) return;
#endif
  vec4 color = color_of(hit_region, hit_p);
  vec4 rgba = hit_number != 0u ? shade(color, surface) : vec4(0.0);
  store_pixel(pixel, rgba, hit_number, hit_unfinished);
#ifdef DMVV_QUERY_RADIUS
  ivec2 tile = ivec2(pixel / DMVV_LEADER_TILE);
  bool is_known = in_cube(p) && !hit_unfinished && !(hit_number != 0u && has_bitmap(hit_region));
  imageStore(leader_place, tile, vec4(p, is_known ? reach : -1.0));
  imageStore(leader_color, tile, color);
  imageStore(leader_region, tile, uvec4(hit_number));
#endif
}
