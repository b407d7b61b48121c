// Kernel `pixels`: the scene at the visible surface of the support mesh, one point a pixel. Comes after the evaluation
// and shaders/pixel_io.glsl.

void main() {
  uvec2 pixel;
  if (!find_pixel(pixel)) return;
  uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  vec3 p = surface_point(surface);
  if (surface.w != 0u && in_cube(p)) evaluate(p);
  vec4 rgba = hit_number != 0u ? shade(color_of(hit_region, hit_p), surface) : vec4(0.0);
  store_pixel(pixel, rgba, hit_number, hit_unfinished);
}
