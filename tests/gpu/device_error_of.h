#pragma once

#include <string>

#include "filter/gpu/device.h"

namespace becalm::gpu {

/// The message of the DeviceError in which `action` ends; "no error" if it does not.
template <class Action>
std::string device_error_of(const Action& action) {
  try {
    action();
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace becalm::gpu
