// The rays of a tile of the picture. Comes after shaders/rays.h and shaders/pixel_io.glsl.
layout(set = 1, binding = DMVV_BIND_RAYS, std140) uniform Rays { RayParams rays; };
layout(set = 1, binding = DMVV_BIND_RAY_NOTES, r32ui) uniform uimage2D ray_notes;
layout(set = 1, binding = DMVV_BIND_RAY_TILES, std430) buffer RayTiles {
  RayTilesHeader header;
  uint words[];
} tiles;

uint tile_count() { return rays.tiles_x * ((frame.height + DMVV_RAY_TILE - 1u) / DMVV_RAY_TILE); }
uvec2 tile_corner(uint tile) { return uvec2(tile % rays.tiles_x, tile / rays.tiles_x) * DMVV_RAY_TILE; }

// The tile of this group. A device of few threads gives each a row of groups that follow each other: neighbours take turns,
// so that all get their share of what takes long (measured: up to 1.6 times).
uint live_tile() {
  uint group = gl_WorkGroupID.x, half_of_them = (gl_NumWorkGroups.x + 1u) / 2u;
  uint turn = group < half_of_them ? 2u * group : 2u * (group - half_of_them) + 1u;
  return tiles.words[tile_count() + turn];
}

struct Ray {
  vec3 start, along;
};
Ray ray_through(vec2 pixel) {
  precise vec3 start = rays.start.xyz + pixel.x * rays.start_x.xyz + pixel.y * rays.start_y.xyz;
  precise vec3 along = rays.along.xyz + pixel.x * rays.along_x.xyz + pixel.y * rays.along_y.xyz;
  return Ray(start, along);
}

vec3 point_on(Ray ray, float s) {
  precise vec3 p = ray.start + s * ray.along;
  return p;
}

// Of the distance that an answer holds, and of what is computed from it.
const float safe = 0.9999;
// Root units by which two points of a ray can be told apart.
const float resolution = 3.0e-7;
const float nowhere = 3.0e38;
// What is thinner counts for nothing (compiler/rays/ray.h).
const float sure = 4.0e-6;
const int most_predictions = 6;
// What may be missed so near to a boundary, in widths of a pixel, is not looked for.
const float beside_boundary = 0.5;

// How far beside an expected boundary a ray is asked.
const float aside = 0.4 * sure;

// Where to ask next between two points of a ray whose answers differ: where their margins say that the boundary stands, first
// right behind it, then right before it; in the middle, if that has not helped.
float boundary_between(float before, float before_margin, float behind, float behind_margin, int refinements, float speed) {
  bool is_predicted = refinements < most_predictions;
  float share = is_predicted ? clamp(before_margin / (before_margin + behind_margin), 0.0, 1.0) : 0.5;
  float boundary = before + share * (behind - before), beside = aside / speed;
  boundary += !is_predicted ? 0.0 : behind - boundary > 2.0 * beside ? beside : -beside;
  return clamp(boundary, mix(before, behind, 0.01), mix(before, behind, 0.99));
}

// How far the ray goes through what is left of the scene.
struct Span {
  float first, last;  // s; first > last: not at all
  vec3 normal;        // of the plane through which it enters; 0: the eye is within
};

// What dot(n, x) <= d leaves of a ray.
void cut_span(inout Span span, Ray ray, vec3 n, float d) {
  float gap = d - dot(n, ray.start), speed = dot(n, ray.along);
  if (speed > 0.0) span.last = min(span.last, gap / speed);
  if (speed == 0.0 && gap < 0.0) span.last = -3.0e38;
  if (speed < 0.0 && gap / speed > span.first) {
    span.first = gap / speed;
    span.normal = n;
  }
}

// The least that holds all that it leaves of a tile's rays, which differ by `spread` at depth 1.
void cut_cone(inout Span span, Ray ray, vec3 n, float d, float spread) {
  float speed = dot(n, ray.along), least = speed - spread;
  float eye_gap = d - dot(n, ray.start) + rays.depth * speed;
  float error = 2e-6 * (abs(rays.depth * speed) + 1.0);
  if (eye_gap > error && least > 0.0) span.last = min(span.last, (eye_gap + error) / least - rays.depth);
  if (eye_gap < -error && least < 0.0) span.first = max(span.first, (eye_gap + error) / least - rays.depth);
  if (eye_gap < -error && least >= 0.0) span.last = -3.0e38;
}

void cut(inout Span span, Ray ray, vec3 n, float d, float spread) {
  if (spread == 0.0) cut_span(span, ray, n, d);
  else cut_cone(span, ray, n, d, spread);
}

Span span_of(Ray ray, float spread) {
  Span span = Span(-rays.depth, 3.0e38, vec3(0.0));
  cut(span, ray, vec3(1.0, 0.0, 0.0), rays.hi.x, spread);
  cut(span, ray, vec3(0.0, 1.0, 0.0), rays.hi.y, spread);
  cut(span, ray, vec3(0.0, 0.0, 1.0), rays.hi.z, spread);
  cut(span, ray, vec3(-1.0, 0.0, 0.0), -rays.lo.x, spread);
  cut(span, ray, vec3(0.0, -1.0, 0.0), -rays.lo.y, spread);
  cut(span, ray, vec3(0.0, 0.0, -1.0), -rays.lo.z, spread);
  for (uint i = 0u; i < rays.cut_count; ++i) cut(span, ray, rays.cuts[i].xyz, rays.cuts[i].w, spread);
  return span;
}
