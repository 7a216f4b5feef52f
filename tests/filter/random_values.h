#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace becalm {

/// Evenly distributed from -1 to 1.
inline std::vector<float> random_values(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  std::vector<float> values(count);
  for (float& value : values) value = uniform(random);
  return values;
}

}  // namespace becalm
