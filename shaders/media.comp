// Kernel `media`: what rays see of the media that they go through, and what opaque they meet behind. Comes after the
// evaluation and shaders/ray.glsl; `rays` found where each ray first meets something.
//
// A medium of opacity a lets (1 - a)^l through on l units of its object, and what it absorbs it emits in its colour. Pieces
// between two evaluations are integrated exactly where the colour is one, else by the trapezoidal rule of the optical
// depth. A boundary between answers is found as in `rays`.

layout(set = 1, binding = DMVV_BIND_MEDIA, std430) writeonly buffer Media { vec4 media[]; };

// The answer at a point of the ray.
struct Answer {
  uint number, region;
  float s, holds, margin;
  vec4 color;
  float extinction;  // a unit of s
};

// Is evaluated in one place: drivers write an evaluation out wherever it is called.
Answer answer_of(Ray ray, float s, float speed) {
  bool is_there = hit_number != 0u;
  vec4 color = color_of(hit_region, hit_p);
  float scale = length(hit_linear * ray.along);
  float extinction = is_there ? -log(max(1.0 - color.a, 5.9604645e-8)) * scale : 0.0;
  return Answer(hit_number, is_there ? hit_region : DMVV_NO_REGION, s, safe * max(reach, 0.0) / speed, margin,
                is_there ? color : vec4(0.0), extinction);
}

// Two answers of one region at one scale are one medium; colours from bitmaps may differ.
bool is_same(Answer a, Answer b) {
  return a.region == b.region && abs(a.extinction - b.extinction) <= (has_bitmap(a.region) ? nowhere : 1e-5 * a.extinction);
}

// Premultiplied colour, and what is absorbed.
void pass(inout vec4 seen, Answer a, float extinction, vec3 rgb, float s) {
  float left = exp(-extinction * (s - a.s));
  float through = 1.0 - seen.a;
  seen.rgb += through * (1.0 - left) * rgb;
  seen.a = 1.0 - through * left;
}
void pass_between(inout vec4 seen, Answer a, Answer b) {
  float extinction = 0.5 * (a.extinction + b.extinction);
  vec3 rgb = extinction > 0.0 ? 0.5 * (a.extinction * a.color.rgb + b.extinction * b.color.rgb) / extinction : a.color.rgb;
  pass(seen, a, extinction, rgb, b.s);
}

// What goes on behind is not seen.
const float most_absorbed = 1.0 - 4e-6;

void main() {
  const uint lane = gl_LocalInvocationID.x;
  const uvec2 pixel = tile_corner(live_tile()) + uvec2(lane % DMVV_RAY_TILE, lane / DMVV_RAY_TILE);
  if (!is_in_picture(pixel)) return;
  const uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  if (surface.w == 0u) return;
  const Ray ray = ray_through(vec2(pixel));
  const float speed = length(ray.along);
  const Span span = span_of(ray, 0.0);
  vec3 p = surface_position(surface);
  float s = dot(p - ray.start, ray.along) / (speed * speed);

  vec4 seen = vec4(0.0);
  Answer here = Answer(0u, DMVV_NO_REGION, s, 0.0, 0.0, vec4(0.0), 0.0), behind = here;
  bool is_first = true, is_met = false, is_opaque_met = false, is_doubtful = false, is_bold = false, goes_on = true;
  float doubted = -nowhere, crossed = s;
  int steps = 0, refinements = 0;
  do {
    forget();
    evaluate(p);
    Answer found = answer_of(ray, s, speed);
    ++steps;
    float shortest = max(DMVV_LEAST_STEP * rays.pixel * (s + rays.depth), sure) / speed;
    float beside = beside_boundary * rays.pixel * (s + rays.depth) / speed;
    bool is_taken_back = false;
    if (is_first || (!is_met && is_same(here, found))) {
      bool is_unproven = !is_first && s - here.s > here.holds + found.holds;
      is_taken_back = is_unproven && is_bold;
      is_unproven = is_unproven && !is_taken_back && s - crossed > beside;
      is_doubtful = is_doubtful || (is_unproven && doubted != -nowhere && s - doubted > beside);
      doubted = is_unproven && doubted == -nowhere ? s : doubted;
      if (!is_first && !is_taken_back) pass_between(seen, here, found);
      if (!is_taken_back) here = found;
    } else if (is_same(here, found)) {  // before the boundary that was met
      pass_between(seen, here, found);
      here = found;
    } else {
      behind = found;
      refinements = is_met ? refinements : 0;
      is_met = true;
    }
    is_first = false;
    refinements += is_met ? 1 : 0;
    if (is_met && (behind.s - here.s) * speed <= sure) {  // crossed
      pass(seen, here, here.extinction, here.color.rgb, behind.s);
      is_doubtful = is_doubtful || (doubted != -nowhere && behind.s - doubted > beside);
      doubted = -nowhere;
      crossed = behind.s;
      here = behind;
      is_met = false;
    }
    is_opaque_met = !is_met && here.number != 0u && !is_medium(here.region);
    float between = boundary_between(here.s, here.margin, behind.s, behind.margin, refinements, speed);
    is_bold = !is_taken_back && here.holds > 0.25 * shortest;
    float step = min(here.holds + (is_taken_back ? 0.0 : shortest), medium_step(here.region) / max(length(hit_linear * ray.along), speed));
    float next = is_met ? between : min(here.s + step, span.last);
    goes_on = steps < DMVV_MOST_RAY_STEPS && !hit_unfinished && !is_opaque_met && seen.a < most_absorbed &&
              (is_met || here.s < span.last);
    s = goes_on ? next : s;
    p = clamp(point_on(ray, s), rays.lo.xyz, rays.hi.xyz);
  } while (goes_on);

  is_doubtful = is_doubtful || doubted != -nowhere;
  const bool was_opaque = is_opaque_met && steps == 1;
  if (seen.a >= most_absorbed) seen /= seen.a;
  if (is_opaque_met) p = clamp(point_on(ray, here.s), rays.lo.xyz, rays.hi.xyz);
  media[pixel.y * frame.width + pixel.x] = seen;
  uint notes = imageLoad(ray_notes, ivec2(pixel)).x;
  bool becomes_doubtful = (is_doubtful || steps >= DMVV_MOST_RAY_STEPS) && (notes & DMVV_NOTE_DOUBT) == 0u;
  if (!was_opaque) {
    imageStore(surface_image, ivec2(pixel), is_opaque_met ? pack_surface(p, -ray.along) : uvec4(0u));
    notes = is_opaque_met ? DMVV_NOTE_NORMAL : 0u;
    imageStore(ray_notes, ivec2(pixel), uvec4(notes | (becomes_doubtful || (notes & DMVV_NOTE_DOUBT) != 0u ? DMVV_NOTE_DOUBT : 0u)));
  }
  if (becomes_doubtful) atomicAdd(tiles.header.doubtful, 1u);
  if (was_opaque && (here.s + rays.depth) * speed <= sure) atomicAdd(tiles.header.begun_within, 1u);
  if (hit_unfinished) atomicAdd(tiles.header.unfinished, 1u);
}
