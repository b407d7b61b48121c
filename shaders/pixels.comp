// Kernel `pixels`: the scene at the visible surface of the support mesh, one point a pixel. Comes after the evaluation
// and shaders/pixel_io.glsl.

// Share of a surface's colour that remains when it faces away from the light.
const float ambient = 0.35;

void main() {
  uvec2 pixel;
  if (!find_pixel(pixel)) return;
  uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  vec3 p = clamp(surface_position(surface), params.bounds_lo.xyz, params.bounds_hi.xyz);
  if (surface.w != 0u && in_cube(p)) evaluate(p);
  vec4 rgba = vec4(0.0);
  if (hit_number != 0u) {
    rgba = color_of(hit_region, hit_p);
    float lit = ambient + (1.0 - ambient) * max(dot(surface_normal(surface), params.light.xyz), 0.0);
    rgba.rgb *= params.light.w != 0.0 ? lit : 1.0;
  }
  store_pixel(pixel, rgba, hit_number, hit_unfinished);
}
