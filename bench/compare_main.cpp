// The program dmvv_bench_compare: two results, or several pairs of them, and what got worse.
#include <fmt/format.h>

#include <cstdio>

#include "base/files.h"
#include "bench/compare.h"

namespace {

constexpr int exit_worse = 1;
constexpr int exit_usage = 2;

int refuse(const dmvv::Error& error) {
  fmt::print(stderr, "dmvv_bench_compare: error: {}\n", error.message);
  for (const std::string& reason : error.reasons) fmt::print(stderr, "  {}\n", reason);
  return exit_usage;
}

}  // namespace

int main(int count, char** words) {
  if (count < 3 || count % 2 == 0 || std::string_view(words[1]).starts_with("-")) {
    return refuse(
        {dmvv::Fault::environment,
         "usage: compare A.json B.json [A2.json B2.json ...]",
         {"pairs of results of dmvv bench --json, before and after a change, measured in turns",
          "exit code: 0 nothing worse, 1 something slower beyond the noise or more wrong, 2 cannot compare"}});
  }
  const dmvv::ReadFile files = dmvv::disk_files();
  std::vector<std::pair<std::string, std::string>> pairs;
  for (int i = 1; i + 1 < count; i += 2) {
    auto before = files(words[i], 1u << 30);
    if (!before) return refuse(before.error());
    auto after = files(words[i + 1], 1u << 30);
    if (!after) return refuse(after.error());
    pairs.emplace_back(std::move(*before), std::move(*after));
  }
  const auto comparison = dmvv::bench::compare(pairs);
  if (!comparison) return refuse(comparison.error());
  fmt::print("{}", dmvv::bench::to_text(*comparison));
  return comparison->worse() ? exit_worse : 0;
}
