// The variance that smoothing estimates of a frame without one is that of the merge.
#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "filter/input/host_images.h"
#include "filter/input/noisy_inputs.h"
#include "filter/merge/merge.h"
#include "filter/sequence/sequence_filter.h"
#include "filter/smooth/frame_smoother.h"
#include "tests/filter/device_fixture.h"

namespace becalm::filter {
namespace {

using gpu::Format;

class HandedNoiseTest : public DeviceTest {
 protected:
  static constexpr gpu::Extent kSize{40, 32};
  static constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

  HandedNoiseTest() : frame_(1, kSize.width, kSize.height) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> value(0.5f, 1.5f);
    for (const Aov aov : {Aov::beauty, Aov::albedo, Aov::normal})
      for (float& channel : frame_.add(aov).data()) channel = value(random);
    frame_.image(Aov::beauty).at(7, 9, 1) = std::numeric_limits<float>::quiet_NaN();
    task_ = {.settings = preset("balanced"),
             .full = kSize,
             .used = frame_.aovs() & wanted_aovs(preset("balanced")),
             .diagnostics = {},
             .guides = {}};
  }
  NewFrame input() const {
    const Image& beauty = frame_.image(Aov::beauty);
    return {.frame = frame_, .finite = finite_pixels(beauty), .exposure = exposure(beauty), .additive = {}};
  }
  Estimate smooth() const {
    FrameReport report;
    return FrameSmoother(device(), task_, kUnlimited).smooth(input(), report);
  }

  Frame frame_;
  FilterTask task_;
};

TEST_F(HandedNoiseTest, IsTheEstimateOfTheFrameAlone) {
  gpu::Chain chain(device(), "estimate");
  const NoisyInputs noisy(chain, task_, kSize, NoisyUse::smooth);
  chain.output(noisy.variance);
  chain.build();
  FrameReport report;
  noisy.upload(chain, task_, input(), uncut(kSize), report);
  chain.run();
  const Image expected = download(chain, noisy.variance, kSize, 2);
  const Image noise = smooth().noise;
  EXPECT_TRUE(std::ranges::equal(noise.data(), expected.data()));
  EXPECT_GT(noise.at(20, 20, 0), 0.0f);
  EXPECT_EQ(noise.at(7, 9, 1), 0.0f) << "a pixel that is not finite has no noise";
}

TEST_F(HandedNoiseTest, IsWhatTheMergeCarries) {
  gpu::Chain chain(device(), "merge");
  const NoisyInputs noisy(chain, task_, kSize, NoisyUse::merge);
  std::vector<gpu::History> history;
  for (std::size_t i = 0; i < FilterTask::kNoisyLayers; ++i)
    history.push_back(chain.history("history." + std::to_string(i), Format::f32x4, kSize));
  const auto layers = add_noisy_layers(chain, kSize, noisy, history);
  const gpu::ImageId carried = layers[FilterTask::kNoisyRadiance].color;
  chain.output(carried);
  for (const gpu::History& image : history) chain.fill(image.next, 0.0f);
  chain.build();
  NewFrame frame = input();
  frame.smoothed = smooth();
  FrameReport report;
  noisy.upload(chain, task_, frame, uncut(kSize), report);
  chain.run();
  const auto layer = chain.download<float>(carried);
  for (std::size_t i = 0; i < kSize.elements(); ++i)
    ASSERT_EQ(layer[4 * i + 3], frame.smoothed.noise.data()[2 * i]) << i;
}

TEST_F(HandedNoiseTest, IsLeftOutWhereTheFrameHasAVariance) {
  frame_.add(Aov::variance, 0.1f);
  task_.used.set(static_cast<std::size_t>(Aov::variance));
  EXPECT_TRUE(smooth().noise.empty());
}

TEST_F(HandedNoiseTest, IsLeftOutWhereSmoothedFramesAloneAreMerged) {
  set(task_.settings, "smooth=frames");
  EXPECT_TRUE(smooth().noise.empty());
}

}  // namespace
}  // namespace becalm::filter
