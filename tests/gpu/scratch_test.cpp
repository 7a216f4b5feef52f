// Chains of a device use the same memory in turn, which grows and shrinks while they live.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filter/gpu/device_impl.h"
#include "tests/gpu/history_chain.h"
#include "tests/gpu/support.h"

namespace becalm::gpu {
namespace {

/// Adds 10 twice, by way of an image that lies in scratch memory.
struct TwiceChain {
  explicit TwiceChain(Extent extent) : chain(validated_device(), "twice", test_options()) {
    input = chain.input("input", Format::f32, extent);
    const ImageId between = chain.image("between", Format::f32, extent);
    output = chain.image("output", Format::f32, extent);
    for (const auto& [from, to] : {std::pair{input, between}, {between, output}}) {
      chain.pass("kernels/scale")
          .read("fine", from)
          .write("scaled", to)
          .constants(ScaleParams{extent.width, extent.height})
          .dispatch(extent);
    }
    chain.output(output);
    chain.build();
  }
  void expect_right(float value) {
    std::ranges::fill(chain.upload<float>(input), value);
    chain.run();
    const auto result = chain.download<float>(output);
    EXPECT_TRUE(std::ranges::all_of(result, [&](float r) { return r == value + 20.0f; })) << value;
  }
  Chain chain;
  ImageId input;
  ImageId output;
};

TEST(Scratch, IsCountedOnceForAllChains) {
  const TwiceChain small({64, 4}), large({64, 400});
  DeviceBytes bytes = small.chain.device_bytes();
  bytes += large.chain.device_bytes();
  EXPECT_GE(large.chain.device_bytes().total(), 64u * 400u * sizeof(float));
  EXPECT_EQ(bytes.scratch, large.chain.device_bytes().scratch);
  const HistoryChain history;
  EXPECT_GE(history.chain.device_bytes().own, 2u * HistoryChain::kCount * sizeof(float));
  bytes += history.chain.device_bytes();
  EXPECT_EQ(bytes.total(), large.chain.device_bytes().total() + history.chain.device_bytes().own);
}

TEST(Scratch, EveryArenaIsAsLargeAsAnyChainNeedsIt) {
  DeviceBytes bytes{.own = 5, .scratch = {20, 20, 10}};
  bytes += {.own = 1, .scratch = {20, 15, 20}};
  bytes += {.own = 0, .scratch = {30}};
  EXPECT_EQ(bytes.total(), 6u + 30u + 20u + 20u);
}

std::vector<std::uint64_t> sizes_of(const Scratch::Arenas& arenas) {
  std::vector<std::uint64_t> sizes;
  for (const Scratch::Arena& arena : arenas.list) sizes.push_back(arena.bytes);
  return sizes;
}

TEST(Scratch, IsAsLargeAsThoseWhoLiveNeedIt) {
  const Device device;
  Device::Impl& impl = device.impl();
  Scratch scratch;
  const auto sizes = [&] { return sizes_of(scratch.arenas(impl.device, 0, false)); };
  const auto reserve = [&](const Scratch::Sizes& bytes) {
    return scratch.reserve(impl.device, 0, false, bytes);
  };
  const auto small = reserve({1000, 500});
  const std::uint64_t before = scratch.arenas(impl.device, 0, false).version;
  auto large = reserve({3000, 200});
  EXPECT_EQ(sizes(), (std::vector<std::uint64_t>{3000, 500}));
  EXPECT_GT(scratch.arenas(impl.device, 0, false).version, before);
  EXPECT_THROW(reserve({2000, 1ull << 60}), vk::SystemError);
  EXPECT_EQ(sizes(), (std::vector<std::uint64_t>{3000, 500})) << "what could not be had is not needed";
  large.reset();
  EXPECT_EQ(sizes(), (std::vector<std::uint64_t>{1000, 500}));
}

TEST(Scratch, GrowsUnderChainsThatHaveRun) {
  TwiceChain small({33, 5});
  HistoryChain history;
  small.expect_right(1.0f);
  int total = 0;
  for (int i = 1; i <= 3; ++i) {
    // More than any chain of this process before.
    TwiceChain large({1024, 1500 * i});
    if (i != 2) large.expect_right(2.0f);
    small.expect_right(static_cast<float>(i));
    total = 3 * total + 5 * i;
    EXPECT_EQ(history.run(i), static_cast<float>(total))
        << "what is kept between runs is not in scratch memory";
    large.expect_right(3.0f);
  }
  small.expect_right(4.0f);
  EXPECT_TRUE(validated_device().validation_messages().empty());
}

}  // namespace
}  // namespace becalm::gpu
