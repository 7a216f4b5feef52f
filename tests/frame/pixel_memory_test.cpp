#include "frame/pixel_memory.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <vector>

namespace becalm {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

/// Bytes of addresses that the process has mapped.
std::size_t mapped_bytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

TEST(PixelMemory, OfALargeImageServesTheNextOfItsSize) {
  void* const first = take_pixel_memory(3 * kMiB);
  give_back_pixel_memory(first, 3 * kMiB);
  void* const other = take_pixel_memory(4 * kMiB);
  EXPECT_NE(other, first);
  void* const second = take_pixel_memory(3 * kMiB);
  EXPECT_EQ(second, first);
  give_back_pixel_memory(second, 3 * kMiB);
  give_back_pixel_memory(other, 4 * kMiB);
}

// The pages are never touched, so this takes addresses, not memory.
TEST(PixelMemory, IsKeptUpToAGibibyte) {
  const std::size_t before = mapped_bytes();
  std::vector<void*> blocks;
  for (int i = 0; i < 4; ++i) blocks.push_back(take_pixel_memory(400 * kMiB));
  for (void* block : blocks) give_back_pixel_memory(block, 400 * kMiB);
  EXPECT_LT(mapped_bytes(), before + 1100 * kMiB);
}

}  // namespace
}  // namespace becalm
