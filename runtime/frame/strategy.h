// How the pixels of a frame are evaluated, and which way is taken. Pure values.
#pragma once

#include <array>
#include <cstddef>

#include "runtime/frame/autotuner.h"
#include "runtime/view/frame_passes.h"

namespace dmvv::runtime {

struct Strategy {
  bool classifies = false;  ///< pixels in cells with a proven answer are painted
  bool leads = false;       ///< a leader of each 4 x 4 pixels is evaluated first and answers for those near it

  static constexpr std::size_t count = 4;
  constexpr std::size_t number() const { return (classifies ? 1u : 0u) + (leads ? 2u : 0u); }
  static constexpr Strategy of_number(std::size_t number) { return {(number & 1u) != 0, (number & 2u) != 0}; }
  friend bool operator==(const Strategy&, const Strategy&) = default;
};

/// Chooses the strategy of each frame from what earlier frames took.
class StrategyChoice {
 public:
  /// What a program has that strategies need.
  struct Program {
    bool has_judge = false;
    bool has_leaders = false;
  };

  explicit StrategyChoice(Program program) : program_(program) {}

  /// The strategy of the next frame. The first frame takes none: one picture alone pays for no proof. The leaders'
  /// kernel is used when frames without it have taken as long as it takes to compile (rent or buy). With trials on, the
  /// fastest possible strategy is taken, as the autotuner finds it; with trials off, all that is possible.
  Strategy begin(const FramePasses& passes, bool is_time_provable);
  /// What a frame of this strategy took: on the device, and in splitting cells beside it.
  void end(const Strategy& strategy, const FramePasses& passes, double device_ms, double splitting_ms);
  /// A picture is complete: another one may follow.
  void note_picture() { has_drawn_ = true; }
  void note_compilation(double ms) { compile_ms_ = ms; }

 private:
  Program program_;
  Autotuner autotuner_{Strategy::count,
                       Strategy{.classifies = true, .leads = false}.number(),
                       {false, true, false, true}};  // strategies with verdicts become faster by being used
  bool has_drawn_ = false;
  double compile_ms_ = 0.0, drawn_ms_ = 0.0;
};

}  // namespace dmvv::runtime
