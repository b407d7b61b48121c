#include <unistd.h>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>

#include "runtime/gpu/gpu.h"
#include "session/device_profile.h"
#include "support.h"

using namespace dmvv;
using namespace dmvv::tests;
using runtime::Device;

TEST_CASE("devices are listed best first, and found by a part of the name in any case") {
  const auto devices = must(runtime::list_devices());
  REQUIRE_FALSE(devices.empty());
  const auto rank = [](const runtime::DeviceInfo& info) {
    return info.kind == "discrete"     ? 0
           : info.kind == "integrated" ? 1
           : info.kind == "virtual"    ? 2
           : info.kind == "cpu"        ? 3
                                       : 4;
  };
  CHECK(std::ranges::is_sorted(devices, {}, rank));
  CHECK(must(Device::create({})).info().name == devices.front().name);

  std::string part = devices.back().name.substr(1, 5);
  std::ranges::transform(part, part.begin(),
                         [](char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); });
  const Device found = must(Device::create({.name = part}));
  CHECK(found.info().max_extent_3d >= 256);  // what Vulkan guarantees
  CHECK(found.info().max_storage_buffer >= 1u << 27);
  CHECK(found.info().api_version >= "1.2");
  CHECK(found.validation_messages().empty());
}

TEST_CASE("an unknown device lists those there are") {
  const auto opened = Device::create({.name = "Voodoo 2"});
  REQUIRE_FALSE(opened);
  CHECK(opened.error().fault == Fault::environment);
  CHECK(opened.error().message == "no Vulkan device has 'Voodoo 2' in its name");
  REQUIRE_FALSE(opened.error().reasons.empty());
  CHECK(opened.error().reasons[0].find(must(runtime::list_devices())[0].name) != std::string::npos);
}

TEST_CASE("a program that exceeds the device is refused with both numbers") {
  compiler::Program program = tests::program(Show::position);
  const std::uint32_t limit = device().info().max_extent_3d;
  program.textures[0].extent = {limit + 1, 1, 1};
  program.textures[0].texels.resize(4 * (std::size_t{limit} + 1));
  const auto refused = runtime::Evaluator::create(device(), program);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().fault == Fault::input);
  CHECK(refused.error().message.find(fmt::format("'distance' is {} texels long", limit + 1)) != std::string::npos);
  CHECK(refused.error().message.find(fmt::format("allows {} ", limit)) != std::string::npos);

  program = tests::program(Show::position);
  const std::uint64_t largest = device().info().max_storage_buffer;
  if (largest <= std::uint64_t{1} << 30) {  // memory for the proof; other devices allow 4 GiB
    program.buffers[0].bytes.resize(largest + 16);
    const auto too_long = runtime::Evaluator::create(device(), program);
    REQUIRE_FALSE(too_long);
    CHECK(too_long.error().message.find(fmt::format("needs {} bytes", largest + 16)) != std::string::npos);
    CHECK(too_long.error().message.find(fmt::format("allows {} ", largest)) != std::string::npos);
  }
}

TEST_CASE("the validation layer is heard, also about synchronisation") {
  // Without this, quiet tests would prove nothing: a buffer is filled twice with nothing to order the writes.
  const Device watched = must(Device::create({.name = "", .validation = true}));
  const auto buffer = watched.impl().make_buffer(64, vk::BufferUsageFlagBits::eTransferDst, runtime::MemoryUse::device);
  watched.impl().run([&](const vk::raii::CommandBuffer& commands) {
    commands.fillBuffer(*buffer.buffer, 0, 64, 1);
    commands.fillBuffer(*buffer.buffer, 0, 64, 2);
  });
  const auto messages = watched.validation_messages();
  REQUIRE(messages.size() == 1);
  CHECK(messages[0].find("SYNC-HAZARD-WRITE-AFTER-WRITE") != std::string::npos);
}

TEST_CASE("a device's costs are measured once and kept; without a cache it counts as one of its kind") {
  const auto folder = std::filesystem::temp_directory_path() / ("dmvv_costs_" + std::to_string(::getpid()));
  {
    const auto cache = std::make_shared<const runtime::DiskCache>(folder.string());
    runtime::DeviceOptions options;
    options.cache = cache;
    Device device = must(Device::create(options));
    const bool is_cpu = device.info().kind == "cpu";
    const compiler::DeviceCosts of_kind = is_cpu ? compiler::costs_of_cpu() : compiler::costs_of_gpu();
    CHECK(session::costs_of(device) == of_kind);
    session::calibrate(device);
    const compiler::DeviceCosts measured = session::costs_of(device);
    CHECK_FALSE(measured == of_kind);
    CHECK(measured.line > 0.0);
    CHECK(measured.sample > measured.line);
    CHECK(measured.skipping >= 0.0);
    CHECK(measured.skipping <= 1.0);
    session::calibrate(device);
    CHECK(session::costs_of(device) == measured);

    Device plain = must(Device::create({}));
    session::calibrate(plain);
    CHECK(session::costs_of(plain) == of_kind);
  }
  std::filesystem::remove_all(folder);
}
