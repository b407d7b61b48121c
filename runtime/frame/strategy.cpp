#include "runtime/frame/strategy.h"

namespace dmvv::runtime {

Strategy StrategyChoice::begin(const FramePasses& passes, bool is_time_provable) {
  const bool may_skip = passes.pixel_list && has_drawn_ && is_time_provable;
  const bool may_classify = may_skip && passes.verdicts && program_.has_judge;
  const bool may_lead =
      may_skip && passes.reach && program_.has_leaders && (drawn_ms_ >= compile_ms_ || !passes.trials);
  if (!passes.trials) return {may_classify, may_lead};
  if (!may_skip) return {};
  std::array<bool, Strategy::count> possible{};
  for (std::size_t i = 0; i < possible.size(); ++i) {
    const Strategy strategy = Strategy::of_number(i);
    possible[i] = (may_classify || !strategy.classifies) && (may_lead || !strategy.leads);
  }
  return Strategy::of_number(autotuner_.begin(possible));
}

void StrategyChoice::end(const Strategy& strategy, const FramePasses& passes, double device_ms, double splitting_ms) {
  if (!has_drawn_ || !passes.pixel_list) return;
  autotuner_.end(strategy.number(), device_ms + splitting_ms);
  drawn_ms_ += device_ms;
}

}  // namespace dmvv::runtime
