// Two results of the benchmark, before and after a change: what got slower, what got more wrong.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/result.h"

namespace dmvv::bench {

enum class Verdict { same, faster, slower, more_wrong, less_wrong };

/// One figure of one case in both results.
struct Change {
  std::string id;
  std::string figure;  ///< "frame", "pipeline", "point", "wrong pixels", ...
  double before = 0.0;
  double after = 0.0;
  double ratio = 1.0;  ///< after / before; of several pairs, the median of their ratios
  double noise = 0.0;  ///< how far from 1 the ratio may be by chance
  Verdict verdict = Verdict::same;
};

struct Comparison {
  std::vector<Change> changes;                       ///< every figure that both have, in the order of the first result
  std::vector<std::string> only_before, only_after;  ///< ids
  std::vector<std::string> notes;                    ///< differences of machine, driver or version
  bool worse() const;                                ///< something is slower or more wrong
};

/// Compares pairs of results, each (before, after) as JSON text, taken in turns on one machine.
///
/// Times: a ratio of medians is called out if it is beyond the noise. One pair: four standard errors of the difference
/// of the medians (statistics.h), and 5 % at least; with fewer than five samples on a side 30 %, as there is no noise
/// to estimate. Three pairs or more: the median of their ratios against four standard errors, of the ratios or from
/// within the runs, whichever is larger, and 3 % at least.
/// Differences under 0.05 ms (0.2 ns a point) are never called out.
/// Errors: any rise of a wrong fraction, and displacements or colour errors that rise by more than 1 % and 1e-7.
/// Errors (input): not JSON, another schema, no pair.
Result<Comparison> compare(const std::vector<std::pair<std::string, std::string>>& pairs);

/// What a reader should know, at most 100 columns.
std::string to_text(const Comparison& comparison);

}  // namespace dmvv::bench
