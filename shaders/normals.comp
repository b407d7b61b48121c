// Kernel `normals`: of pixels whose ray met something, which way it faces. Comes after the evaluation,
// shaders/gradient.glsl and shaders/ray.glsl.

void main() {
  const uint lane = gl_LocalInvocationID.x;
  const uvec2 pixel = tile_corner(live_tile()) + uvec2(lane % DMVV_RAY_TILE, lane / DMVV_RAY_TILE);
  if (!is_in_picture(pixel)) return;
  if ((imageLoad(ray_notes, ivec2(pixel)).x & DMVV_NOTE_NORMAL) == 0u) return;
  vec3 p = surface_position(imageLoad(surface_image, ivec2(pixel)));
#ifdef DMVV_MEDIA
  evaluate(p);
#else
  occupancy(p);
#endif
  vec3 normal = normalize(decided_gradient()), along = ray_through(vec2(pixel)).along;
  if (!(dot(normal, normal) > 0.5)) normal = -along;  // a gradient of 0, or none
  if (dot(normal, along) > 0.0) normal = -normal;     // both sides can be seen
  imageStore(surface_image, ivec2(pixel), pack_surface(p, normal));
}
