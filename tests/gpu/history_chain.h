#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/gpu/support.h"

namespace becalm::gpu {

/// total.next = 3 total.prev + 5 frame + 0, so that a wrong or late history shows at once.
struct HistoryChain {
  explicit HistoryChain(bool alias_memory = true)
      : chain(validated_device(), "history", test_options(alias_memory)) {
    frame = chain.input("frame", Format::u32, {kCount, 1});
    total = chain.history("total", Format::u32, {kCount, 1});
    chain.pass("kernels/mix")
        .read("a", total.previous)
        .read("b", frame)
        .write("result", total.next)
        .constants(MixParams{kCount, 1, 1, kCount, kCount, 0})
        .dispatch({kCount, 1});
    chain.output(total.next);
    chain.build();
  }
  std::uint32_t run(std::uint32_t value) {
    std::ranges::fill(chain.upload<std::uint32_t>(frame), value);
    chain.run();
    const auto result = chain.download<std::uint32_t>(total.next);
    EXPECT_TRUE(std::ranges::all_of(result, [&](std::uint32_t r) { return r == result[0]; }));
    return result[0];
  }
  static constexpr int kCount = 100;
  Chain chain;
  ImageId frame;
  History total;
};

}  // namespace becalm::gpu
