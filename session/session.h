// A session makes of a scene file what draws its pictures: every front end goes this way, and it is told here once.
//
//   file --read--> voml::Scene --load--> Loaded: the program, and an evaluator on the session's device
//                                        (lower, compile, to SPIR-V, upload)
//
// The device opens, and what pictures are drawn on is prepared, in threads of their own meanwhile.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "base/files.h"
#include "base/result.h"
#include "compiler/compile.h"
#include "compiler/ir/module.h"
#include "runtime/runtime.h"
#include "voml/scene.h"

namespace dmvv::session {

/// Where a scene is, and which of its objects is meant.
struct SceneFile {
  std::string path;
  std::string root;  ///< name of the root object; empty: the scene's last one
  ReadFile files = disk_files();
};

struct Options {
  std::string device;       ///< part of a device's name; empty: the best one (runtime::DeviceOptions)
  bool validation = false;  ///< the validation layer is on; its messages are collected
  bool caches = true;  ///< compiled code and the device's costs are kept in the user's cache folder, if there is one
};

/// A scene on a device.
struct Loaded {
  compiler::Program program;
  runtime::Evaluator evaluator;
};

/// Told each time a step is over: "read", "compile", "device", "calibrate", "surface", "SPIR-V". May be empty.
using Lap = std::function<void(const char* step)>;

/// The way from files to pictures for one device. Mistakes of authors are collected in `diagnostics` and make the
/// result an error of Fault::input; its text is then that there are some, and the diagnostics say which.
class Session {
 public:
  explicit Session(Options options, Lap lap = {});

  /// Begins to open the device. What needs no device does without this call. Cost: none here, some 50 ms in a thread.
  void open_device();
  /// Waits for it; copies are the same device. Errors: those of runtime::Device::create.
  Result<runtime::Device> device();
  /// Measures what the device's code costs, once for each device and driver, if the session has caches
  /// (device_profile.h). Pays where a program draws many frames.
  Result<void> calibrate();
  /// Prepares what pictures of this view are drawn on, for the evaluator of the next `load`. The device is open.
  void prepare_surface(const runtime::View& view);

  Result<voml::Scene> read(const SceneFile& file, Diagnostics& diagnostics);
  Result<compiler::Module> lower(voml::Scene scene, Diagnostics& diagnostics);
  /// A program without SPIR-V; fitted to the device if it is open.
  Result<compiler::Build> build(compiler::Module module, compiler::CompileOptions options, Diagnostics& diagnostics);

  /// What a scene becomes on the device: with the kernels for points of `source`, and for many frames with what proves
  /// answers. Adds "upload" to `timings`. Warnings wait in `diagnostics`.
  Result<Loaded> load(voml::Scene scene, const compiler::CompileOptions& options, compiler::Source source,
                      Diagnostics& diagnostics, runtime::Timings* timings = nullptr);

  /// Messages of the validation layer so far; none without a device.
  std::vector<std::string> validation_messages() const;

 private:
  void lap(const char* step) const;

  Options options_;
  Lap lap_;
  std::shared_ptr<const runtime::DiskCache> cache_;  ///< may be null
  compiler::CodeCache code_;
  std::shared_future<Result<runtime::Device>> opening_;
  std::optional<runtime::Device> device_;
  std::future<Result<runtime::PreparedSurface>> surface_;
};

}  // namespace dmvv::session
