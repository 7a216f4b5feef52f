#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace becalm::gpu {

/// No device was found, it is out of memory or lost, or a chain is invalid. The message is one line and names
/// pass and image if there are any.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A chain needs more than the device can bind, dispatch or hold at once. The same chain over smaller images
/// may succeed.
class DeviceLimitError : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// Memory could not be allocated although the device should have it: other programs may hold it.
class DeviceMemoryError : public DeviceLimitError {
 public:
  using DeviceLimitError::DeviceLimitError;
};

struct DeviceInfo {
  int index = 0;
  std::string name;
  std::string type;           ///< "discrete GPU", "integrated GPU", "virtual GPU", "software", "other"
  bool is_processor = false;  ///< a software device: it uses the host's cores and memory
  std::string driver;
  std::uint64_t memory_bytes = 0;              ///< size of the largest device-local heap, in use or not
  std::uint64_t max_storage_buffer_bytes = 0;  ///< largest range of a storage buffer in one binding
  std::uint64_t max_texel_buffer_elements = 0;
};

/// Vulkan 1.3 devices with a compute queue, in the loader's order. Empty if there is no driver.
std::vector<DeviceInfo> list_devices();

struct DeviceOptions {
  std::string select;  ///< index or part of a name, case-insensitive; empty: a hardware GPU if there is one
  bool validation = false;  ///< validation layer with synchronization validation; any message is an error
};

/// An open device with one compute queue. Not copyable; may be used by one thread at a time.
class Device {
 public:
  /// Throws DeviceError if there is no driver (naming the Debian package to install), no such device or no
  /// validation layer.
  explicit Device(const DeviceOptions& options = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const;

  /// Validation messages so far; empty without validation, and with it in a correct program.
  const std::vector<std::string>& validation_messages() const;

  /// The Vulkan objects, for this library's own files (device_impl.h).
  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace becalm::gpu
