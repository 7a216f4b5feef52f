#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace becalm::gpu {

/// Trouble with the device: none found, out of memory, lost, or an invalid chain. One line, naming pass and
/// image where there is one.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// More than the device can bind, dispatch or hold at once: the same chain over smaller images may do.
class DeviceLimitError : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

struct DeviceInfo {
  int index = 0;
  std::string name;
  std::string type;           ///< "discrete GPU", "integrated GPU", "virtual GPU", "software", "other"
  bool is_processor = false;  ///< a software device: its memory is the host's, its cores are too
  std::string driver;
  std::uint64_t memory_bytes = 0;
  std::uint64_t max_storage_buffer_bytes = 0;
};

/// Vulkan 1.3 devices with a compute queue, in the loader's order. Empty if there is no driver.
std::vector<DeviceInfo> list_devices();

struct DeviceOptions {
  std::string select;  ///< index or part of a name, case-insensitive; empty: a hardware GPU if there is one
  bool validation = false;  ///< validation layer with synchronization validation; any message is an error
};

/// An open device with one compute queue. Not copied, shared by reference; one thread at a time.
class Device {
 public:
  /// Throws DeviceError: no driver (naming the Debian package to install), no such device, no validation
  /// layer.
  explicit Device(const DeviceOptions& options = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const;

  /// Validation messages so far; empty without validation, and in a correct program with it.
  const std::vector<std::string>& validation_messages() const;

  /// The Vulkan objects, for this library's own files (device_impl.h).
  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace becalm::gpu
