#pragma once

#include <cstdint>

namespace becalm {

inline double mebibytes(std::uint64_t bytes) {
  return static_cast<double>(bytes) / (1024.0 * 1024.0);
}

}  // namespace becalm
