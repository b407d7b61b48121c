// The part of a pixel's ray that the cuts leave. All cuts are compared as depths along the ray: the mesh's fragments
// and the caps use the same numbers, so between them no pixel is left open.
layout(set = 0, binding = 0, std140) uniform Raster { RasterParams raster; };

const float never = 3.0e38;

// Depths [enter, leave] stay; nothing does if enter > leave. The planes are those that were crossed there.
struct Kept {
  float enter;
  float leave;
  uint enter_plane;
  uint leave_plane;
};

vec3 ray_direction(vec2 fragment) {
  vec2 pixel = fragment + vec2(raster.tile_x, raster.tile_y);
  precise vec3 direction = raster.ray.xyz + pixel.x * raster.ray_x.xyz + pixel.y * raster.ray_y.xyz;
  return direction;
}

Kept kept_part(vec3 direction) {
  Kept kept = Kept(-never, never, 0, 0);
  for (uint i = 0; i < raster.cut_count; ++i) {
    precise float along = dot(raster.cuts[i].plane.xyz, direction);
    float gap = raster.cuts[i].gap.x;
    if (gap < 0.0) {
      precise float t = along < 0.0 ? min(gap / along, never) : never;
      if (t > kept.enter) {
        kept.enter = t;
        kept.enter_plane = i;
      }
    } else if (along > 0.0) {
      precise float t = gap / along;
      if (t < kept.leave) {
        kept.leave = t;
        kept.leave_plane = i;
      }
    }
  }
  return kept;
}

// Where the solid is capped along this ray: where the ray comes into the kept part, or, if the eye is in it, goes out.
float cap_depth(Kept kept) { return raster.eye_removed != 0 ? kept.enter : kept.leave; }
