// Results of whole chains against the same arithmetic on the CPU, under synchronization validation.
#include "filter/gpu/chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

#include "tests/gpu/device_error_of.h"
#include "tests/gpu/history_chain.h"
#include "tests/gpu/support.h"

namespace becalm::gpu {
namespace {

class ChainTest : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_TRUE(validated_device().validation_messages().empty()); }
};

struct ScaleChain {
  ScaleChain(Device& device, Extent extent,
             const std::vector<std::pair<const char*, int>>& specializations = {})
      : chain(device, "scale", test_options()) {
    fine = chain.input("fine", Format::f32, extent);
    scaled = chain.image("scaled", Format::f32, extent);
    auto pass = chain.pass("kernels/scale");
    pass.read("fine", fine).write("scaled", scaled).constants(ScaleParams{extent.width, extent.height});
    for (const auto& [name, value] : specializations) pass.specialize(name, value);
    pass.dispatch(extent);
    chain.output(scaled);
    chain.build();
  }
  Chain chain;
  ImageId fine;
  ImageId scaled;
};

/// A ramp, for odd sizes and sizes around the workgroup's 8x8.
TEST_F(ChainTest, RunsAKernelOnEveryPixelOfAnyExtent) {
  for (const Extent extent : {Extent{1, 1}, {8, 8}, {9, 7}, {7, 9}, {1, 300}, {300, 1}, {129, 67}}) {
    ScaleChain s(validated_device(), extent);
    const auto values = s.chain.upload<float>(s.fine);
    ASSERT_EQ(values.size(), extent.elements());
    std::iota(values.begin(), values.end(), 1.0f);
    s.chain.run();
    const auto result = s.chain.download<float>(s.scaled);
    ASSERT_EQ(result.size(), extent.elements());
    for (std::size_t i = 0; i < result.size(); ++i) ASSERT_EQ(result[i], static_cast<float>(i) + 11.0f) << i;
  }
}

TEST_F(ChainTest, FillsImagesAndLeavesBindingsWithoutAnImageAlone) {
  constexpr Extent extent{130, 3};
  for (const bool has_b : {false, true}) {
    Chain chain(validated_device(), "optional", test_options());
    const ImageId a = chain.image("a", Format::f32, extent);
    const ImageId sum = chain.image("sum", Format::f32, extent);
    std::optional<ImageId> b, copy;
    chain.fill(a, 2.5f);
    if (has_b) {
      b = chain.image("b", Format::f32, extent);
      copy = chain.image("copy", Format::f32, extent);
      chain.fill(*b, 0.75f);
      chain.output(*copy);
    }
    chain.pass("kernels/add_if")
        .read("a", a)
        .read("b", b)
        .write("sum", sum)
        .write("copy", copy)
        .specialize("has_b", has_b ? 1 : 0)
        .specialize("has_copy", has_b ? 1 : 0)
        .constants(ScaleParams{extent.width, extent.height})
        .dispatch(extent);
    chain.output(sum);
    chain.build();
    for (int run = 0; run < 2; ++run) {
      chain.run();
      for (const float value : chain.download<float>(sum)) ASSERT_EQ(value, has_b ? 3.25f : 2.5f);
      if (copy) {
        for (const float value : chain.download<float>(*copy)) ASSERT_EQ(value, 3.25f);
      }
    }
    ASSERT_EQ(chain.times().front().name, "fill a");
  }
}

TEST_F(ChainTest, SuppliesTheSizesOfTheDispatchAndOfImages) {
  struct Params {
    std::int32_t term;
  };
  Chain chain(validated_device(), "sizes", test_options());
  const ImageId fine = chain.image("fine", Format::f32, {6, 5, 2});
  const ImageId found = chain.image("found", Format::f32, {3, 3});
  chain.fill(fine, 0.0f);
  chain.pass("kernels/sizes")
      .read("fine", fine)
      .read("absent", std::nullopt)
      .write("found", found)
      .constants(Params{77})
      .dispatch({2, 7});
  chain.output(found);
  chain.build();
  chain.run();
  const auto values = chain.download<float>(found);
  EXPECT_EQ(std::vector(values.begin(), values.end()), (std::vector<float>{2, 7, 6, 5, 0, 0, 3, 3, 77}));
}

TEST_F(ChainTest, SpecializesConstantsByName) {
  const auto scaled_two = [](const std::vector<std::pair<const char*, int>>& specializations) {
    ScaleChain s(validated_device(), {1, 1}, specializations);
    s.chain.upload<float>(s.fine)[0] = 2.0f;
    s.chain.run();
    return s.chain.download<float>(s.scaled)[0];
  };
  EXPECT_EQ(scaled_two({}), 12.0f);
  EXPECT_EQ(scaled_two({{"bias", -3}}), -1.0f);
  EXPECT_EQ(scaled_two({{"gain", 4}}), 18.0f);
  EXPECT_EQ(scaled_two({{"negate", 7}}), 8.0f);
  EXPECT_EQ(scaled_two({{"half_steps", 3}}), 15.0f);
  EXPECT_EQ(scaled_two({{"half_steps", 1}, {"negate", 1}, {"bias", 1}, {"gain", 2}}), -4.0f);
}

/// Two pipelines of one kernel in one chain, which must not be confused.
TEST_F(ChainTest, KeepsDifferentlySpecializedPassesApart) {
  Chain chain(validated_device(), "scales", test_options());
  const ImageId input = chain.input("input", Format::f32, {1, 1});
  ImageId last = input;
  for (const int gain : {2, 3, 2}) {
    const ImageId next = chain.image("after " + std::to_string(last.index), Format::f32, {1, 1});
    chain.pass("kernels/scale")
        .read("fine", last)
        .write("scaled", next)
        .specialize("gain", gain)
        .specialize("bias", 1)
        .constants(ScaleParams{1, 1})
        .dispatch({1, 1});
    last = next;
  }
  chain.output(last);
  chain.build();
  chain.upload<float>(input)[0] = 1.0f;
  chain.run();
  EXPECT_EQ(chain.download<float>(last)[0], 21.0f);  // 2 (3 (2 x 1 + 1) + 1) + 1
}

TEST_F(ChainTest, BindsVectorElementsAndSeveralOutputs) {
  constexpr int count = 37;
  Chain chain(validated_device(), "split", test_options());
  const ImageId color = chain.input("color", Format::f32x4, {count, 1});
  const ImageId sum = chain.image("sum", Format::f32, {count, 1});
  const ImageId first = chain.image("first", Format::f32x2, {count, 1});
  chain.pass("kernels/split")
      .read("color", color)
      .write("sum", sum)
      .write("first", first)
      .dispatch({count, 1});
  chain.output(sum);
  chain.output(first);
  chain.build();
  const auto values = chain.upload<float>(color);
  std::iota(values.begin(), values.end(), 0.0f);
  chain.run();
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(chain.download<float>(sum)[i], static_cast<float>(16 * i + 6));
    EXPECT_EQ(chain.download<float>(first)[2 * i], static_cast<float>(4 * i));
    EXPECT_EQ(chain.download<float>(first)[2 * i + 1], static_cast<float>(4 * i + 1));
  }
}

TEST_F(ChainTest, WantsItsInputsAgainBeforeEachRun) {
  ScaleChain s(validated_device(), {3, 1});
  std::ranges::fill(s.chain.upload<float>(s.fine), 1.0f);
  s.chain.run();
  EXPECT_EQ(s.chain.download<float>(s.scaled)[2], 11.0f);
  EXPECT_EQ(device_error_of([&] { s.chain.run(); }),
            "chain 'scale': input 'fine' was not uploaded for this run");
  std::ranges::fill(s.chain.upload<float>(s.fine), 5.0f);
  s.chain.run();
  EXPECT_EQ(s.chain.download<float>(s.scaled)[2], 15.0f);
}

TEST_F(ChainTest, TakesTheMemoryOfOtherChainsInputsAndOutputs) {
  ScaleChain one(validated_device(), {3, 1});
  ScaleChain two(validated_device(), {3, 1});
  const auto fill = [](ScaleChain& s) { std::ranges::fill(s.chain.upload<float>(s.fine), 1.0f); };
  fill(one);
  fill(two);
  EXPECT_EQ(device_error_of([&] { one.chain.run(); }),
            "chain 'scale': input 'fine' was not uploaded for this run");
  fill(one);
  one.chain.run();
  EXPECT_EQ(one.chain.download<float>(one.scaled)[2], 11.0f);
  fill(two);
  const std::string overwritten =
      "chain 'scale': download of 'scaled': since the chain ran, this or another one has been built, "
      "uploaded to, or run";
  EXPECT_EQ(device_error_of([&] { static_cast<void>(one.chain.download<float>(one.scaled)); }), overwritten);
  two.chain.run();
  const ScaleChain larger(validated_device(), {3000, 1});
  EXPECT_EQ(device_error_of([&] { static_cast<void>(two.chain.download<float>(two.scaled)); }), overwritten);
  fill(two);
  two.chain.run();
  EXPECT_EQ(two.chain.download<float>(two.scaled)[2], 11.0f);
  fill(two);
  EXPECT_EQ(device_error_of([&] { static_cast<void>(two.chain.download<float>(two.scaled)); }), overwritten);
}

struct AccumulateParams {
  std::int32_t count;
};

TEST_F(ChainTest, HandsAHistoryFromFrameToFrame) {
  HistoryChain history;
  int expected = 0;
  for (int frame = 1; frame <= 7; ++frame) {
    expected = 3 * expected + 5 * frame;
    EXPECT_EQ(history.run(frame), static_cast<float>(expected)) << "frame " << frame;
  }
}

TEST_F(ChainTest, ResetsAHistoryInEitherParity) {
  HistoryChain history;
  for (const int frames_before : {1, 2, 3, 4}) {
    for (int i = 0; i < frames_before; ++i) history.run(9);
    history.chain.reset_history();
    EXPECT_EQ(history.run(2), 10.0f);
    EXPECT_EQ(history.run(2), 40.0f);
  }
}

TEST_F(ChainTest, UpdatesAnImageInPlace) {
  constexpr int count = 70;
  Chain chain(validated_device(), "in place", test_options());
  const ImageId term = chain.input("term", Format::f32, {count, 1});
  const ImageId sum = chain.image("sum", Format::f32, {count, 1});
  chain.pass("kernels/mix")
      .read("a", term)
      .read("b", term)
      .write("result", sum)
      .constants(MixParams{count, 1, 1, 1, 1, 100})
      .dispatch({count, 1});
  for (int i = 0; i < 3; ++i) {
    chain.pass("kernels/accumulate")
        .read("term", term)
        .read_write("sum", sum)
        .constants(AccumulateParams{count})
        .dispatch({count, 1});
  }
  chain.output(sum);
  chain.build();
  const auto terms = chain.upload<float>(term);
  std::iota(terms.begin(), terms.end(), 0.0f);
  chain.run();
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(chain.download<float>(sum)[i], static_cast<float>(100 + 3 * i));
  }
  // Bound twice, counted once.
  EXPECT_EQ(chain.times()[0].image_bytes, 2 * count * sizeof(float));
}

TEST_F(ChainTest, TimesEveryPassAndNamesItByKernelAndImage) {
  HistoryChain history;
  ASSERT_EQ(history.chain.times().size(), 1u);
  EXPECT_EQ(history.chain.times()[0].name, "kernels/mix total.next");
  history.run(1);
  EXPECT_GE(history.chain.times()[0].milliseconds, 0.0);
  EXPECT_LT(history.chain.times()[0].milliseconds, 60'000.0);
}

/// Each reads what the one before it wrote. Returns the chain's output.
ImageId add_six_passes(Chain& chain, ImageId input, Extent extent) {
  ImageId last = input;
  for (int i = 0; i < 6; ++i) {
    const ImageId next = chain.image("L" + std::to_string(i), Format::f32, extent);
    chain.pass("kernels/scale")
        .read("fine", last)
        .write("scaled", next)
        .constants(ScaleParams{extent.width, extent.height})
        .dispatch(extent);
    last = next;
  }
  chain.output(last);
  return last;
}

TEST_F(ChainTest, SaysWhatMemoryItHolds) {
  constexpr Extent extent{1000, 64};  // whose buffers are as large as the images
  constexpr std::uint64_t bytes = extent.elements() * 4;
  for (const bool alias : {true, false}) {
    ChainOptions options = test_options(alias);
    options.transfers = Transfers::staged;
    Chain chain(validated_device(), "memory", options);
    const ImageId input = chain.input("input", Format::f32, extent);
    static_cast<void>(chain.image("never used", Format::f32, extent));
    add_six_passes(chain, input, extent);
    chain.plan();
    // One image is read while the next is written.
    EXPECT_EQ(chain.device_bytes().total(), (alias ? 2 : 7) * bytes);
    EXPECT_EQ(chain.device_bytes_unaliased(), 7 * bytes);
    EXPECT_EQ(chain.staging_bytes(), 2 * bytes);
    chain.build();
    EXPECT_EQ(chain.device_bytes().total(), (alias ? 2 : 7) * bytes) << "as planned";
    EXPECT_EQ(chain.staging_bytes(), 2 * bytes) << "as planned";
  }
}

TEST_F(ChainTest, KeepsTables) {
  constexpr Extent extent{3, 1};
  Chain chain(validated_device(), "table", test_options());
  const ImageId table = chain.table("table", Format::f32, extent);
  const ImageId last = add_six_passes(chain, table, extent);
  chain.build();
  std::ranges::fill(chain.upload<float>(table), 1.0f);
  chain.run();
  const float result = chain.download<float>(last)[2];
  ScaleChain other(validated_device(), extent);
  std::ranges::fill(other.chain.upload<float>(other.fine), 7.0f);
  other.chain.run();
  chain.run();
  EXPECT_EQ(chain.download<float>(last)[2], result);
}

TEST_F(ChainTest, UsesInputsAndOutputsInPlaceOnAProcessor) {
  if (!validated_device().info().is_processor)
    GTEST_SKIP() << "hardware has memory of its own: nothing is in place";
  constexpr Extent extent{1000, 64};  // whose buffers are as large as the images
  Chain chain(validated_device(), "in place", test_options());
  const ImageId unused = chain.input("unused", Format::f32, extent);
  const ImageId input = chain.input("input", Format::f32, extent);
  const ImageId last = add_six_passes(chain, input, extent);
  chain.build();
  EXPECT_EQ(chain.staging_bytes(), 0);
  EXPECT_EQ(chain.device_bytes().total(), 3 * extent.elements() * 4)
      << "the inputs and what is written first";
  std::ranges::fill(chain.upload<float>(unused), 7.0f);
  std::ranges::fill(chain.upload<float>(input), 1.0f);
  chain.run();
  EXPECT_EQ(chain.download<float>(last)[5], 61.0f);
}

/// What is read of a history once its next image is written must be the previous frame's.
TEST_F(ChainTest, ReplacesAHistoryThatIsNoLongerRead) {
  constexpr Extent extent{1000, 64};  // whose buffers are as large as the images
  constexpr std::uint64_t bytes = extent.elements() * 4;
  for (const bool reads_late : {false, true}) {
    SCOPED_TRACE(reads_late ? "read late" : "read early");
    Chain chain(validated_device(), "history", test_options());
    const History history = chain.history("history", Format::f32, extent);
    const auto scale = [&](ImageId from, ImageId to) {
      chain.pass("kernels/scale")
          .read("fine", from)
          .write("scaled", to)
          .constants(ScaleParams{extent.width, extent.height})
          .dispatch(extent);
    };
    const ImageId scaled = chain.image("scaled", Format::f32, extent);
    const ImageId late = chain.image("late", Format::f32, extent);
    scale(history.previous, scaled);
    scale(scaled, history.next);
    scale(reads_late ? history.previous : history.next, late);
    chain.output(late);
    chain.build();
    EXPECT_EQ(chain.device_bytes().own, (reads_late ? 2 : 1) * bytes);
    for (int run = 0; run < 4; ++run) {
      if (run == 3) chain.reset_history();
      chain.run();
      const int frames_before = run == 3 ? 0 : run;
      EXPECT_EQ(chain.download<float>(late)[7], 20.0f * frames_before + (reads_late ? 10.0f : 30.0f)) << run;
    }
  }
}

TEST_F(ChainTest, ServesSeveralChainsOfOneDeviceInTurn) {
  HistoryChain one;
  HistoryChain two(false);
  EXPECT_EQ(one.run(1), 5.0f);
  EXPECT_EQ(two.run(2), 10.0f);
  EXPECT_EQ(one.run(1), 20.0f);
  EXPECT_EQ(two.run(2), 40.0f);
}

}  // namespace
}  // namespace becalm::gpu
