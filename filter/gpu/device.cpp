#include "filter/gpu/device.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "filter/gpu/device_impl.h"
#include "filter/gpu/program_impl.h"

namespace becalm::gpu {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
/// What to do where the loader finds no driver: variables of its environment tell it where to look.
std::string no_driver() {
  for (const char* variable : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES"}) {  // in the loader's order
    const char* value = std::getenv(variable);
    if (value != nullptr && *value != '\0')
      return std::string("no Vulkan driver found in ") + variable + "=" + value + "; correct or unset it";
  }
  return "no Vulkan driver found; install one, such as Debian's mesa-vulkan-drivers, which has a software "
         "device too";
}

struct Candidate {
  vk::raii::PhysicalDevice device = nullptr;
  std::uint32_t queue_family = 0;
  DeviceInfo info;
};

vk::raii::Context load_vulkan() {
  try {
    return vk::raii::Context();
  } catch (const std::runtime_error&) {
    throw DeviceError(
        "the Vulkan loader libvulkan.so.1 is missing; install Debian's libvulkan1 and mesa-vulkan-drivers");
  }
}

VKAPI_ATTR VkBool32 VKAPI_CALL collect_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                               VkDebugUtilsMessageTypeFlagsEXT,
                                               const VkDebugUtilsMessengerCallbackDataEXT* data,
                                               void* messages) {
  std::string line = data->pMessage;
  std::ranges::replace(line, '\n', ' ');
  auto& said = *static_cast<ValidationMessages*>(messages);
  const std::scoped_lock lock(said.mutex);
  said.lines.push_back(std::move(line));
  return VK_FALSE;
}

template <class Properties>
bool has_extension(const Properties& properties, std::string_view name) {
  return std::ranges::any_of(properties, [&](const auto& p) { return name == p.extensionName.data(); });
}

/// The messenger appends to `messages`, which is null without validation.
vk::raii::Instance create_instance(const vk::raii::Context& context, ValidationMessages* messages,
                                   bool& has_debug_utils) {
  if (context.enumerateInstanceVersion() < VK_API_VERSION_1_3) {
    throw DeviceError("the Vulkan loader is older than 1.3; install a newer libvulkan1");
  }
  const auto extensions = context.enumerateInstanceExtensionProperties();
  const vk::ApplicationInfo application("becalm", 1, nullptr, 0, VK_API_VERSION_1_3);
  vk::InstanceCreateInfo create({}, &application);
  std::vector<const char*> enabled;
  std::vector<const char*> layers;
  has_debug_utils = has_extension(extensions, VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  if (has_debug_utils) enabled.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  if (has_extension(extensions, VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME)) {
    enabled.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
    create.flags |= vk::InstanceCreateFlagBits::eEnumeratePortabilityKHR;
  }
  const vk::ValidationFeatureEnableEXT synchronization =
      vk::ValidationFeatureEnableEXT::eSynchronizationValidation;
  const vk::ValidationFeaturesEXT validation(1, &synchronization);
  if (messages) {
    const auto available = context.enumerateInstanceLayerProperties();
    const bool has_layer = std::ranges::any_of(available, [](const auto& layer) {
      return std::string_view(kValidationLayer) == layer.layerName.data();
    });
    if (!has_layer) {
      throw DeviceError(std::string("the Vulkan layer ") + kValidationLayer +
                        " is missing; install Debian's vulkan-validationlayers");
    }
    layers.push_back(kValidationLayer);
    enabled.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    create.pNext = &validation;
  }
  create.setPEnabledExtensionNames(enabled).setPEnabledLayerNames(layers);
  return vk::raii::Instance(context, create);
}

vk::raii::DebugUtilsMessengerEXT create_messenger(const vk::raii::Instance& instance,
                                                  ValidationMessages* messages) {
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  const vk::DebugUtilsMessengerCreateInfoEXT create({}, Severity::eWarning | Severity::eError,
                                                    Type::eValidation, collect_message, messages);
  return {instance, create};
}

std::string type_name(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return "discrete GPU";
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return "integrated GPU";
    case vk::PhysicalDeviceType::eVirtualGpu:
      return "virtual GPU";
    case vk::PhysicalDeviceType::eCpu:
      return "software";
    default:
      return "other";
  }
}

/// Rank of a device; the lowest is taken if no device is selected.
int preference(const DeviceInfo& info) {
  constexpr std::array order = {"discrete GPU", "integrated GPU", "virtual GPU", "other", "software"};
  return static_cast<int>(std::ranges::find(order, info.type) - order.begin());
}

std::optional<Candidate> examine(const vk::raii::PhysicalDevice& device) {
  const auto chain =
      device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
  const vk::PhysicalDeviceProperties& properties = chain.get<vk::PhysicalDeviceProperties2>().properties;
  if (properties.apiVersion < VK_API_VERSION_1_3) return std::nullopt;
  const auto families = device.getQueueFamilyProperties();
  const auto compute = std::ranges::find_if(
      families, [](const auto& family) { return bool(family.queueFlags & vk::QueueFlagBits::eCompute); });
  if (compute == families.end()) return std::nullopt;

  const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
  Candidate result{device, static_cast<std::uint32_t>(compute - families.begin()), {}};
  result.info.name = properties.deviceName.data();
  result.info.type = type_name(properties.deviceType);
  result.info.is_processor = properties.deviceType == vk::PhysicalDeviceType::eCpu;
  result.info.driver = std::string(driver.driverName.data()) + " " + driver.driverInfo.data();
  result.info.max_storage_buffer_bytes = properties.limits.maxStorageBufferRange;
  result.info.max_texel_buffer_elements = properties.limits.maxTexelBufferElements;
  const auto memory = device.getMemoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
    const vk::MemoryHeap& heap = memory.memoryHeaps[i];
    if (heap.flags & vk::MemoryHeapFlagBits::eDeviceLocal) {
      result.info.memory_bytes = std::max<std::uint64_t>(result.info.memory_bytes, heap.size);
    }
  }
  return result;
}

std::vector<Candidate> find_candidates(const vk::raii::Instance& instance) {
  std::vector<Candidate> result;
  for (const vk::raii::PhysicalDevice& device : vk::raii::PhysicalDevices(instance)) {
    if (auto candidate = examine(device)) {
      candidate->info.index = static_cast<int>(result.size());
      result.push_back(std::move(*candidate));
    }
  }
  return result;
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

Candidate choose(const std::vector<Candidate>& candidates, const std::string& select) {
  if (candidates.empty()) throw DeviceError(no_driver());
  if (select.empty()) {
    return *std::ranges::min_element(candidates, {}, [](const Candidate& c) { return preference(c.info); });
  }
  std::size_t index = 0;
  const char* const end = select.data() + select.size();
  const auto [stopped, error] = std::from_chars(select.data(), end, index);
  const bool is_index = error == std::errc() && stopped == end;
  if (is_index && index < candidates.size()) return candidates[index];
  std::string available;
  for (const Candidate& candidate : candidates) {
    if (!is_index && lower(candidate.info.name).find(lower(select)) != std::string::npos) return candidate;
    available +=
        (available.empty() ? "" : ", ") + std::to_string(candidate.info.index) + " " + candidate.info.name;
  }
  throw DeviceError("no Vulkan device '" + select + "'; there is: " + available);
}

vk::raii::Device create_device(const Candidate& chosen) {
  const float priority = 1.0f;
  const vk::DeviceQueueCreateInfo queue({}, chosen.queue_family, 1, &priority);
  std::vector<const char*> extensions;
  constexpr const char* portability = "VK_KHR_portability_subset";  // must be enabled where a device has it
  if (has_extension(chosen.device.enumerateDeviceExtensionProperties(), portability)) {
    extensions.push_back(portability);
  }
  vk::PhysicalDeviceVulkan13Features features;
  features.synchronization2 = true;
  features.maintenance4 = true;  // glslang writes local sizes as LocalSizeId for 1.3
  vk::DeviceCreateInfo create({}, queue, {}, extensions);
  create.pNext = &features;
  return {chosen.device, create};
}

}  // namespace

std::string format_mib(std::uint64_t bytes) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
  return text.data();
}

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> result;
  try {
    const vk::raii::Context context = load_vulkan();
    bool has_debug_utils = false;
    const vk::raii::Instance instance = create_instance(context, nullptr, has_debug_utils);
    for (const Candidate& candidate : find_candidates(instance)) result.push_back(candidate.info);
  } catch (const vk::SystemError&) {
    result.clear();  // a loader without a working driver
  } catch (const DeviceError&) {
    result.clear();  // no loader, or one older than 1.3
  }
  return result;
}

Device::Impl::Impl(const DeviceOptions& options) : context(load_vulkan()) {
  Candidate chosen;
  try {
    instance = create_instance(context, options.validation ? &messages : nullptr, has_debug_utils);
    if (options.validation) messenger = create_messenger(instance, &messages);
    chosen = choose(find_candidates(instance), options.select);
  } catch (const vk::IncompatibleDriverError&) {
    throw DeviceError(no_driver());
  } catch (const vk::InitializationFailedError&) {
    throw DeviceError(no_driver());
  } catch (const vk::SystemError& error) {
    throw DeviceError(std::string("Vulkan cannot be started: ") + error.what());
  }
  info = chosen.info;
  queue_family = chosen.queue_family;
  physical_device = std::move(chosen.device);
  guarded("device '" + info.name + "' cannot be opened", [&] {
    device = create_device({physical_device, queue_family, info});
    queue = device.getQueue(queue_family, 0);
    programs = std::make_unique<Programs>(*this);
  });

  const auto chain =
      physical_device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceVulkan11Properties,
                                     vk::PhysicalDeviceVulkan13Properties>();
  limits = chain.get<vk::PhysicalDeviceProperties2>().properties.limits;
  max_allocation_bytes = chain.get<vk::PhysicalDeviceVulkan11Properties>().maxMemoryAllocationSize;
  max_buffer_bytes = chain.get<vk::PhysicalDeviceVulkan13Properties>().maxBufferSize;
  memory_properties = physical_device.getMemoryProperties();
  timestamp_bits = physical_device.getQueueFamilyProperties()[queue_family].timestampValidBits;
}

Device::Impl::~Impl() = default;

std::uint32_t Device::Impl::memory_type(std::uint32_t types, vk::MemoryPropertyFlags needed,
                                        vk::MemoryPropertyFlags wanted) const {
  for (const vk::MemoryPropertyFlags flags : {needed | wanted, needed}) {
    for (std::uint32_t i = 0; i < memory_properties.memoryTypeCount; ++i) {
      if ((types >> i & 1u) != 0 && (memory_properties.memoryTypes[i].propertyFlags & flags) == flags)
        return i;
    }
  }
  throw DeviceError("device '" + info.name + "' has no memory of type " + vk::to_string(needed));
}

HostBuffer Device::Impl::create_host_buffer(std::uint64_t bytes, vk::BufferUsageFlags usage,
                                            const std::string& name) const {
  using Memory = vk::MemoryPropertyFlagBits;
  HostBuffer result;
  result.bytes = bytes;
  result.buffer = {device, vk::BufferCreateInfo({}, bytes, usage)};
  set_name(result.buffer, name);
  const vk::MemoryRequirements needs = result.buffer.getMemoryRequirements();
  // Cached, since the host reads uncached memory at a fraction of the speed.
  const std::uint32_t type =
      memory_type(needs.memoryTypeBits, Memory::eHostVisible | Memory::eHostCoherent, Memory::eHostCached);
  result.memory = {device, vk::MemoryAllocateInfo(needs.size, type)};
  result.buffer.bindMemory(*result.memory, 0);
  result.mapped = static_cast<std::byte*>(result.memory.mapMemory(0, VK_WHOLE_SIZE));
  return result;
}

void Device::Impl::check_validation(std::string_view what) {
  if (messages.lines.size() == messages_checked) return;
  const std::string& first = messages.lines[messages_checked];
  messages_checked = messages.lines.size();
  throw DeviceError(std::string(what) + ": validation: " + first);
}

Device::Device(const DeviceOptions& options) : impl_(std::make_unique<Impl>(options)) {}

Device::~Device() = default;

const DeviceInfo& Device::info() const {
  return impl_->info;
}

const std::vector<std::string>& Device::validation_messages() const {
  return impl_->messages.lines;
}

}  // namespace becalm::gpu
