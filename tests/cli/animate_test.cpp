// dmvv animate: when frames are, that shares, stops and damage change none, and clips. The rules: spec/animate.md.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <thread>

#include "base/content_hash.h"
#include "cli/frames.h"
#include "cli/progress.h"
#include "session/timeline.h"
#include "tests/cli/program.h"
#include "tests/cli/scenes.h"

using namespace dmvv;
using namespace dmvv::cli;
using namespace dmvv::tests;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// A ball whose radius is 0.3 + 0.2 sin(2 pi t / 1 s).
constexpr const char* breathing_ball = R"(<MVV>
  <OBJECT name="BALL">
    <SDF name="S" function="true">return length(p) - 0.3 - 0.2*sin(t/1000.0*6.2831853);</SDF>
    <REGION name="R.BALL" type="color" rgb="1 0 0"/>
    <REGION name="R.AIR" type="empty"/>
    <MAPPINGS><SDF name="S">
      <POSITIVE><REGION name="R.AIR"/></POSITIVE>
      <NEGATIVE><REGION name="R.BALL"/></NEGATIVE>
    </SDF></MAPPINGS>
  </OBJECT>
</MVV>
)";

bool holds(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Words animate(const std::string& scene, const std::string& output) { return {"animate", scene, "-o", output}; }

/// Ten frames, quick to draw.
const Words small{"--to", "1000", "--fps", "10", "--size", "32x24", "--slice", "z=0"};
/// Sixty frames that take some seconds.
const Words slow{"--to", "6000", "--fps", "10", "--size", "320x240", "--samples", "4", "--cut", "0 0 1 0"};

Run must_run(const Words& words) {
  const Run run = run_dmvv(words);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  return run;
}

/// Every file of two folders, hidden ones too, is the same, byte by byte.
void check_same(const std::string& a, const std::string& b) {
  const auto names = [](const std::string& folder) {
    std::vector<std::string> result;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      result.push_back(fs::relative(entry.path(), folder).string());
    }
    std::ranges::sort(result);
    return result;
  };
  REQUIRE(names(a) == names(b));
  for (const std::string& name : names(a)) {
    CHECK_MESSAGE((read_file(a + '/' + name) == read_file(b + '/' + name)), name);
  }
}

/// Waits at most a minute.
bool wait_for_file(const std::string& path) {
  for (int i = 0; i < 6000 && !fs::exists(path); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return fs::exists(path);
}

int status_of(pid_t process) {
  int status = 0;
  waitpid(process, &status, 0);
  return status;
}

/// Sets $PATH while it lives.
class Path {
 public:
  explicit Path(const std::string& folders) : before_(std::getenv("PATH")) { setenv("PATH", folders.c_str(), 1); }
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;
  ~Path() { setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

/// What a command of the shell prints.
std::string output_of(const std::string& command) {
  const Folder folder;
  REQUIRE(std::system((command + " >" + folder.file("out")).c_str()) == 0);
  return folder.read("out");
}

/// The frames of a picture or clip one after another, four bytes a pixel.
std::string decode(const std::string& path, const std::string& decoder = "") {
  return output_of("ffmpeg -v error " + decoder + " -i " + path + " -f rawvideo -pix_fmt rgba -");
}

/// `value` is red, green, blue, alpha at that pixel; each may be off by `tolerance`.
void check_pixel(const std::string& rgba, std::size_t pixel, std::array<int, 4> value, int tolerance) {
  for (std::size_t i = 0; i < 4; ++i) {
    CAPTURE(pixel);
    CAPTURE(i);
    CHECK(std::abs(static_cast<unsigned char>(rgba.at(4 * pixel + i)) - value[i]) <= tolerance);
  }
}

}  // namespace

TEST_CASE("frames stand at from + i * 1000 / fps, from `from` on and before `to`") {
  struct Case {
    double from_ms, to_ms, fps;
    std::uint32_t count;
  };
  for (const Case& one : {Case{0, 1000, 30, 30},
                          {0, 1000, 29.97, 30},
                          {0, 1001, 30, 31},
                          {500, 600, 30, 3},
                          {0, 100, 30, 3},
                          {0.1, 1000.1, 30, 30},
                          {0, 1, 1, 1},
                          {-200, 0, 25, 5},
                          {0, 10'000, 30, 300},
                          {0, 3'600'000, 60, 216'000},
                          {0, 1e-9, 1, 1}}) {
    CAPTURE(one.from_ms);
    CAPTURE(one.to_ms);
    CAPTURE(one.fps);
    const auto times = session::make_timeline(one.from_ms, one.to_ms, one.fps);
    REQUIRE(times);
    CHECK(times->count() == one.count);
    CHECK(times->time_ms(0) == one.from_ms);
    CHECK(times->time_ms(one.count - 1) < one.to_ms);
    CHECK(times->time_ms(one.count) >= doctest::Approx(one.to_ms));
  }
  // An hour at 60 frames a second: 1000/60 is no binary fraction, and yet whole seconds stay whole.
  CHECK(session::make_timeline(0, 3'600'000, 60)->time_ms(215'940) == 3'599'000.0);

  const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [from, to, fps] : {std::array{0.0, 0.0, 30.0},
                                      {1.0, 0.0, 30.0},
                                      {0.0, infinity, 30.0},
                                      {nan, 1.0, 30.0},
                                      {0.0, 1.0, 0.0},
                                      {0.0, 1.0, -1.0},
                                      {0.0, 1.0, nan},
                                      {0.0, 1e9, 1e9},
                                      {-1e308, 1e308, 30.0}}) {
    CHECK(!session::make_timeline(from, to, fps));
  }
}

TEST_CASE("shares of the frames") {
  CHECK(parse_frame_range("0-9", 10)->last == 9);
  CHECK(parse_frame_range("3-4", 10)->first == 3);
  CHECK((parse_frame_range("7", 10)->first == 7 && parse_frame_range("7", 10)->last == 7));
  for (const char* text :
       {"", "-", "3-", "-3", "4-3", "0-10", "10", "a-b", "1-2-3", "0x1-2", "1.5-2", " 1-2", "0-99999999999999"}) {
    CHECK_MESSAGE(!parse_frame_range(text, 10), text);
  }
}

TEST_CASE("names of frames") {
  const auto name = [](const char* pattern, std::uint32_t frame) { return FrameNames::parse(pattern)->name(frame); };
  CHECK(name("frames_%04d.png", 7) == "frames_0007.png");
  CHECK(name("frames_%04d.png", 123456) == "frames_123456.png");
  CHECK(name("%d.png", 0) == "0.png");
  CHECK(name("a%3db.png", 12) == "a 12b.png");
  CHECK(name("100%%_%02d.png", 5) == "100%_05.png");
  CHECK(FrameNames::parse("a/50%/f%d.png")->folder() == "a/50%");
  CHECK(FrameNames::parse("f%d.png")->folder() == ".");
  for (const char* pattern : {"", "frame.png", "%d", "%d.jpg", "%d_%d.png", "%s.png", "%010d.png", "%999999999999d.png",
                              "a%", "%%.png", "%d/frame.png", "%x%d.png", "%-3d.png"}) {
    CHECK_MESSAGE(!FrameNames::parse(pattern), pattern);
  }
  const FrameNames names = *FrameNames::parse("f_%03d.png");
  CHECK(names.frame_of("f_012.png") == 12u);
  CHECK(names.frame_of("f_1234.png") == 1234u);
  for (const char* other : {"f_12.png", "f_0012.png", "f_.png", "f_01x.png", "g_012.png", "f_012.PNG", "f_-12.png"}) {
    CHECK_MESSAGE(!names.frame_of(other), other);
  }
}

TEST_CASE("the content hash is FNV-1a with 128 bits over each file and its length") {
  __extension__ using Wide = unsigned __int128;
  const auto wide = [](std::uint64_t high, std::uint64_t low) { return Wide{high} << 64 | low; };
  const auto defined = [&](std::initializer_list<std::string> files) {
    Wide hash = wide(0x6c62272e07bb0142u, 0x62b821756295c58du);
    const Wide prime = (Wide{1} << 88) + 0x13b;
    for (std::string file : files) {
      const std::uint64_t length = file.size();
      for (int byte = 0; byte < 8; ++byte) file += static_cast<char>(length >> 8 * byte);
      for (const char c : file) hash = (hash ^ static_cast<unsigned char>(c)) * prime;
    }
    return fmt::format("fnv1a-128:{:016x}{:016x}", static_cast<std::uint64_t>(hash >> 64),
                       static_cast<std::uint64_t>(hash));
  };
  const auto computed = [](std::initializer_list<std::string> files) {
    dmvv::ContentHash hash;
    for (const std::string& file : files) hash.add(file);
    return hash.text();
  };
  const std::string every_byte = [] {
    std::string text;
    for (int i = 0; i < 1000; ++i) text += static_cast<char>(i);
    return text;
  }();
  for (const auto& files : {std::initializer_list<std::string>{}, {""}, {"ab", "c"}, {"a", "bc"}, {every_byte}}) {
    CHECK(computed(files) == defined(files));
  }
  CHECK(computed({"ab", "c"}) != computed({"a", "bc"}));
}

TEST_CASE("the bar tells how much is done and how long the rest takes") {
  // 100 fresh frames in 50 s: 0.5 s each, 180 to go.
  CHECK(progress_text("frames", 120, 300, 100, 50.0) == "frames [########------------] 120/300  40 %  1:30 left");
  CHECK(progress_text("clip", 0, 10, 0, 3.0) == "clip [--------------------] 0/10   0 %");
  CHECK(progress_text("f", 1, 7201, 1, 1.0) == "f [--------------------] 1/7201   0 %  2:00:00 left");
  CHECK(progress_text("f", 2, 2, 2, 9.0) == "f [####################] 2/2 100 %  0:00 left");
}

TEST_CASE("a frame with any byte missing or changed is not whole") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  must_run({"render", scene, "-o", folder.file("whole.png"), "--size", "6x5"});
  const std::string bytes = folder.read("whole.png");
  CHECK(is_whole_frame(folder.file("whole.png"), {6, 5}));
  CHECK(!is_whole_frame(folder.file("whole.png"), {5, 6}));
  CHECK(!is_whole_frame(folder.file("absent.png"), {6, 5}));
  CHECK(!is_whole_frame(folder.write("p.png", bytes + "x"), {6, 5}));
  std::size_t taken_for_whole = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    taken_for_whole += is_whole_frame(folder.write("p.png", bytes.substr(0, i)), {6, 5});
    std::string flipped = bytes;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x10);
    taken_for_whole += is_whole_frame(folder.write("p.png", flipped), {6, 5});
  }
  CHECK(taken_for_whole == 0);
}

TEST_CASE("frames are the same whatever the share and the order, and the manifest says how they were made") {
  const Folder all, shares;
  const std::string scene = all.write("s.voml", nested_cubes);
  shares.write("s.voml", nested_cubes);
  const Run run = must_run(animate(scene, all.file("f_%02d.png")) + small);
  CHECK(run.err.empty());
  CHECK(run.out.starts_with(all.file("f_%02d.png") + ": 10 frames of 32x24, "));
  CHECK(all.listing().size() == 12);  // the scene, ten frames, MANIFEST.json
  for (const char* share : {"7-9", "0-2", "3", "4-6"}) {
    must_run(animate(scene, shares.file("f_%02d.png")) + small + Words{"--frames", share, "--quiet"});
  }
  fs::remove(shares.file("s.voml"));
  shares.write("s.voml", all.read("s.voml"));
  check_same(all.file(""), shares.file(""));

  const json manifest = json::parse(all.read("MANIFEST.json"));
  CHECK(manifest["scene"] == "s.voml");
  dmvv::ContentHash hash;
  hash.add(nested_cubes);
  CHECK(manifest["scene_hash"] == hash.text());
  CHECK(manifest["span_ms"] == json{0, 1000});
  CHECK(manifest["fps"] == 10);
  CHECK(manifest["frames"] == 10);
  CHECK(manifest["size"] == json{32, 24});
  CHECK(manifest["view"]["slice"] == json{0, 0, 1, 0});
  for (const char* key : {"version", "device", "driver"}) CHECK(!manifest[key].get<std::string>().empty());

  // A static scene: every frame is the picture that `render` draws.
  must_run({"render", scene, "-o", shares.file("p.png"), "--size", "32x24", "--slice", "z=0"});
  CHECK((shares.read("p.png") == all.read("f_05.png")));
}

TEST_CASE("an animated scene is drawn at the time of each frame") {
  const Folder folder;
  const std::string scene = folder.write("ball.voml", breathing_ball);
  const int width = 128;
  must_run(animate(scene, folder.file("f_%d.png")) +
           Words{"--from", "250", "--to", "2250", "--fps", "2", "--size", "128x128", "--slice", "z=0"});
  // Frames at 250, 750, 1250, 1750 ms: the sine is 1, -1, 1, -1.
  const std::array radius{0.5, 0.1, 0.5, 0.1};
  for (std::size_t frame = 0; frame < radius.size(); ++frame) {
    const std::string rgba = decode(folder.file(fmt::format("f_{}.png", frame)));
    REQUIRE(rgba.size() == 4u * width * width);
    int inside = 0;
    for (std::size_t pixel = 0; pixel < rgba.size(); pixel += 4) inside += rgba[pixel + 3] != 0;
    const double radius_px = radius[frame] * width / 2;
    CHECK(std::abs(inside - std::numbers::pi * radius_px * radius_px) < 2 * radius_px);  // a third of the rim's pixels
  }
  must_run({"render", scene, "-o", folder.file("p.png"), "--time", "750", "--size", "128x128", "--slice", "z=0"});
  CHECK((folder.read("p.png") == folder.read("f_1.png")));
}

TEST_CASE("a killed run leaves no torn frame, and the next one makes what an uninterrupted one does") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  for (const char* name : {"whole", "killed"}) fs::create_directory(folder.file(name));
  must_run(animate(scene, folder.file("whole/f_%03d.png")) + slow);

  const Words killed = animate(scene, folder.file("killed/f_%03d.png")) + slow;
  for (const char* seen : {"killed/f_003.png", "killed/f_020.png"}) {
    const pid_t process = start_dmvv(killed, folder.file("err"));
    CHECK(wait_for_file(folder.file(seen)));
    kill(process, SIGKILL);
    CHECK(WIFSIGNALED(status_of(process)));  // in the middle, not after the end
    int frames = 0;
    for (const auto& entry : fs::directory_iterator(folder.file("killed"))) {
      if (entry.path().extension() != ".png") continue;
      ++frames;
      CHECK((read_file(entry.path()) == folder.read("whole/" + entry.path().filename().string())));
    }
    CHECK(frames >= 4);
    CHECK(frames < 60);
  }
  const auto before = fs::last_write_time(folder.file("killed/f_003.png"));
  const Run run = must_run(killed);
  CHECK(holds(run.out, " of them drawn before, "));
  CHECK((fs::last_write_time(folder.file("killed/f_003.png")) == before));
  check_same(folder.file("whole"), folder.file("killed"));
}

TEST_CASE("Ctrl-C stops between frames with exit code 130 and says how to go on") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  const std::string clip = folder.file("clip.mp4");
  const pid_t process = start_dmvv(animate(scene, clip) + slow, folder.file("err"));
  CHECK(wait_for_file(folder.file("clip.mp4.frames/frame_000002.png")));
  kill(process, SIGINT);
  const int status = status_of(process);
  REQUIRE(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 130);
  CHECK(holds(folder.read("err"), "the same command goes on"));
  for (const std::string& path : folder.listing()) CHECK(!holds(path, "partial"));
  CHECK(fs::exists(folder.file("clip.mp4.frames/MANIFEST.json")));
  CHECK(!fs::exists(clip));
  CHECK(holds(must_run(animate(scene, clip) + slow).out, " of them drawn before, "));
  CHECK(fs::exists(clip));
  CHECK(!fs::exists(folder.file("clip.mp4.frames")));
}

TEST_CASE("damaged frames are drawn again, whole ones are not") {
  const Folder folder;
  const Words words = animate(folder.write("s.voml", nested_cubes), folder.file("f%d.png")) + small;
  must_run(words);
  const std::string good = folder.read("f4.png");
  folder.write("f2.png", good.substr(0, good.size() / 2));
  folder.write("f3.png", "");
  std::string flipped = good;
  flipped[good.size() - 20] ^= 1;  // in the pixels' data or their checksum
  folder.write("f4.png", flipped);
  fs::remove(folder.file("f9.png"));
  CHECK(holds(must_run(words).out, "6 of them drawn before"));
  for (const char* name : {"f2.png", "f3.png", "f4.png", "f9.png"}) CHECK((folder.read(name) == good));
  CHECK(holds(must_run(words).out, "10 of them drawn before"));
}

TEST_CASE("frames made otherwise are refused, with what differs and the ways out") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  const std::string frames = folder.file("f%d.png");
  must_run(animate(scene, frames) + small);
  const auto before = folder.listing();

  struct Case {
    Words words;
    std::string said;
  };
  const std::string other = folder.write("other.voml", std::string(nested_cubes) + " ");
  const std::string elsewhere = folder.file("g%d.png");
  for (const Case& one : std::vector<Case>{
           {animate(other, frames) + small, "scene_hash: "},
           {animate(scene, elsewhere) + small, "names: \"f%d.png\" there, \"g%d.png\" asked for"},
           {animate(scene, frames) + small + Words{"--from", "100"}, "span_ms: [0.0,1000.0] there, [100.0,1000.0]"},
           {animate(scene, frames) + Words{"--to", "1000", "--fps", "5", "--size", "32x24", "--slice", "z=0"},
            "fps: 10.0 there, 5.0 asked for"},
           {animate(scene, frames) + Words{"--to", "1000", "--fps", "10", "--size", "24x24", "--slice", "z=0"},
            "size: [32,24] there, [24,24] asked for"},
           {animate(scene, frames) + Words{"--to", "1000", "--fps", "10", "--size", "32x24", "--slice", "z=0.5"},
            "view.slice: "},
           {animate(scene, frames) + small + Words{"--samples", "2"}, "view.samples: 1 there, 2 asked for"},
           {animate(scene, frames) + small + Words{"--root", "CORE"}, "view.root: \"\" there, \"CORE\" asked for"},
           {animate(scene, frames) + small + Words{"--codegen", "table"}, "shader.codegen: "}}) {
    const Run run = run_dmvv(one.words);
    CHECK(run.exit_code == 1);
    CHECK(run.out.empty());
    CHECK_MESSAGE(holds(run.err, one.said), run.err);
    CHECK(holds(run.err, "--restart"));
  }
  for (const char* manifest : {"", "{", "[]", "7", "\xff\xfe"}) {
    const std::string good = folder.read("MANIFEST.json");
    folder.write("MANIFEST.json", manifest);
    const Run run = run_dmvv(animate(scene, frames) + small);
    CHECK(run.exit_code == 1);
    CHECK(holds(run.err, "is not a manifest"));
    folder.write("MANIFEST.json", good);
  }
  // The same scene in another file is the same scene.
  must_run(animate(folder.write("renamed.voml", nested_cubes), frames) + small);

  // --restart: the old frames go, whatever they were called; nothing else does.
  folder.write("f1.png.txt", "mine");
  must_run(animate(scene, elsewhere) + Words{"--restart", "--to", "300", "--fps", "10", "--size", "8x8"});
  for (const char* name : {"g0.png", "g1.png", "g2.png", "MANIFEST.json", "s.voml", "f1.png.txt"}) {
    CHECK(fs::exists(folder.file(name)));
  }
  CHECK(folder.listing().size() == 8);  // other.voml and renamed.voml besides
  CHECK(before.size() == 12);
}

TEST_CASE("frames of which no manifest says how they were made are not taken for one's own") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  folder.write("f3.png", "a picture of mine");
  const Run run = run_dmvv(animate(scene, folder.file("f%d.png")) + small);
  CHECK(run.exit_code == 1);
  CHECK(holds(run.err, "f3.png"));
  CHECK(holds(run.err, "--restart"));
  CHECK(folder.read("f3.png") == "a picture of mine");
  CHECK(folder.listing().size() == 2);
}

TEST_CASE("clips have all frames, their size and rate, and leave no frames behind") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  const Words view{"--to", "2000", "--fps", "12.5", "--size", "128x64", "--slice", "z=0", "--quiet"};
  for (const std::string name : {"c.mp4", "c.webm"}) {
    CAPTURE(name);
    must_run(animate(scene, folder.file(name)) + view);
    CHECK(!fs::exists(folder.file(name) + ".frames"));
    const json probed =
        json::parse(output_of("ffprobe -v error -count_frames -of json -show_entries "
                              "stream=codec_name,nb_read_frames,r_frame_rate,width,height,color_space " +
                              folder.file(name)));
    CHECK(probed["streams"].size() == 1);
    const json& stream = probed["streams"][0];
    CHECK(stream["codec_name"] == (name == "c.mp4" ? "h264" : "vp9"));
    CHECK(stream["nb_read_frames"] == "25");  // 2000 ms at 12.5 a second
    CHECK(stream["r_frame_rate"] == "25/2");
    CHECK(stream["width"] == 128);
    CHECK(stream["height"] == 64);
    CHECK(stream["color_space"] == "bt709");

    // The slice is a square amid the picture; the core's half amid that. Beside it: white, or transparent.
    const std::string decoded = decode(folder.file(name), name == "c.webm" ? "-c:v libvpx-vp9" : "");
    REQUIRE(decoded.size() == 25u * 4 * 128 * 64);
    const std::string rgba = decoded.substr(24u * 4 * 128 * 64);  // the last frame
    const std::size_t row = 32 * 128;
    check_pixel(rgba, row + 64, {255, 128, 0, 255}, 6);
    check_pixel(rgba, row + 40, {0, 0, 255, 255}, 6);
    if (name == "c.mp4") {
      check_pixel(rgba, row + 8, {255, 255, 255, 255}, 6);
    } else {
      CHECK(static_cast<unsigned char>(rgba[4 * (row + 8) + 3]) <= 6);
    }
  }
  CHECK(folder.listing().size() == 3);
}

TEST_CASE("a clip is made of shares, by the run without --frames; --keep-frames keeps them") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  const std::string clip = folder.file("c.webm");
  CHECK(
      holds(must_run(animate(scene, clip) + small + Words{"--frames", "4-9"}).out, "without --frames makes the clip"));
  CHECK(!fs::exists(clip));
  CHECK(holds(must_run(animate(scene, clip) + small + Words{"--keep-frames"}).out, "6 of them drawn before"));
  CHECK(fs::exists(clip));
  CHECK(folder.listing().size() == 3 + 11);  // the scene, the clip, the folder with frames and manifest
}

TEST_CASE("what a clip cannot be is refused before anything is drawn") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  const Words span{"--to", "1000"};
  struct Case {
    Words words;
    int exit_code;
    std::vector<std::string> said;
  };
  for (const Case& one : std::vector<Case>{
           {animate(scene, folder.file("c.mp4")) + span + Words{"--size", "33x24"}, 2, {"33x24", "even", "34x24"}},
           {animate(scene, folder.file("c.mp4")) + span + Words{"--size", "32x25"}, 2, {"32x25", "32x26"}},
           {animate(scene, folder.file("c.avi")) + span, 1, {".mp4", ".webm", ".png"}},
           {animate(scene, folder.file("no/c.mp4")) + span, 1, {"does not exist", "mkdir"}},
           {animate(scene, folder.file("frame.png")) + span, 2, {"number", "frames_%04d.png"}},
           {animate(scene, folder.file("c.mp4")), 2, {"--to"}},
           {animate(scene, folder.file("c.mp4")) + Words{"--to", "0"}, 2, {"--to", "--from"}},
           {animate(scene, folder.file("c.mp4")) + Words{"--to", "nan"}, 2, {"finite"}},
           {animate(scene, folder.file("c.mp4")) + span + Words{"--fps", "0"}, 2, {"--fps"}},
           {animate(scene, folder.file("c.mp4")) + span + Words{"--fps", "1e9"}, 2, {"frames"}},
           {animate(scene, folder.file("c.mp4")) + span + Words{"--frames", "20-30"}, 2, {"--frames", "0 to 29"}},
           {animate(scene, folder.file("f%d.png")) + span + Words{"--keep-frames"}, 2, {"--keep-frames"}},
           {animate(scene, folder.file("f%d.png")) + span + Words{"--size", "16384x16", "--samples", "16"},
            1,
            {"16384"}},
           {animate(folder.file("absent.voml"), folder.file("f%d.png")) + span, 1, {"absent.voml"}}}) {
    const Run run = run_dmvv(one.words);
    CAPTURE(run.err);
    CHECK(run.exit_code == one.exit_code);
    CHECK(run.out.empty());
    for (const std::string& word : one.said) CHECK_MESSAGE(holds(run.err, word), word);
  }
  CHECK(folder.listing().size() == 1);
}

TEST_CASE("without ffmpeg clips are refused at once, frames are not") {
  const Folder folder, nothing;
  const std::string scene = folder.write("s.voml", nested_cubes);
  const Path path(nothing.file(""));
  const Run run = run_dmvv(animate(scene, folder.file("c.mp4")) + small);
  CHECK(run.exit_code == 2);
  CHECK(holds(run.err, "ffmpeg"));
  CHECK(holds(run.err, "apt-get install ffmpeg"));
  CHECK(folder.listing().size() == 1);
  must_run(animate(scene, folder.file("f%d.png")) + small);
}

TEST_CASE("an ffmpeg that fails is quoted, the frames are kept, and the next run encodes them") {
  const Folder folder, programs;
  const std::string scene = folder.write("s.voml", nested_cubes);
  const Words words = animate(scene, folder.file("c.mp4")) + small;
  // One that reads nothing, one that fails after the last frame.
  for (const char* script : {"#!/bin/sh\necho no such codec >&2\nexit 1\n",
                             "#!/bin/sh\n/bin/cat >/dev/null\necho no such codec >&2\nexit 1\n"}) {
    fs::permissions(programs.write("ffmpeg", script), fs::perms::owner_all);
    const Path path(programs.file(""));
    const Run run = run_dmvv(words);
    CHECK(run.exit_code == 2);
    CHECK(run.out.empty());
    CHECK_MESSAGE(holds(run.err, "no such codec"), run.err);
    CHECK(folder.listing().size() == 1 + 1 + 11);
  }
  CHECK(holds(must_run(words).out, "10 of them drawn before"));
  CHECK(folder.listing().size() == 2);
}

TEST_CASE("a bar is drawn on a terminal only, and --quiet says nothing") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  for (const bool quiet : {false, true}) {
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
    REQUIRE(terminal >= 0);
    REQUIRE(grantpt(terminal) == 0);
    REQUIRE(unlockpt(terminal) == 0);
    const Words words = animate(scene, folder.file("f%d.png")) + small + Words{"--restart"};
    const int slave = open(ptsname(terminal), O_RDWR | O_NOCTTY);  // what was written stays readable while this is open
    const pid_t process = start_dmvv(quiet ? words + Words{"--quiet"} : words, ptsname(terminal));
    CHECK(status_of(process) == 0);
    fcntl(terminal, F_SETFL, O_NONBLOCK);
    std::array<char, 4096> buffer{};
    const ssize_t count = read(terminal, buffer.data(), buffer.size());
    const std::string text(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    CHECK(holds(text, "frames [--------------------] 0/10   0 %") == !quiet);
    CHECK(text.empty() == quiet);
    close(slave);
    close(terminal);
  }
  const Run run = must_run(animate(scene, folder.file("f%d.png")) + small + Words{"--quiet"});
  CHECK(run.out.empty());
  CHECK(run.err.empty());
}
