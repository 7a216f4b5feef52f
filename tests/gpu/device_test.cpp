// Which device is opened, and the error if there is none.
#include "filter/gpu/device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>

#include "tests/gpu/device_error_of.h"

namespace becalm::gpu {
namespace {

using ::testing::HasSubstr;

std::string error_of(const DeviceOptions& options) {
  return device_error_of([&] { const Device device(options); });
}

/// Sets an environment variable for its lifetime. The loader reads the variable when an instance is created.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    setenv(name, value, 1);
  }
  ~ScopedVariable() {
    if (old_) {
      setenv(name_, old_->c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> old_;
};

TEST(Device, IsListedWithWhatTheChainNeedsToKnow) {
  const auto devices = list_devices();
  ASSERT_FALSE(devices.empty()) << "these tests need a Vulkan driver: Debian's mesa-vulkan-drivers";
  for (std::size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i].index, static_cast<int>(i));
    EXPECT_FALSE(devices[i].name.empty());
    EXPECT_FALSE(devices[i].driver.empty());
    EXPECT_GT(devices[i].memory_bytes, 0u);
    // Guaranteed by Vulkan 1.3.
    EXPECT_GE(devices[i].max_storage_buffer_bytes, std::uint64_t{1} << 27);
    EXPECT_GE(devices[i].max_texel_buffer_elements, std::uint64_t{1} << 16);
  }
}

TEST(Device, IsChosenByIndexAndByPartOfItsNameInAnyCase) {
  for (const DeviceInfo& listed : list_devices()) {
    EXPECT_EQ(Device({.select = std::to_string(listed.index)}).info().name, listed.name);
    std::string part = listed.name.substr(1, 5);
    for (char& c : part) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    EXPECT_EQ(Device({.select = part}).info().name, listed.name);
  }
}

TEST(Device, IsAHardwareOneWhereThereIsOne) {
  bool has_hardware = false;
  for (const DeviceInfo& listed : list_devices()) has_hardware |= listed.type != "software";
  EXPECT_EQ(Device().info().type != "software", has_hardware);
}

TEST(Device, ThatDoesNotExistIsAnErrorThatListsThoseThatDo) {
  const std::string there_is = "there is: 0 " + list_devices().at(0).name;
  EXPECT_THAT(error_of({.select = "no such"}), HasSubstr("no Vulkan device 'no such'; " + there_is));
  EXPECT_THAT(error_of({.select = "99"}), HasSubstr("no Vulkan device '99'; " + there_is));
  EXPECT_THAT(error_of({.select = "-1"}), HasSubstr("no Vulkan device '-1'; " + there_is));
}

TEST(Device, WithoutADriverIsAnErrorThatNamesTheVariableThatHidesThem) {
  const ScopedVariable drivers("VK_DRIVER_FILES", "/nonexistent.json");
  const ScopedVariable older_name("VK_ICD_FILENAMES", "/nonexistent.json");
  EXPECT_TRUE(list_devices().empty());
  EXPECT_THAT(error_of({}), HasSubstr("found in VK_DRIVER_FILES=/nonexistent.json"));
}

TEST(Device, WithoutTheValidationLayerIsAnErrorThatNamesThePackage) {
  const ScopedVariable layers("VK_LAYER_PATH", "/nonexistent");
  EXPECT_THAT(error_of({.select = "", .validation = true}), HasSubstr("vulkan-validationlayers"));
}

}  // namespace
}  // namespace becalm::gpu
