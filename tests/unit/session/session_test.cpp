// A session: from the text of a scene to its answers and pictures, without a command around it.
#include "session/session.h"

#include <doctest/doctest.h>

using namespace dmvv;

namespace {

const char* const ball = R"(<MVV><OBJECT name="BALL"><SDF name="S" function="true">return length(p) - 0.5;</SDF>
  <REGION name="IN" type="color" rgb="1 0 0"/><REGION name="OUT" type="color" rgb="0 0 1"/>
  <MAPPINGS><SDF name="S"><POSITIVE region="OUT"/><NEGATIVE region="IN"/></SDF></MAPPINGS></OBJECT></MVV>)";

session::SceneFile file(const std::string& text) { return {"s.voml", "", memory_files({{"s.voml", text}})}; }

}  // namespace

TEST_CASE("a scene's text becomes answers and pictures; the session tells of each step") {
  std::vector<std::string> laps;
  session::Session session({.device = "", .validation = true, .caches = false},
                           [&](const char* step) { laps.emplace_back(step); });
  Diagnostics diagnostics;
  auto scene = session.read(file(ball), diagnostics);
  REQUIRE_MESSAGE(scene, diagnostics.render());
  runtime::Timings timings;
  auto points = session.load(std::move(*scene), {}, compiler::Source::points, diagnostics, &timings);
  REQUIRE_MESSAGE(points, points.error().message);
  CHECK(laps == std::vector<std::string>{"read", "compile", "device", "compile", "SPIR-V"});
  REQUIRE(timings.size() == 1);
  CHECK(timings[0].step == "upload");
  const auto answers = points->evaluator.probe(std::vector<glm::dvec3>{{0.4, 0.0, 0.0}, {0.6, 0.0, 0.0}});
  REQUIRE(answers);
  CHECK(points->program.regions[answers->at(0).path.back().region].region == "IN");
  CHECK(points->program.regions[answers->at(1).path.back().region].region == "OUT");

  // The same session, another scene: a window's reload. The surface is prepared meanwhile.
  runtime::View view;
  view.size_px = {64, 64};
  view.cuts = {{{0.0, 0.0, 1.0}, 0.0}};
  view.want_regions = true;
  laps.clear();
  auto again = session.read(file(ball), diagnostics);
  REQUIRE(again);
  session.prepare_surface(view);
  compiler::CompileOptions options;
  options.many_frames = true;  // with what proves answers
  auto pictures = session.load(std::move(*again), options, compiler::Source::surface, diagnostics);
  REQUIRE_MESSAGE(pictures, pictures.error().message);
  CHECK(laps == std::vector<std::string>{"read", "compile", "compile", "SPIR-V", "surface"});
  const auto picture = pictures->evaluator.render(view);
  REQUIRE(picture);
  CHECK(picture->regions[32 * 64 + 32] == 1);  // the middle of the section
  CHECK(session.validation_messages().empty());
}

TEST_CASE("mistakes of authors are told by the diagnostics, those of the machine by the error") {
  session::Session session({.device = "no such device", .validation = false, .caches = false});
  Diagnostics diagnostics;
  const auto unread = session.read(file("<MVV>"), diagnostics);
  REQUIRE_FALSE(unread);
  CHECK(unread.error().fault == Fault::input);
  CHECK(diagnostics.has_errors());

  Diagnostics of_snippet;
  auto scene = session.read(file(R"(<MVV><OBJECT name="A"><SDF name="S" function="true">return q;</SDF>
    <REGION name="R" type="color" rgb="1 0 0"/><MAPPINGS><SDF name="S"><POSITIVE region="R"/><NEGATIVE region="R"/></SDF>
    </MAPPINGS></OBJECT></MVV>)"),
                            of_snippet);
  REQUIRE_MESSAGE(scene, of_snippet.render());
  CHECK_FALSE(session.lower(std::move(*scene), of_snippet));
  CHECK(of_snippet.has_errors());

  Diagnostics fine;
  auto read = session.read(file(ball), fine);
  REQUIRE(read);
  const auto loaded = session.load(std::move(*read), {}, compiler::Source::points, fine);
  REQUIRE_FALSE(loaded);
  CHECK_FALSE(fine.has_errors());
  CHECK(loaded.error().fault == Fault::environment);
  CHECK(loaded.error().message.find("no such device") != std::string::npos);
}

TEST_CASE("without a device a session builds for the limits that every device keeps") {
  session::Session session({.device = "no such device", .validation = false, .caches = false});
  Diagnostics diagnostics;
  auto module = session.lower(session.read(file(ball), diagnostics).value(), diagnostics);
  REQUIRE(module);
  const auto built = session.build(std::move(*module), {}, diagnostics);
  REQUIRE(built);
  CHECK(built->program.find_kernel("points") != nullptr);
}
