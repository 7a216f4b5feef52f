#pragma once

#include <cstdint>
#include <span>

#include "filter/gpu/chain.h"

namespace becalm::gpu {

/// The kernels of tests/gpu/kernels/, as `kernels/NAME`.
std::span<const Kernel> test_kernels();

/// One device for all tests of the process, under synchronization validation.
Device& validated_device();

inline ChainOptions test_options(bool alias_memory = true) {
  ChainOptions options;
  options.alias_memory = alias_memory;
  options.kernels = test_kernels();
  return options;
}

/// Values of kernels/mix are less, so that floats hold their sums exactly.
constexpr std::int32_t kMixModulus = 65521;

struct MixParams {
  std::int32_t width, height, planes, a_count, b_count, salt;
};

struct ScaleParams {
  std::int32_t width, height;
};

}  // namespace becalm::gpu
