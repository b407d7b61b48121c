// Every evaluator on one scene: where the reference is certain, each form of generated code must answer the same.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "runtime/runtime.h"
#include "tests/random/description.h"
#include "tests/support/agreement.h"

namespace dmvv::tests::random_scenes {

/// What went wrong first. `setting` and `point` as far as they apply.
struct Fault {
  enum class Kind : std::uint8_t {
    refused,     ///< reading, lowering or compiling a scene that is valid
    spirv,       ///< generated text that does not compile or validate
    lookup,      ///< the reference answers otherwise when it searches lists through
    meaning,     ///< the reference answers otherwise than the description evaluated directly
    device,      ///< the runtime fails
    validation,  ///< the validation layer has something to say
    answer,      ///< a device answers otherwise than the reference, which is certain
    verdict,     ///< what is proven of a cell is not so
  };
  Kind kind;
  std::string setting;
  double time_ms = 0.0;
  std::optional<glm::dvec3> point;
  std::string expected, got;
};

struct Counts {
  std::size_t scenes = 0, programs = 0, answers = 0;  ///< answers of devices that were compared
  std::size_t uniform = 0, uniform_uncertain = 0;     ///< points drawn from the whole cube, once a time
  std::size_t other = 0, other_uncertain = 0;         ///< on faces, in embedded objects, near boundaries
};

/// Changes a device's answers, to see whether a fault is found.
using Tamper = std::function<void(const compiler::Module&, std::vector<compiler::PointAnswer>&)>;

struct CheckOptions {
  std::size_t points = 200;
  bool all_settings = true;  ///< false: specialised code and one of the others, by the seed
  Tamper tamper;
};

/// Where in a scene to look again for a fault.
struct Focus {
  Fault like;                      ///< only this kind, setting and time
  std::vector<glm::dvec3> points;  ///< instead of drawn ones, unless empty
};

/// Reads, lowers, compiles and evaluates a scene in every setting. `seed` chooses the points.
std::optional<Fault> check(runtime::Device& device, const Scene& scene, std::uint64_t seed, const CheckOptions& options,
                           Counts& counts, const Focus* focus = nullptr);

/// The answer of a scene at a point, from its description alone and spec/voml.md, and whether it is clear: not within
/// 1e-9 of a boundary. The path is spelt as format_path does.
struct Meaning {
  std::string path;
  glm::dvec4 rgba{0.0};
  bool clear = true;
};

/// Evaluates a description directly: no reader, no module, no lookups.
class Interpreter {
 public:
  explicit Interpreter(const Scene& scene);
  Interpreter(Interpreter&&) noexcept;
  ~Interpreter();
  Meaning at(const glm::dvec3& p, double time_ms) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dmvv::tests::random_scenes
