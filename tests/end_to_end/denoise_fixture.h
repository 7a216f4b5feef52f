#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/end_to_end/harness.h"

namespace becalm::test {

/// The size of noise_frame.
inline constexpr int kWidth = 48;
inline constexpr int kHeight = 32;

/// Frames `in.####.exr` in a folder of their own, and the command that denoises them.
class Denoise : public testing::Test {
 protected:
  void write_frames(const std::vector<int>& numbers) const {
    for (const int number : numbers) {
      io::write_exr(frame_path(input_, number), noise_frame(number), {}, io::PixelType::float32);
    }
  }
  std::vector<std::string> command(const std::string& pattern,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"denoise", input_, "-o", folder_ / pattern};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  bool same_frame(const std::string& a, const std::string& b) const {
    return same_pixels(read_frame(folder_ / a).image(Aov::beauty),
                       read_frame(folder_ / b).image(Aov::beauty));
  }

  TempFolder folder_;
  std::string input_ = folder_ / "in.####.exr";
};

}  // namespace becalm::test
