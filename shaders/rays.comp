// Kernel `rays`: where each pixel's ray first meets something. Comes after the evaluation and shaders/ray.glsl.
//
// It runs twice. First an invocation is a tile of pixels (StepParams::is_cone): it goes on while a ball around the middle
// ray, in which all points are proven empty, holds the rays of all its pixels; tiles whose rays all end so are done with.
// Then an invocation is a pixel of the other tiles. It goes on as far as the answer at a point is proven to hold, or by a
// least step; between a point where nothing is and one where something is, the boundary is found by their distances from
// it. Every loop round is one evaluation, whatever the ray is at.

// How far a tile's rays are from its middle one, at depth 1.
float spread_of(Ray middle, vec2 corner) {
  const vec2 size = vec2(DMVV_RAY_TILE - 1u);
  float most = distance(ray_through(corner).along, middle.along);
  most = max(most, distance(ray_through(corner + size).along, middle.along));
  most = max(most, distance(ray_through(corner + vec2(size.x, 0.0)).along, middle.along));
  most = max(most, distance(ray_through(corner + vec2(0.0, size.y)).along, middle.along));
  return 1.0001 * most;
}

// A ray goes on twice as far as an answer holds if the next one is expected to hold back to there: so much of that.
const float bold = 0.98;

void main() {
  const bool is_cone = this_step.is_cone != 0u;
  const uint lane = gl_LocalInvocationID.x;
  const uint tile = is_cone ? gl_GlobalInvocationID.x : live_tile();
  const uvec2 corner = tile_corner(tile), pixel = corner + uvec2(lane % DMVV_RAY_TILE, lane / DMVV_RAY_TILE);
  if (is_cone ? tile >= tile_count() : !is_in_picture(pixel)) return;

  const vec2 middle = vec2(corner) + 0.5 * float(DMVV_RAY_TILE - 1u);
  const Ray ray = ray_through(is_cone ? middle : vec2(pixel));
  const float spread = is_cone ? spread_of(ray, vec2(corner)) : 0.0;
  const float speed = length(ray.along);
  Span span = span_of(ray, spread);
  const float begun = is_cone ? -nowhere : uintBitsToFloat(tiles.words[tile]);
  const bool begins_within = begun <= span.first;  // at the plane through which it enters, or at the eye
  span.first = max(span.first, begun);

  // Up to `empty` nothing was met; at `full`, which is no longer `nowhere` then, something was.
  float s = span.first, empty = s, full = nowhere, empty_holds = 0.0, empty_margin = 0.0, full_margin = 0.0,
        least = DMVV_LEAST_STEP;
  bool goes_on = span.first <= span.last, is_stopped = false, is_bold = false, is_near = false;
  float doubted = -nowhere;
  int steps = 0, refinements = 0;
  if (goes_on) {
    do {
      vec3 p = point_on(ray, s);
      if (!is_cone) p = clamp(p, rays.lo.xyz, rays.hi.xyz);
      vec3 beyond = max(abs(p) - 1.0, 0.0);
      bool is_in_cube = beyond == vec3(0.0);
      forget();
      if (is_in_cube) occupancy(p);
      bool is_full = hit_number != 0u;
      float depth = s + rays.depth, pixel_width = rays.pixel * depth;
      float holds = (safe * max(is_in_cube ? reach : length(beyond), 0.0) - spread * depth) / (speed + spread);
      ++steps;
      least = steps > DMVV_PATIENCE ? min(least * DMVV_IMPATIENCE, 1.0) : least;
      float shortest = max(least * pixel_width, sure) / speed;
      goes_on = steps < DMVV_MOST_RAY_STEPS && !hit_unfinished;
      if (is_cone) {
        is_stopped = is_full || holds * speed <= 4.0 * pixel_width || !goes_on;
        s += is_stopped ? 0.0 : holds;
        goes_on = !is_stopped && s <= span.last;
      } else {
        bool was_met = full != nowhere, is_first = s == span.first;
        // What is not proven of the last step. One that went further than it had to is taken back then.
        float unproven = is_first ? 0.0 : s - empty - empty_holds - (is_full ? 0.0 : holds);
        float beside = beside_boundary * pixel_width / speed;
        bool is_there = is_full || (is_near && margin <= 2.0 * sure);
        bool is_taken_back = is_bold && unproven > (is_there ? beside : 0.0);
        float slowdown = is_first || was_met ? 1.0 : clamp((empty_holds - holds) / (s - empty), 0.0, 1.0);
        float approach = is_first || was_met || is_full ? 0.0 : (empty_margin - margin) / (s - empty);
        if (!is_taken_back) {
          doubted = !is_full && !was_met && unproven > 0.0 ? s : doubted;
          full = is_full ? s : full;
          full_margin = is_full ? margin : full_margin;
          empty = is_full ? empty : s;
          empty_holds = is_full ? empty_holds : holds;
          empty_margin = is_full ? empty_margin : margin;
        }
        bool is_met = full != nowhere;
        bool is_refined = (is_full && is_first) || (full - empty) * speed <= sure;
        refinements += was_met ? 1 : 0;
        // At least a little further than proven: so a wall that bounds what is asked, but no answer, is no hindrance.
        float bold_step = empty_holds * (empty_holds > shortest ? bold * 2.0 / (1.0 + slowdown) : 1.0);
        is_bold = !is_taken_back && empty_holds > 0.25 * shortest;
        // A boundary that margins tell to be near is gone to at once.
        float to_boundary = approach > 0.0 ? empty_margin / approach + aside / speed : nowhere;
        is_near = !is_taken_back && to_boundary < beside;
        is_bold = is_bold || is_near;
        float step = is_taken_back ? empty_holds : is_near ? to_boundary : max(empty_holds + shortest, bold_step);
        float next = is_met ? boundary_between(empty, empty_margin, full, full_margin, refinements, speed) : min(empty + step, span.last);
        goes_on = goes_on && (is_met ? !is_refined && next > empty && next < full
                                     : empty + empty_holds < span.last && empty < span.last);
        s = goes_on ? next : s;
      }
    } while (goes_on);
  }

  if (is_cone) {
    tiles.words[tile] = floatBitsToUint(s);
    if (is_stopped) tiles.words[tile_count() + atomicAdd(tiles.header.live.x, 1u)] = tile;
    return;
  }
  const bool is_met = full != nowhere, is_section = full == span.first && begins_within;
  const bool is_before_boundary = is_met && (full - doubted) * speed <= beside_boundary * rays.pixel * (full + rays.depth);
  const bool is_doubtful = steps >= DMVV_MOST_RAY_STEPS || (doubted != -nowhere && !is_before_boundary);
  // Within something the eye sees that.
  vec3 normal = is_section && span.normal != vec3(0.0) ? span.normal : -ray.along;
  vec3 p = clamp(point_on(ray, is_met ? full : 0.0), rays.lo.xyz, rays.hi.xyz);
  uint notes = (is_met && !is_section ? DMVV_NOTE_NORMAL : 0u) | (is_doubtful ? DMVV_NOTE_DOUBT : 0u);
  imageStore(surface_image, ivec2(pixel), is_met ? pack_surface(p, normal) : uvec4(0u));
  imageStore(ray_notes, ivec2(pixel), uvec4(notes));
  if (is_doubtful) atomicAdd(tiles.header.doubtful, 1u);
#ifndef DMVV_MEDIA
  if (is_section && span.normal == vec3(0.0)) atomicAdd(tiles.header.begun_within, 1u);
#endif
  if (hit_unfinished) atomicAdd(tiles.header.unfinished, 1u);
}
