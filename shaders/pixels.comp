// Kernel `pixels`: the scene at the visible surface of the support mesh, one point a pixel. Comes after the evaluation.

layout(local_size_x = DMVV_PIXELS_GROUP_SIZE, local_size_y = DMVV_PIXELS_GROUP_SIZE) in;
layout(set = 1, binding = DMVV_BIND_POSITION, rgba32f) readonly uniform image2D position_image;
layout(set = 1, binding = DMVV_BIND_NORMAL, rgba16f) readonly uniform image2D normal_image;
layout(set = 1, binding = DMVV_BIND_COLOR, rgba32f) writeonly uniform image2D color_image;
layout(set = 1, binding = DMVV_BIND_REGION, r32ui) writeonly uniform uimage2D region_image;
layout(push_constant) uniform Params { PixelsParams params; };

// Share of a surface's colour that remains when it faces away from the light.
const float ambient = 0.35;

void main() {
  uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= params.width || pixel.y >= params.height) return;
  vec4 surface = imageLoad(position_image, ivec2(pixel));
  vec3 p = clamp(surface.xyz, params.bounds_lo.xyz, params.bounds_hi.xyz);
  if (surface.w > 0.5 && in_cube(p)) evaluate(p);
  vec4 rgba = vec4(0.0);
  if (hit_number != 0u) {
    rgba = color_of(hit_region, hit_p);
    vec3 normal = imageLoad(normal_image, ivec2(pixel)).xyz;
    float lit = ambient + (1.0 - ambient) * max(dot(normal, params.light.xyz), 0.0);
    rgba.rgb *= params.light.w != 0.0 ? lit : 1.0;
  }
  imageStore(color_image, ivec2(pixel), rgba);
  imageStore(region_image, ivec2(pixel), uvec4(hit_unfinished ? DMVV_UNFINISHED : hit_number));
}
