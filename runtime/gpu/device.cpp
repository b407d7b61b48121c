// Opens a Vulkan device: instance, validation, choice of the device, queue; and makes its buffers and images.
#include "runtime/gpu/device.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <string_view>

#include "base/text.h"
#include "compiler/layout/scene_buffers.h"
#include "runtime/gpu/gpu.h"
#include "runtime/gpu/own_sines.h"

namespace dmvv::runtime {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL collect_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                               const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  auto& log = *static_cast<MessageLog*>(user);
  try {
    const std::lock_guard lock(log.mutex);
    log.messages.emplace_back(data->pMessage);
  } catch (...) {  // a driver must not see an exception
  }
  return VK_FALSE;
}

vk::DebugUtilsMessengerCreateInfoEXT messenger_info(MessageLog& log) {
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  return {.messageSeverity = Severity::eWarning | Severity::eError,
          .messageType = Type::eValidation | Type::ePerformance,
          .pfnUserCallback = collect_message,
          .pUserData = &log};
}

bool has_validation_layer(const vk::raii::Context& context) {
  return std::ranges::any_of(context.enumerateInstanceLayerProperties(), [](const vk::LayerProperties& layer) {
    return std::string_view(layer.layerName) == validation_layer;
  });
}

tl::unexpected<Error> no_driver(std::string reason) {
  return fail(Fault::environment, "no Vulkan driver was found",
              {std::move(reason),
               "on Debian, the package mesa-vulkan-drivers holds a software driver and those for Intel and AMD",
               "NVIDIA's driver packages bring their own"});
}

/// An instance, with the validation layer (synchronisation checks included) if a log is given.
Result<vk::raii::Instance> make_instance(const vk::raii::Context& context, MessageLog* log) {
  std::vector<const char*> layers, extensions;
  const std::array checks{vk::ValidationFeatureEnableEXT::eSynchronizationValidation};
  vk::ValidationFeaturesEXT features{.enabledValidationFeatureCount = checks.size(),
                                     .pEnabledValidationFeatures = checks.data()};
  vk::DebugUtilsMessengerCreateInfoEXT messenger;
  const void* next = nullptr;
  if (log != nullptr) {
    if (!has_validation_layer(context)) {
      return fail(Fault::environment, "the Vulkan validation layer is not installed",
                  {"on Debian, it is in the package vulkan-validationlayers"});
    }
    layers = {validation_layer};
    extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
    messenger = messenger_info(*log);
    features.pNext = &messenger;
    next = &features;
  }
  const vk::ApplicationInfo application{.pApplicationName = "dmvv", .apiVersion = VK_API_VERSION_1_2};
  try {
    return vk::raii::Instance(context, {.pNext = next,
                                        .pApplicationInfo = &application,
                                        .enabledLayerCount = static_cast<std::uint32_t>(layers.size()),
                                        .ppEnabledLayerNames = layers.data(),
                                        .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                                        .ppEnabledExtensionNames = extensions.data()});
  } catch (const vk::IncompatibleDriverError& error) {
    return no_driver(error.what());
  }
}

const char* kind_name(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return "discrete";
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return "integrated";
    case vk::PhysicalDeviceType::eVirtualGpu:
      return "virtual";
    case vk::PhysicalDeviceType::eCpu:
      return "cpu";
    default:
      return "other";
  }
}

int preference(const DeviceInfo& info) {
  constexpr std::array<std::string_view, 4> order{"discrete", "integrated", "virtual", "cpu"};
  return static_cast<int>(std::ranges::find(order, info.kind) - order.begin());
}

std::string version_text(std::uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

vk::PhysicalDeviceDriverProperties driver_of(const vk::raii::PhysicalDevice& physical) {
  return physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>()
      .get<vk::PhysicalDeviceDriverProperties>();
}

DeviceExtras extras_of(const vk::raii::PhysicalDevice& physical) {
  constexpr std::uint32_t least_storage_buffer = 1u << 27;  // bytes that every device allows
  const auto chain = physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>();
  const auto& features = chain.get<vk::PhysicalDeviceFeatures2>().features;
  return {
      .long_atomics = features.shaderInt64 && chain.get<vk::PhysicalDeviceVulkan12Features>().shaderBufferInt64Atomics,
      .large_texel_buffers = physical.getProperties().limits.maxTexelBufferElements >= least_storage_buffer / 4,
      .two_word_texels = features.shaderStorageImageExtendedFormats == VK_TRUE,
      .fine_sines = driver_of(physical).driverID != vk::DriverId::eGoogleSwiftshader};
}

std::string driver_text(const vk::PhysicalDeviceProperties& properties,
                        const vk::PhysicalDeviceDriverProperties& driver) {
  const std::string info = driver.driverInfo.data();
  return fmt::format("{} ({})", driver.driverName.data(), info.empty() ? version_text(properties.driverVersion) : info);
}

DeviceInfo describe(const vk::raii::PhysicalDevice& physical, const DeviceExtras& extras) {
  const vk::PhysicalDeviceProperties properties = physical.getProperties();
  const vk::PhysicalDeviceLimits& limits = properties.limits;
  const bool has_record_texels = extras.two_word_texels && limits.maxPerStageDescriptorStorageImages >=
                                                               images_of_pixels + compiler::most_texel_buffers;
  return {.name = properties.deviceName,
          .kind = kind_name(properties.deviceType),
          .driver = driver_text(properties, driver_of(physical)),
          .api_version = version_text(properties.apiVersion),
          .max_extent_3d = limits.maxImageDimension3D,
          .max_storage_buffer = limits.maxStorageBufferRange,
          .max_texel_buffer_elements = has_record_texels ? limits.maxTexelBufferElements : 0};
}

std::optional<std::uint32_t> compute_queue_family(const vk::raii::PhysicalDevice& physical) {
  const auto families = physical.getQueueFamilyProperties();
  for (std::uint32_t i = 0; i < families.size(); ++i) {
    if (families[i].queueFlags & vk::QueueFlagBits::eCompute) return i;
  }
  return std::nullopt;
}

/// What a device lacks of what every program needs; empty: it can run them. The rest of what kernels use is core in
/// Vulkan 1.2 or lies within the limits that it guarantees.
std::vector<std::string> lacks(const vk::raii::PhysicalDevice& physical) {
  const vk::PhysicalDeviceProperties properties = physical.getProperties();
  if (properties.apiVersion < VK_API_VERSION_1_2)  // nor may it be asked for more
    return {fmt::format("Vulkan 1.2: it has {}", version_text(properties.apiVersion))};
  std::vector<std::string> missing;
  if (!compute_queue_family(physical)) missing.emplace_back("a queue for compute shaders");

  using Feature = vk::SubgroupFeatureFlagBits;
  const auto chain = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupProperties>();
  const auto& subgroups = chain.get<vk::PhysicalDeviceSubgroupProperties>();
  constexpr auto needed = Feature::eBasic | Feature::eArithmetic | Feature::eBallot;  // shaders/pixel_list.glsl
  if ((subgroups.supportedOperations & needed) != needed ||
      !(subgroups.supportedStages & vk::ShaderStageFlagBits::eCompute))
    missing.emplace_back("subgroup arithmetic and ballots in compute shaders");

  const auto require = [&](std::uint32_t there, std::uint32_t wanted, std::string_view what, std::string_view limit) {
    if (there < wanted) missing.push_back(fmt::format("{} {} a stage: it has {} ({})", wanted, what, there, limit));
  };
  const vk::PhysicalDeviceLimits& limits = properties.limits;
  require(limits.maxPerStageDescriptorStorageBuffers, buffers_of_pixels, "storage buffers",
          "maxPerStageDescriptorStorageBuffers");
  require(limits.maxPerStageDescriptorStorageImages, images_of_pixels, "storage images",
          "maxPerStageDescriptorStorageImages");
  return missing;
}

struct Choice {
  vk::raii::PhysicalDevice physical;
  DeviceExtras extras;
  DeviceInfo info;
};

/// A device that cannot run programs, and why.
struct Refusal {
  std::string name;
  std::vector<std::string> lacks;
};

struct Offer {
  std::vector<Choice> usable;  ///< best first
  std::vector<Refusal> refused;
};

/// All devices; none if every driver failed to start.
std::vector<vk::raii::PhysicalDevice> all_devices(const vk::raii::Instance& instance) {
  try {
    return instance.enumeratePhysicalDevices();
  } catch (const vk::InitializationFailedError&) {
    return {};
  }
}

Offer offered_devices(const vk::raii::Instance& instance) {
  Offer offer;
  for (auto& physical : all_devices(instance)) {
    if (auto missing = lacks(physical); !missing.empty()) {
      offer.refused.push_back({physical.getProperties().deviceName, std::move(missing)});
      continue;
    }
    const DeviceExtras extras = extras_of(physical);
    DeviceInfo info = describe(physical, extras);
    offer.usable.push_back({std::move(physical), extras, std::move(info)});
  }
  std::ranges::stable_sort(offer.usable, {}, [](const Choice& choice) {
    return std::pair(preference(choice.info), choice.extras.long_atomics ? 0 : 1);
  });
  return offer;
}

std::string refusal_text(const Refusal& refused) {
  return fmt::format("{} lacks {}", refused.name, fmt::join(refused.lacks, "; "));
}

Result<Choice> choose(Offer offer, const std::string& name) {
  if (offer.usable.empty() && offer.refused.empty()) return no_driver("no installed driver offers a device");
  const auto is_meant = [wanted = lower_case(name)](const std::string& other) {
    return lower_case(other).find(wanted) != std::string::npos;
  };
  const auto chosen =
      std::ranges::find_if(offer.usable, [&](const Choice& choice) { return is_meant(choice.info.name); });
  if (chosen != offer.usable.end()) return std::move(*chosen);
  std::vector<std::string> reasons;
  for (const Refusal& refused : offer.refused)
    if (is_meant(refused.name)) reasons.push_back(refusal_text(refused));
  const std::string what = offer.usable.empty() ? "no Vulkan device here can run programs"
                           : reasons.empty()
                               ? fmt::format("no Vulkan device has '{}' in its name", name)
                               : fmt::format("no Vulkan device with '{}' in its name can run programs", name);
  if (reasons.empty())
    for (const Refusal& refused : offer.refused) reasons.push_back(refusal_text(refused));
  for (const Choice& choice : offer.usable)
    reasons.push_back(fmt::format("there is: {} ({})", choice.info.name, choice.info.kind));
  return fail(Fault::environment, what, std::move(reasons));
}

void open_queue(Device::Impl& impl) {
  const std::uint32_t family = compute_queue_family(impl.physical).value();
  const float priority = 1.0f;
  const vk::DeviceQueueCreateInfo queue{.queueFamilyIndex = family, .queueCount = 1, .pQueuePriorities = &priority};
  const vk::PhysicalDeviceVulkan12Features newer{.shaderBufferInt64Atomics = impl.extras.long_atomics};
  const vk::PhysicalDeviceFeatures features{.shaderStorageImageExtendedFormats = impl.extras.two_word_texels,
                                            .shaderInt64 = impl.extras.long_atomics};
  impl.device = vk::raii::Device(
      impl.physical,
      {.pNext = &newer, .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue, .pEnabledFeatures = &features});
  impl.queue = Queue(impl.physical, impl.device, family);
  impl.limits = impl.physical.getProperties().limits;
}

Result<Device> open_device(const DeviceOptions& options, bool has_extras = true) {
  auto impl = std::make_unique<Device::Impl>();
  auto instance = make_instance(impl->context, options.validation ? impl->log.get() : nullptr);
  if (!instance) return tl::unexpected(instance.error());
  impl->instance = std::move(*instance);
  if (options.validation) impl->messenger = impl->instance.createDebugUtilsMessengerEXT(messenger_info(*impl->log));
  auto choice = choose(offered_devices(impl->instance), options.name);
  if (!choice) return tl::unexpected(choice.error());
  impl->physical = std::move(choice->physical);
  impl->extras = has_extras ? choice->extras : DeviceExtras{};
  impl->info = describe(impl->physical, impl->extras);
  impl->cache = options.cache;
  open_queue(*impl);
  return Device(std::move(impl));
}

}  // namespace

Device::Impl::Impl() : log(std::make_shared<MessageLog>()), context(&vkGetInstanceProcAddr) {}

vk::raii::DeviceMemory Device::Impl::allocate(const vk::MemoryRequirements& needs, MemoryUse use) const {
  using Property = vk::MemoryPropertyFlagBits;
  vk::MemoryPropertyFlags required, wanted;
  if (use == MemoryUse::device) wanted = Property::eDeviceLocal;
  if (use != MemoryUse::device) required = Property::eHostVisible | Property::eHostCoherent;
  if (use == MemoryUse::readback) wanted = Property::eHostCached;
  const auto memory = physical.getMemoryProperties();
  const auto find = [&](vk::MemoryPropertyFlags flags) -> std::optional<std::uint32_t> {
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
      if ((needs.memoryTypeBits >> i & 1u) != 0 && (memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
    }
    return std::nullopt;
  };
  const auto best = find(required | wanted);
  const auto type = best ? best : find(required);
  if (!type) throw vk::FeatureNotPresentError("no memory type for a buffer or image");
  return {device, {.allocationSize = needs.size, .memoryTypeIndex = *type}};
}

GpuBuffer Device::Impl::make_buffer(vk::DeviceSize bytes, vk::BufferUsageFlags usage, MemoryUse use) const {
  GpuBuffer made;
  made.bytes = bytes;
  made.buffer = device.createBuffer({.size = bytes, .usage = usage});
  made.memory = allocate(made.buffer.getMemoryRequirements(), use);
  made.buffer.bindMemory(*made.memory, 0);
  if (use != MemoryUse::device) made.mapped = made.memory.mapMemory(0, VK_WHOLE_SIZE);
  return made;
}

GpuImage Device::Impl::make_image(vk::ImageType type, vk::Format format, vk::Extent3D extent,
                                  vk::ImageUsageFlags usage) const {
  GpuImage made;
  made.image = device.createImage({.imageType = type,
                                   .format = format,
                                   .extent = extent,
                                   .mipLevels = 1,
                                   .arrayLayers = 1,
                                   .samples = vk::SampleCountFlagBits::e1,
                                   .tiling = vk::ImageTiling::eOptimal,
                                   .usage = usage});
  made.memory = allocate(made.image.getMemoryRequirements(), MemoryUse::device);
  made.image.bindMemory(*made.memory, 0);
  made.view = device.createImageView(
      {.image = *made.image,
       .viewType = type == vk::ImageType::e3D ? vk::ImageViewType::e3D : vk::ImageViewType::e2D,
       .format = format,
       .subresourceRange = {.aspectMask = vk::ImageAspectFlagBits::eColor, .levelCount = 1, .layerCount = 1}});
  return made;
}

vk::raii::ShaderModule Device::Impl::make_shader(const std::uint32_t* words, std::size_t count) const {
  std::vector<std::uint32_t> rewritten;
  if (!extras.fine_sines) {
    rewritten = with_own_sines({words, count});
    words = rewritten.data();
    count = rewritten.size();
  }
  return device.createShaderModule({.codeSize = 4 * count, .pCode = words});
}

vk::ImageMemoryBarrier color_barrier(vk::Image image, vk::ImageLayout from, vk::ImageLayout to, vk::AccessFlags before,
                                     vk::AccessFlags after) {
  return {.srcAccessMask = before,
          .dstAccessMask = after,
          .oldLayout = from,
          .newLayout = to,
          .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .image = image,
          .subresourceRange = {.aspectMask = vk::ImageAspectFlagBits::eColor, .levelCount = 1, .layerCount = 1}};
}

Stopwatch::Stopwatch(Timings* timings, const char* step)
    : timings_(timings),
      step_(step),
      start_ns_(std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1)) {}

Stopwatch::~Stopwatch() {
  if (timings_ == nullptr) return;
  const std::int64_t now_ns = std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  try {
    timings_->push_back({step_, 1e-6 * static_cast<double>(now_ns - start_ns_)});
  } catch (const std::bad_alloc&) {  // a missing time is no reason to fail
  }
}

Device::Device(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<Device> Device::create(const DeviceOptions& options) {
  return guarded("opening the device", [&] { return open_device(options); });
}

Result<Device> create_without_extras(const DeviceOptions& options) {
  return guarded("opening the device", [&] { return open_device(options, false); });
}

std::shared_future<Result<Device>> Device::create_async(const DeviceOptions& options) {
  return std::async(std::launch::async,
                    [options] { return guarded("opening the device", [&] { return open_device(options); }); });
}

const DeviceInfo& Device::info() const { return impl_->info; }

std::shared_ptr<const DiskCache> Device::cache() const { return impl_->cache; }

std::vector<std::string> Device::validation_messages() const {
  const std::lock_guard lock(impl_->log->mutex);
  return impl_->log->messages;
}

Result<std::vector<DeviceInfo>> list_devices() {
  return guarded("listing the devices", []() -> Result<std::vector<DeviceInfo>> {
    const vk::raii::Context context(&vkGetInstanceProcAddr);
    const auto instance = make_instance(context, nullptr);
    if (!instance) return tl::unexpected(instance.error());
    std::vector<DeviceInfo> infos;
    for (Choice& choice : offered_devices(*instance).usable) infos.push_back(std::move(choice.info));
    return infos;
  });
}

}  // namespace dmvv::runtime
