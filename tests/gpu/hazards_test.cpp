// The tracker asks for barriers by memory range, not by image, and only once per hazard.
#include "filter/gpu/hazards.h"

#include <gtest/gtest.h>

#include <array>

namespace becalm::gpu {
namespace {

constexpr MemoryAccess read(std::uint64_t begin, std::uint64_t end, int arena = 0) {
  return {arena, begin, end, false};
}

constexpr MemoryAccess write(std::uint64_t begin, std::uint64_t end, int arena = 0) {
  return {arena, begin, end, true};
}

bool step(HazardTracker& tracker, MemoryAccess access) {
  return tracker.step(std::array{access});
}

TEST(Hazards, AreReadAfterWriteWriteAfterReadAndWriteAfterWrite) {
  constexpr auto first = read(0, 64);
  constexpr auto first_write = write(0, 64);
  for (const auto& [before, after, hazard] : {std::tuple{first, first, false},
                                              {first, first_write, true},
                                              {first_write, first, true},
                                              {first_write, first_write, true}}) {
    HazardTracker tracker;
    EXPECT_FALSE(step(tracker, before));
    EXPECT_EQ(step(tracker, after), hazard);
  }
}

TEST(Hazards, AreSeenInPartsOfSharedMemoryOnly) {
  HazardTracker tracker;
  EXPECT_FALSE(step(tracker, write(64, 128)));
  EXPECT_FALSE(step(tracker, read(0, 64)));       // ends where the written range begins
  EXPECT_FALSE(step(tracker, read(128, 192)));    // begins where it ends
  EXPECT_FALSE(step(tracker, read(64, 128, 1)));  // the same bytes of another arena
  EXPECT_TRUE(step(tracker, read(127, 192)));     // one byte of it
}

TEST(Hazards, BeforeABarrierAreForgottenAndThoseOfTheStepItselfKept) {
  HazardTracker tracker;
  EXPECT_FALSE(step(tracker, write(0, 64)));
  EXPECT_FALSE(step(tracker, write(64, 128)));
  EXPECT_TRUE(tracker.step(std::array{read(0, 64), write(128, 192)}));
  EXPECT_FALSE(step(tracker, read(64, 128)));  // written before the barrier that has been placed
  EXPECT_TRUE(step(tracker, read(128, 192)));  // written by the step after it
}

}  // namespace
}  // namespace becalm::gpu
