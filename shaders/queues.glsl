// The pixels of stages (compiler/plan/stage_plan.h). Comes after shaders/records.h and shaders/pixel_io.glsl.
layout(set = 1, binding = DMVV_BIND_QUEUES, std430) buffer Queues {
  QueueHeader header;
  uint pixels[];  // x, and y in the upper half
} queues;
layout(set = 1, binding = DMVV_BIND_NEXT, std430) buffer NextStages { uint next_stages[]; };

uint queue_entry(uint stage, uint i) { return (stage - 1u) * frame.width * frame.height + i; }
uint pixels_of_stage(uint stage) { return stage == 0u ? list.header.counts[this_step.listed_kind] : queues.header.counts[stage]; }
uint pixel_of_stage(uint stage, uint i) {
  return stage == 0u ? list.entries[entry_of(this_step.listed_kind, i)] : queues.pixels[queue_entry(stage, i)];
}
