// The stress cases (bench/stress.h), each with what it must hold; prints their table. `--long`: more of everything.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string_view>

#include "bench/stress.h"

using namespace dmvv;

namespace {
bool long_form = false;
}

TEST_CASE("every stress case holds") {
  auto device = runtime::Device::create({.name = "", .validation = true});
  REQUIRE_MESSAGE(device, device.error().message);
  const auto cases = stress::run(*device, {.long_form = long_form}, [](const stress::Case& done) {
    fmt::print("{:<46} {:>10.4g} {} {:<7.3g} {:<15} {}\n", done.name, done.measured,
               done.at_least ? ">=" : "<=", done.bound, done.unit, done.detail);
    CHECK_MESSAGE(done.held,
                  done.name << ": " << done.what << ": " << done.measured << " " << done.unit << " " << done.detail);
  });
  REQUIRE_MESSAGE(cases, cases.error().message);
  CHECK(cases->size() > 40);
  for (const std::string& message : device->validation_messages()) FAIL_CHECK(message);
}

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) long_form |= std::string_view(argv[i]) == "--long";
  return doctest::Context(argc, argv).run();
}
