#include "tests/gpu/support.h"

namespace becalm::gpu {

Device& validated_device() {
  static Device device({.select = "", .validation = true});
  return device;
}

}  // namespace becalm::gpu
