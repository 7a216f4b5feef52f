#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/gpu/support.h"

namespace becalm::gpu {

/// total.next = 3 total.prev + 5 frame + 0, so that a wrong or late history shows at once.
struct HistoryChain {
  explicit HistoryChain(bool alias_memory = true)
      : chain(validated_device(), "history", test_options(alias_memory)) {
    frame = chain.input("frame", Format::f32, {kCount, 1});
    total = chain.history("total", Format::f32, {kCount, 1});
    chain.pass("kernels/mix")
        .read("a", total.previous)
        .read("b", frame)
        .write("result", total.next)
        .constants(MixParams{kCount, 1, 1, kCount, kCount, 0})
        .dispatch({kCount, 1});
    chain.output(total.next);
    chain.build();
  }
  float run(int value) {
    std::ranges::fill(chain.upload<float>(frame), static_cast<float>(value));
    chain.run();
    const auto result = chain.download<float>(total.next);
    EXPECT_TRUE(std::ranges::all_of(result, [&](float r) { return r == result[0]; }));
    return result[0];
  }
  static constexpr int kCount = 100;
  Chain chain;
  ImageId frame;
  History total;
};

}  // namespace becalm::gpu
