// Every target over its seeds (seeds.txt) and over all that the fuzzers ever found (corpus/TARGET): fuzz_replay
// [TARGET]
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "tests/fuzz/targets.h"

namespace fs = std::filesystem;
using namespace dmvv::fuzz;

namespace {

void collect(const fs::path& folder, const std::string& ending, std::vector<fs::path>& files) {
  if (!fs::exists(folder)) return;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && (ending == "*" || entry.path().extension() == ending)) files.push_back(entry.path());
  }
}

/// The files of a target, in the order of their names.
std::vector<fs::path> files_of(const std::string& target) {
  const fs::path source(DMVV_SOURCE_DIR);
  std::vector<fs::path> files;
  collect(source / "tests/fuzz/corpus" / target, "*", files);
  std::ifstream list(source / "tests/fuzz/seeds.txt");
  for (std::string line; std::getline(list, line);) {
    std::istringstream words(line);
    std::string name, folder, ending;
    if (words >> name >> folder >> ending && name == target) collect(source / folder, ending, files);
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t replayed = 0;
  for (const Target& target : targets) {
    if (argc > 1 && target.name != argv[1]) continue;
    const auto files = files_of(std::string(target.name));
    must(!files.empty(), "every target has files to replay");
    const auto start = std::chrono::steady_clock::now();
    for (const fs::path& path : files) {
      std::ifstream stream(path, std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
      std::fprintf(stderr, "%s %s\n", std::string(target.name).c_str(),
                   path.c_str());  // the last line tells of a crash
      target.run(bytes);
      ++replayed;
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%s: %zu files, %.2f s\n", std::string(target.name).c_str(), files.size(), seconds.count());
  }
  return replayed == 0;
}
