#include "tests/random/check.h"

#include <fmt/format.h>

#include <algorithm>

#include "compiler/ir/legend.h"
#include "tests/random/points.h"
#include "tests/support/verdicts.h"

namespace dmvv::tests::random_scenes {

namespace {

std::optional<compiler::Module> read(const Scene& scene, Diagnostics& diagnostics) {
  auto made = voml::read_scene("scene.voml", memory_files(print(scene)), {}, diagnostics);
  if (!made) return std::nullopt;
  return compiler::lower(std::move(*made), diagnostics);
}

std::string text_of(const Error& error) {
  std::string text = error.message;
  for (const auto& reason : error.reasons) text += "\n" + reason;
  return text;
}

std::vector<double> moments(const compiler::Module& module) {
  const bool moves = std::any_of(module.functions.begin(), module.functions.end(),
                                 [](const auto& function) { return function.snippet.uses_time(); });
  return moves ? std::vector<double>{0.0, 1234.5, 3600000.0} : std::vector<double>{0.0};
}

/// What the reference says at the points of one moment.
struct Look {
  double time_ms;
  Points points;
  std::vector<compiler::ReferenceAnswer> expected;
};

std::vector<Look> look(const compiler::Module& module, std::uint64_t seed, const CheckOptions& options,
                       const Focus* focus) {
  const compiler::Reference reference(module);
  std::vector<Look> looks;
  for (const double time_ms : moments(module)) {
    if (focus && focus->like.point && focus->like.time_ms != time_ms) continue;
    Look made{time_ms, {}, {}};
    if (focus && !focus->points.empty()) {
      made.points.all = focus->points;
    } else {
      made.points = draw_points(module, reference, time_ms, seed, options.points);
    }
    for (const auto& p : made.points.all) made.expected.push_back(reference.evaluate(p, time_ms));
    looks.push_back(std::move(made));
  }
  return looks;
}

/// The reference against itself without lookups, and against the description.
std::optional<Fault> check_reference(const Scene& scene, const compiler::Module& module,
                                     const std::vector<Look>& looks) {
  const compiler::Reference listed(module, {.use_index = false});
  const Interpreter interpreter(scene);
  const auto legend = compiler::legend(module);
  for (const Look& now : looks) {
    for (std::size_t i = 0; i < now.expected.size(); ++i) {
      const glm::dvec3& p = now.points.all[i];
      const auto& expected = now.expected[i];
      if (const auto d = compare(legend, listed.evaluate(p, now.time_ms), legend, expected)) {
        return Fault{Fault::Kind::lookup, "reference", now.time_ms, p, d->expected, d->got};
      }
      const Meaning meaning = interpreter.at(p, now.time_ms);
      const std::string path = compiler::format_path(legend, expected.path);
      bool same = meaning.path == path;
      for (int c = 0; c < 4; ++c) same = same && std::abs(meaning.rgba[c] - expected.rgba[c]) < 1e-6;
      if (meaning.clear && !same) {
        const auto text = [](const std::string& where, const glm::dvec4& color) {
          return fmt::format("'{}' rgba {} {} {} {}", where, color.r, color.g, color.b, color.a);
        };
        return Fault{Fault::Kind::meaning,     "reference", now.time_ms, p, text(meaning.path, meaning.rgba),
                     text(path, expected.rgba)};
      }
    }
  }
  return std::nullopt;
}

/// What is proven of the cells around some of the points, for ever and around each moment, at all of them.
std::optional<Fault> check_verdicts(const compiler::Judge& judge, const Setting& setting,
                                    const std::vector<Look>& looks) {
  constexpr std::size_t most_grown = 24, bricks = 512;
  constexpr int rounds = 4;
  const auto claim = [&](const tests::GrownTree& tree, const Look& now) -> std::optional<Fault> {
    for (std::size_t i = 0; i < now.expected.size(); ++i) {
      const gpu::RegionRecord* outcome = tree.outcome_at(now.points.all[i]);
      if (outcome == nullptr || !now.expected[i].certain || agrees(*outcome, now.expected[i])) continue;
      return Fault{Fault::Kind::verdict,
                   setting.name,
                   now.time_ms,
                   now.points.all[i],
                   fmt::format("region {}", now.expected[i].number),
                   fmt::format("region {}", outcome->number)};
    }
    return std::nullopt;
  };
  tests::GrownTree always(judge, judge.always(), bricks);
  for (const Look& now : looks)
    always.grow(std::span(now.points.all).last(std::min(most_grown, now.points.all.size())), rounds);
  for (const Look& now : looks) {
    if (auto fault = claim(always, now)) return fault;
    if (!judge.is_animated()) continue;
    const compiler::Judge::Times times = judge.times({now.time_ms - 10.0, now.time_ms + 30.0});
    tests::GrownTree of_span(judge, times, bricks);
    of_span.grow(std::span(now.points.all).last(std::min(most_grown, now.points.all.size())), rounds);
    if (auto fault = claim(of_span, now)) return fault;
  }
  return std::nullopt;
}

/// A section drawn anew, and again with leaders: the same picture, to the byte.
std::optional<Fault> check_reach(runtime::Evaluator& evaluator, const Setting& setting, double time_ms) {
  runtime::View view;
  view.size_px = {96, 96};
  view.slice = runtime::Plane{{0.3, -0.2, 1.0}, 0.07};
  view.time_ms = time_ms;
  view.want_regions = true;
  view.disabled_passes = {"trials", "verdicts", "reach", "keep-surface", "keep-picture", "keep-still"};
  const auto anew = evaluator.render(view);
  std::erase(view.disabled_passes, "reach");
  const auto led = evaluator.render(view);
  const auto failed = [&](const std::string& got) {
    return Fault{Fault::Kind::device, setting.name, time_ms, {}, {}, got};
  };
  if (!anew || !led)
    return std::nullopt;  // more loop rounds than there are: reported, and `probe` says for which points
  if (anew->regions != led->regions) return failed("a picture whose regions are others with leaders");
  if (anew->rgba != led->rgba) return failed("a picture whose colours are others with leaders");
  return std::nullopt;
}

std::optional<Fault> check_setting(runtime::Device& device, const compiler::Module& module, const Setting& setting,
                                   const std::vector<Look>& looks, const CheckOptions& options, Counts& counts) {
  const auto fault = [&](Fault::Kind kind, std::string got) {
    return Fault{kind, setting.name, 0.0, {}, {}, std::move(got)};
  };
  Diagnostics diagnostics;
  compiler::CompileOptions form = setting.options;
  form.many_frames = true;
  form.stages = {.least_program_lines = 0, .least_lines = 1};
  auto build = compiler::build(module, form, diagnostics);
  if (!build) return fault(Fault::Kind::refused, diagnostics.render());
  compiler::Program& program = build->program;
  for (const auto source : {compiler::Source::points, compiler::Source::surface}) {
    const auto made = compiler::to_spirv(program, source);
    if (!made) return fault(Fault::Kind::spirv, text_of(made.error()));
  }
  ++counts.programs;
  const bool reads_otherwise =
      form.atlas_format != compiler::TexelFormat::r32f || form.filter != compiler::Filter::hardware;
  const auto judge = compiler::make_judge(std::move(build->module), std::move(build->records), form);
  if (setting.name == "specialised" || reads_otherwise) {  // the others have the same judge
    if (auto wrong = check_verdicts(*judge, setting, looks)) return wrong;
  }
  auto evaluator = runtime::Evaluator::create(device, program, nullptr, {}, judge);
  if (!evaluator) return fault(Fault::Kind::device, text_of(evaluator.error()));
  const auto legend = compiler::legend(module);
  for (const Look& now : looks) {
    auto answers = evaluator->probe(now.points.all, now.time_ms);
    if (!answers) return fault(Fault::Kind::device, text_of(answers.error()));
    if (options.tamper) options.tamper(module, *answers);
    if (setting.name == "specialised") {
      if (auto wrong = check_reach(*evaluator, setting, now.time_ms)) return wrong;
    }
    for (std::size_t i = 0; i < answers->size(); ++i) {
      if (!now.expected[i].certain) continue;
      ++counts.answers;
      if (auto d = compare(legend, now.expected[i], program.regions, (*answers)[i])) {
        return Fault{Fault::Kind::answer, setting.name, now.time_ms, now.points.all[i], d->expected, d->got};
      }
    }
  }
  return std::nullopt;
}

/// The same points as a reference reads them that has the grids of a setting as its program stores them.
std::vector<Look> read_again(const compiler::Module& passed, const Setting& setting, std::vector<Look> looks) {
  const compiler::Reference reference(passed, reading_of(setting));
  for (Look& now : looks) {
    for (std::size_t i = 0; i < now.expected.size(); ++i) {
      now.expected[i] = reference.evaluate(now.points.all[i], now.time_ms);
    }
  }
  return looks;
}

void count_uncertain(const std::vector<Look>& looks, Counts& counts) {
  for (const Look& now : looks) {
    for (std::size_t i = 0; i < now.expected.size(); ++i) {
      const bool uniform = i < now.points.uniform;
      ++(uniform ? counts.uniform : counts.other);
      if (!now.expected[i].certain) ++(uniform ? counts.uniform_uncertain : counts.other_uncertain);
    }
  }
}

}  // namespace

std::optional<Fault> check(runtime::Device& device, const Scene& scene, std::uint64_t seed, const CheckOptions& options,
                           Counts& counts, const Focus* focus) {
  ++counts.scenes;
  Diagnostics diagnostics;
  const auto module = read(scene, diagnostics);
  if (!module) return Fault{Fault::Kind::refused, "reader", 0.0, {}, {}, diagnostics.render()};
  const auto looks = look(*module, seed, options, focus);
  count_uncertain(looks, counts);
  if (!focus || focus->like.setting == "reference") {
    if (auto fault = check_reference(scene, *module, looks)) return fault;
  }
  const std::size_t said = device.validation_messages().size();
  std::vector<Setting> settings = agreeing_settings();
  const std::size_t plain = settings.size();
  if (!module->grids.empty()) {
    for (Setting& setting : grid_settings()) settings.push_back(std::move(setting));
  }
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Setting& setting = settings[i];
    if (focus && focus->like.setting != setting.name) continue;
    if (!focus && !options.all_settings && i != 0 && i != 1 + seed % (settings.size() - 1)) continue;
    if (i < plain) {
      if (auto fault = check_setting(device, *module, setting, looks, options, counts)) return fault;
    } else {
      compiler::Module passed = *module;
      compiler::run_passes(passed, setting.options);
      const auto again = read_again(passed, setting, looks);
      if (auto fault = check_setting(device, passed, setting, again, options, counts)) return fault;
    }
    const auto messages = device.validation_messages();
    if (messages.size() > said) return Fault{Fault::Kind::validation, setting.name, 0.0, {}, {}, messages[said]};
  }
  return std::nullopt;
}

}  // namespace dmvv::tests::random_scenes
