// Properties of the memory plan: requests never collide, and the plan is optimal where the optimum is known.
#include "filter/gpu/memory_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

namespace becalm::gpu {
namespace {

constexpr std::uint64_t kAlignment = 64;

std::uint64_t aligned(std::uint64_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

bool live_together(const MemoryRequest& a, const MemoryRequest& b) {
  return a.first_pass <= b.last_pass && b.first_pass <= a.last_pass;
}

/// The largest number of live bytes in any pass, a lower bound of every plan.
std::uint64_t peak_of_live_bytes(const std::vector<MemoryRequest>& requests) {
  std::uint64_t peak = 0;
  for (const MemoryRequest& at : requests) {
    std::uint64_t bytes = 0;
    for (const MemoryRequest& r : requests) {
      if (r.first_pass <= at.first_pass && at.first_pass <= r.last_pass) bytes += aligned(r.bytes);
    }
    peak = std::max(peak, bytes);
  }
  return peak;
}

std::uint64_t sum_of_bytes(const std::vector<MemoryRequest>& requests) {
  std::uint64_t sum = 0;
  for (const MemoryRequest& r : requests) sum += aligned(r.bytes);
  return sum;
}

void expect_valid(const std::vector<MemoryRequest>& requests, const MemoryPlan& plan) {
  ASSERT_EQ(plan.offsets.size(), requests.size());
  ASSERT_EQ(plan.arenas.size(), requests.size());
  for (std::size_t i = 0; i < requests.size(); ++i) {
    EXPECT_EQ(plan.offsets[i] % kAlignment, 0u);
    ASSERT_LT(static_cast<std::size_t>(plan.arenas[i]), plan.arena_bytes.size());
    EXPECT_LE(plan.offsets[i] + requests[i].bytes,
              plan.arena_bytes[static_cast<std::size_t>(plan.arenas[i])]);
    for (std::size_t j = 0; j < i; ++j) {
      if (plan.arenas[i] != plan.arenas[j] || !live_together(requests[i], requests[j])) continue;
      EXPECT_TRUE(plan.offsets[i] + requests[i].bytes <= plan.offsets[j] ||
                  plan.offsets[j] + requests[j].bytes <= plan.offsets[i])
          << "requests " << i << " and " << j << " overlap in memory and in time";
    }
  }
}

std::vector<MemoryRequest> random_requests(std::mt19937& random) {
  const int passes = 1 + static_cast<int>(random() % 40);
  std::vector<MemoryRequest> requests(1 + random() % 50);
  for (MemoryRequest& r : requests) {
    const auto a = static_cast<int>(random() % static_cast<unsigned>(passes));
    const auto b = static_cast<int>(random() % static_cast<unsigned>(passes));
    r = {1 + random() % 100'000, std::min(a, b), std::max(a, b)};
  }
  return requests;
}

TEST(MemoryPlan, NeverOverlapsLiveImagesAndStaysBetweenThePeakAndTheSum) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto requests = random_requests(random);
    const MemoryPlan plan = plan_memory(requests, kAlignment);
    expect_valid(requests, plan);
    EXPECT_EQ(plan.arena_bytes.size(), 1u);
    EXPECT_GE(plan.total_bytes, peak_of_live_bytes(requests));
    EXPECT_LE(plan.total_bytes, sum_of_bytes(requests));
  }
}

TEST(MemoryPlan, WithoutAliasingEverythingLiesApart) {
  std::mt19937 random(1);
  const auto requests = random_requests(random);
  auto all_alive = requests;
  for (MemoryRequest& r : all_alive) r = {r.bytes, 0, 0};
  const MemoryPlan plan = plan_memory(requests, kAlignment, false);
  expect_valid(all_alive, plan);
  EXPECT_EQ(plan.total_bytes, sum_of_bytes(requests));
}

TEST(MemoryPlan, SplitsIntoArenasNoLargerThanTheLimit) {
  constexpr std::uint64_t limit = 150'000;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto requests = random_requests(random);
    for (const bool alias : {true, false}) {
      const MemoryPlan plan = plan_memory(requests, kAlignment, alias, limit);
      expect_valid(requests, plan);
      EXPECT_LE(std::ranges::max(plan.arena_bytes), limit);
      EXPECT_GE(plan.total_bytes, peak_of_live_bytes(requests));
      EXPECT_LE(plan.total_bytes, sum_of_bytes(requests));
    }
  }
}

TEST(MemoryPlan, ReachesThePeakOfEasyChains) {
  // A pipeline: each pass reads what the previous one wrote, so two neighbours are alive at a time.
  std::vector<MemoryRequest> pipeline;
  pipeline.reserve(10);
  for (int i = 0; i < 10; ++i) pipeline.push_back({1024, i, i + 1});
  EXPECT_EQ(plan_memory(pipeline, kAlignment).total_bytes, 2048u);

  // A pyramid whose levels are read again from coarse to fine: all levels are alive at the coarsest.
  std::vector<MemoryRequest> pyramid;
  pyramid.reserve(4);
  for (int level = 0; level < 4; ++level)
    pyramid.push_back({std::uint64_t{65536} >> 2 * level, level, 8 - level});
  EXPECT_EQ(plan_memory(pyramid, kAlignment).total_bytes, 65536u + 16384u + 4096u + 1024u);

  // Images that live for one pass each.
  const std::vector<MemoryRequest> apart = {{100, 0, 0}, {300, 1, 1}, {200, 2, 2}};
  EXPECT_EQ(plan_memory(apart, kAlignment).total_bytes, 320u);
}

TEST(MemoryPlan, OfNothingIsEmpty) {
  const MemoryPlan plan = plan_memory({}, kAlignment);
  EXPECT_EQ(plan.total_bytes, 0u);
  EXPECT_TRUE(plan.arena_bytes.empty());
}

TEST(MemoryPlan, RefusesWhatCannotBePlanned) {
  const std::vector<MemoryRequest> large = {{1000, 0, 0}};
  EXPECT_THROW(plan_memory(large, kAlignment, true, 999), std::invalid_argument);
  const std::vector<MemoryRequest> backwards = {{1000, 1, 0}};
  EXPECT_THROW(plan_memory(backwards, kAlignment), std::invalid_argument);
  EXPECT_THROW(plan_memory(large, 0), std::invalid_argument);
}

}  // namespace
}  // namespace becalm::gpu
