#pragma once

#include <gtest/gtest.h>

#include "filter/gpu/device.h"

namespace becalm {

/// Tests on a device that runs under the validation layers, with synchronization validation; any message
/// fails the test. The device is shared by all tests of the executable, since opening it takes longer than
/// most of them.
class DeviceTest : public testing::Test {
 protected:
  static gpu::Device& device() {
    static gpu::Device shared({.select = "", .validation = true});
    return shared;
  }
  void TearDown() override {
    for (const std::string& message : device().validation_messages()) ADD_FAILURE() << message;
  }
};

}  // namespace becalm
