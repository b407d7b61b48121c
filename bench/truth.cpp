#include "bench/truth.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <thread>

#include "base/limits.h"
#include "bench/random.h"

namespace dmvv::bench {

Error input_error(const std::string& path, const Diagnostics& diagnostics) {
  Error error{Fault::input, fmt::format("'{}' has mistakes", path), {}};
  std::istringstream lines(diagnostics.render());
  for (std::string line; error.reasons.size() < 6 && std::getline(lines, line);) error.reasons.push_back(line);
  return error;
}

Result<voml::Mesh> read_mesh(const SceneSource& source) {
  if (source.mesh_path.empty()) return voml::standard_cube();
  const auto bytes = disk_files()(source.mesh_path, max_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  Diagnostics diagnostics;
  auto mesh = voml::parse_mesh(source.mesh_path, *bytes, diagnostics);
  if (!mesh) return tl::unexpected(input_error(source.mesh_path, diagnostics));
  return std::move(*mesh);
}

Result<std::unique_ptr<Truth>> Truth::create(const SceneSource& source) {
  Diagnostics diagnostics;
  auto scene = voml::read_scene(source.path, source.files, {source.root, false}, diagnostics);
  if (!scene) return tl::unexpected(input_error(source.path, diagnostics));
  auto module = compiler::lower(std::move(*scene), diagnostics);
  if (!module || !compiler::can_evaluate(*module, diagnostics)) {
    return tl::unexpected(input_error(source.path, diagnostics));
  }
  auto mesh = read_mesh(source);
  if (!mesh) return tl::unexpected(mesh.error());
  return std::unique_ptr<Truth>(new Truth(source, std::move(*module), std::move(*mesh)));
}

Truth::Truth(SceneSource source, compiler::Module module, voml::Mesh mesh)
    : source_(std::move(source)),
      module_(std::move(module)),
      mesh_(std::make_shared<const voml::Mesh>(std::move(mesh))) {}

Truth::Known& Truth::known(compiler::Filter filter) {
  const bool is_tricubic = filter == compiler::Filter::tricubic;
  Known& found = is_tricubic ? tricubic_ : trilinear_;
  if (!found.reference) {
    compiler::Reference::Options options;
    options.filter = is_tricubic ? compiler::Filter::tricubic : compiler::Filter::hardware;
    found.reference.emplace(module_, options);
  }
  return found;
}

runtime::View Truth::view(glm::uvec2 size_px) const {
  runtime::View view;
  view.size_px = size_px;
  view.mesh = mesh_;
  view.cuts = source_.cuts;
  view.slice = source_.slice;
  view.time_ms = source_.time_ms;
  view.camera = source_.camera ? *source_.camera : runtime::default_camera(voml::bounds(*mesh_), size_px, view.cuts);
  view.camera.fov_deg /= source_.zoom;
  return view;
}

Answers Truth::ask(const std::vector<glm::dvec3>& points, compiler::Filter filter) {
  const compiler::Reference& reference = *known(filter).reference;
  Answers answers(points.size());
  const std::size_t workers = std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::thread> threads;
  for (std::size_t worker = 0; worker < workers; ++worker) {
    threads.emplace_back([&, worker] {
      for (std::size_t i = worker; i < points.size(); i += workers) {
        if (!std::isnan(points[i].x)) answers[i] = reference.evaluate(points[i], source_.time_ms);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  return answers;
}

const std::vector<glm::dvec3>& Truth::points(std::size_t count) {
  if (points_.size() != count) {
    const voml::Bounds box = voml::bounds(*mesh_);
    Random random(1);
    points_.clear();
    for (std::size_t i = 0; i < count; ++i) points_.push_back(random.point(box.lo, box.hi));
    trilinear_.at_points.clear();
    tricubic_.at_points.clear();
  }
  return points_;
}

const Answers& Truth::at_points(std::size_t count, compiler::Filter filter) {
  points(count);
  Answers& answers = known(filter).at_points;
  if (answers.size() != count) answers = ask(points_, filter);
  return answers;
}

const Answers& Truth::at_positions(const std::vector<glm::vec3>& positions, compiler::Filter filter) {
  Known& of_filter = known(filter);
  const bool same =
      of_filter.positions.size() == positions.size() &&
      std::memcmp(of_filter.positions.data(), positions.data(), positions.size() * sizeof(glm::vec3)) == 0;
  if (!same) {
    of_filter.positions = positions;
    of_filter.at_positions = ask(std::vector<glm::dvec3>(positions.begin(), positions.end()), filter);
  }
  return of_filter.at_positions;
}

const std::vector<glm::dvec4>& Truth::mean_colors(const runtime::Plane& slice, glm::uvec2 size_px,
                                                  std::uint32_t samples) {
  if (!mean_colors_.empty()) return mean_colors_;
  const runtime::SliceFrame frame = runtime::slice_frame(slice, size_px * samples);
  std::vector<glm::dvec3> row(std::size_t{samples} * samples * size_px.x);
  for (std::uint32_t y = 0; y < size_px.y; ++y) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::size_t width = std::size_t{samples} * size_px.x;
      const std::size_t of_samples = y * samples + i / width;
      row[i] =
          frame.origin + static_cast<double>(i % width) * frame.step_x + static_cast<double>(of_samples) * frame.step_y;
    }
    const Answers answers = ask(row, compiler::Filter::hardware);
    for (std::uint32_t x = 0; x < size_px.x; ++x) {
      glm::dvec3 premultiplied(0.0);
      double alpha = 0.0;
      for (std::uint32_t k = 0; k < samples * samples; ++k) {
        const glm::dvec4& rgba =
            answers[std::size_t{k / samples} * samples * size_px.x + x * samples + k % samples].rgba;
        premultiplied += glm::dvec3(rgba) * rgba.a;
        alpha += rgba.a;
      }
      mean_colors_.emplace_back(alpha > 0.0 ? premultiplied / alpha : glm::dvec3(0.0), alpha / (samples * samples));
    }
  }
  return mean_colors_;
}

RegionErrors compare_points(const Answers& truth, const std::vector<compiler::PointAnswer>& answers) {
  RegionErrors errors;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool same = truth[i].number == answers[i].number && truth[i].path == answers[i].path;
    ++(truth[i].certain ? errors.compared : errors.uncertain);
    if (!same) ++(truth[i].certain ? errors.wrong : errors.uncertain_different);
  }
  return errors;
}

PixelErrors compare_pixels(const Answers& truth, const runtime::Picture& picture) {
  PixelErrors errors;
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (std::isnan(picture.positions[i].x)) continue;
    const bool same = truth[i].number == picture.regions[i];
    ++(truth[i].certain ? errors.regions.compared : errors.regions.uncertain);
    if (!same) ++(truth[i].certain ? errors.regions.wrong : errors.regions.uncertain_different);
    if (!truth[i].certain) continue;
    for (int channel = 0; channel < 3; ++channel) {
      const double difference = picture.rgba[4 * i + static_cast<std::size_t>(channel)] - truth[i].rgba[channel];
      squares += difference * difference;
    }
  }
  if (errors.regions.compared != 0)
    errors.rmse = std::sqrt(squares / (3.0 * static_cast<double>(errors.regions.compared)));
  return errors;
}

}  // namespace dmvv::bench
