// The trees of verdicts (compiler/proofs/verdict_tree.h): descriptor set 2. Comes after shaders/records.h.

layout(set = 2, binding = DMVV_BIND_VERDICT_WORDS, std430) readonly buffer VerdictWords { uint verdict_words[]; };
layout(set = 2, binding = DMVV_BIND_VERDICT_HITS, std430) buffer VerdictHits { uint verdict_hits[]; };
layout(set = 2, binding = DMVV_BIND_OUTCOMES, std430) readonly buffer Outcomes { RegionRecord outcomes[]; };
layout(set = 2, binding = DMVV_BIND_BUSY_CELLS, std430) buffer BusyCells {
  uint count;
  uint cells[];
} busy;

uint child_at(uvec3 place) { return (place.z * 4u + place.y) * 4u + place.x; }

// The index of the word of p's cell in the tree that begins with the word `first`; p in the standard cube.
uint find_verdict(vec3 p, uint first) {
  const float units = float(DMVV_VERDICT_UNITS);
  uvec3 place = uvec3(clamp((p + 1.0) * (0.5 * units), vec3(0.0), vec3(units - 1.0)));
  uint shift = 2u * (DMVV_VERDICT_LEVELS - 1u);
  uint cell = first + child_at(place >> shift);
  uint word = verdict_words[cell];
  while ((word & DMVV_VERDICT_INNER) != 0u && shift > 0u) {
    shift -= 2u;
    cell = first + (word & DMVV_VERDICT_VALUE) + child_at(place >> shift & 3u);
    word = verdict_words[cell];
  }
  return cell;
}

// Counts a pixel that an open cell leaves to be evaluated. After `most` of them the cell is named, to be split; and if it
// was not noted by the host, now and then again.
void count_hit(uint cell, uint most) {
  uint hits = atomicAdd(verdict_hits[cell], 1u) + 1u;
  if (hits < most || hits >= DMVV_VERDICT_NOTED || ((hits - most) & 127u) != 0u) return;
  uint slot = atomicAdd(busy.count, 1u);
  if (slot < DMVV_MOST_BUSY_CELLS) busy.cells[slot] = cell;
}
