#include "session/session.h"

#include "session/device_profile.h"

namespace dmvv::session {

namespace {

tl::unexpected<Error> has_mistakes() { return fail(Fault::input, "the scene has mistakes"); }

std::shared_ptr<const runtime::DiskCache> open_cache(const Options& options) {
  const std::string folder = options.caches ? runtime::DiskCache::user_folder() : std::string();
  return folder.empty() ? nullptr : std::make_shared<const runtime::DiskCache>(folder);
}

}  // namespace

Session::Session(Options options, Lap lap)
    : options_(std::move(options)), lap_(std::move(lap)), cache_(open_cache(options_)), code_(code_cache(cache_)) {}

void Session::lap(const char* step) const {
  if (lap_) lap_(step);
}

void Session::open_device() {
  if (!opening_.valid()) opening_ = runtime::Device::create_async({options_.device, options_.validation, cache_});
}

Result<runtime::Device> Session::device() {
  if (device_) return *device_;
  open_device();
  const Result<runtime::Device>& opened = opening_.get();
  lap("device");
  if (opened) device_ = *opened;
  return opened;
}

Result<void> Session::calibrate() {
  auto on = device();
  if (!on) return tl::unexpected(std::move(on.error()));
  session::calibrate(*on);
  lap("calibrate");
  return {};
}

void Session::prepare_surface(const runtime::View& view) {
  open_device();
  surface_ = runtime::PreparedSurface::prepare_async(opening_, view);
}

Result<voml::Scene> Session::read(const SceneFile& file, Diagnostics& diagnostics) {
  auto scene = voml::read_scene(file.path, file.files, {file.root, false}, diagnostics);
  lap("read");
  if (!scene) return has_mistakes();
  return std::move(*scene);
}

Result<compiler::Module> Session::lower(voml::Scene scene, Diagnostics& diagnostics) {
  auto module = compiler::lower(std::move(scene), diagnostics, {.check_everything = false, .cache = code_});
  lap("compile");
  if (!module) return has_mistakes();
  return std::move(*module);
}

Result<compiler::Build> Session::build(compiler::Module module, compiler::CompileOptions options,
                                       Diagnostics& diagnostics) {
  if (device_) fit_to(*device_, options);
  auto made = compiler::build(std::move(module), options, diagnostics);
  lap("compile");
  if (!made) return has_mistakes();
  return std::move(*made);
}

Result<Loaded> Session::load(voml::Scene scene, const compiler::CompileOptions& options, compiler::Source source,
                             Diagnostics& diagnostics, runtime::Timings* timings) {
  open_device();
  auto module = lower(std::move(scene), diagnostics);
  if (!module) return tl::unexpected(std::move(module.error()));
  auto on = device();
  if (!on) return tl::unexpected(std::move(on.error()));
  auto made = build(std::move(*module), options, diagnostics);
  if (!made) return tl::unexpected(std::move(made.error()));
  std::shared_ptr<const compiler::Judge> judge;
  if (options.many_frames) judge = make_judge(std::move(made->module), std::move(made->records), options);
  compiler::Program& program = made->program;
  if (auto translated = compiler::to_spirv(program, source, code_); !translated)
    return tl::unexpected(std::move(translated.error()));
  lap("SPIR-V");

  runtime::PreparedSurface surface;
  if (surface_.valid()) {
    auto prepared = surface_.get();
    lap("surface");
    if (!prepared) return tl::unexpected(std::move(prepared.error()));
    surface = std::move(*prepared);
  }
  auto evaluator = runtime::Evaluator::create(*on, program, timings, std::move(surface), std::move(judge));
  if (!evaluator) return tl::unexpected(std::move(evaluator.error()));
  return Loaded{std::move(program), std::move(*evaluator)};
}

std::vector<std::string> Session::validation_messages() const {
  return device_ ? device_->validation_messages() : std::vector<std::string>{};
}

}  // namespace dmvv::session
