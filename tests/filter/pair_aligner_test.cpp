#include "filter/align/pair_aligner.h"

#include <fmt/format.h>

#include <limits>
#include <random>
#include <vector>

#include "filter/align/align.h"
#include "frame/error.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::pair_aligner_test {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 112;
constexpr int kBorder = 24;  // px; content within it may have left the other frame
constexpr double kShiftX = 5.5;
constexpr double kShiftY = -3.25;

/// The pattern, displaced by `steps` shifts, in the AOVs `patterned`; other AOVs are constant.
Frame frame_with(std::initializer_list<Aov> patterned, int steps) {
  Frame frame(steps + 1, kWidth, kHeight);
  for (const Aov aov : {Aov::beauty, Aov::albedo}) {
    Image& image = frame.add(aov, 0.5f);
    if (std::ranges::find(patterned, aov) == patterned.end()) continue;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double value = pattern(x - steps * kShiftX, y - steps * kShiftY, 4);
        std::ranges::fill(image.pixel(x, y).first(3), static_cast<float>(value));
      }
    }
  }
  return frame;
}

double median_error_px(const Image& offset) {
  std::vector<double> errors;
  for (int y = kBorder; y < kHeight - kBorder; ++y) {
    for (int x = kBorder; x < kWidth - kBorder; ++x) {
      errors.push_back(std::hypot(offset.at(x, y, 0) - kShiftX, offset.at(x, y, 1) - kShiftY));
    }
  }
  std::ranges::nth_element(errors, errors.begin() + errors.size() / 2);
  return errors[errors.size() / 2];
}

class PairAlignerTest : public DeviceTest {
 protected:
  FrameReport report;
};

TEST_F(PairAlignerTest, FindsAShiftInRadianceInAlbedoAndInBoth) {
  for (const auto& patterned :
       {std::initializer_list<Aov>{Aov::beauty}, {Aov::albedo}, {Aov::beauty, Aov::albedo}}) {
    const Frame target = frame_with(patterned, 0);
    const Frame source = frame_with(patterned, 1);
    PairAligner aligner(device(), preset("final"), kWidth, kHeight, target.aovs());
    const PairAlignment found = aligner.align(target, source, report);
    EXPECT_LT(median_error_px(found.offset), 0.3)
        << (*patterned.begin() == Aov::beauty ? "beauty" : "albedo");
  }
}

TEST_F(PairAlignerTest, ExposureIsTheTargetsForBothFrames) {
  // The source is twice as bright; with an exposure of its own it would match perfectly.
  const Frame target = frame_with({Aov::beauty}, 0);
  Frame source = frame_with({Aov::beauty}, 0);
  for (float& value : source.image(Aov::beauty).data()) value *= 2.0f;
  PairAligner aligner(device(), preset("final"), kWidth, kHeight, target.aovs());
  const auto mean_residual = [&](const Frame& frame) {
    const PairAlignment found = aligner.align(target, frame, report);
    double sum = 0;
    for (const float value : found.residual.data()) sum += value;
    return sum / (kWidth * kHeight);
  };
  EXPECT_NEAR(mean_residual(target), 0.0, 1e-5);
  EXPECT_GT(mean_residual(source), 0.01);
}

TEST_F(PairAlignerTest, GivesTheSizesThatItPromises) {
  const Frame frame = frame_with({Aov::beauty}, 0);
  Settings settings = preset("final");
  set(settings, "match_downsample=2");
  PairAligner aligner(device(), settings, kWidth, kHeight, frame.aovs());
  const PairAlignment found = aligner.align(frame, frame, report);
  EXPECT_EQ(found.offset.width(), kWidth);
  EXPECT_EQ(found.offset.height(), kHeight);
  EXPECT_EQ(found.offset.channels(), 2);
  EXPECT_EQ(found.residual.width(), kWidth / 2);
  EXPECT_EQ(found.residual.height(), kHeight / 2);
  EXPECT_FALSE(report.passes.empty());
  EXPECT_LT(aligner.memory().device.total(), aligner.memory().device_bytes_unaliased);
}

/// A frame of noise that moves by `shift_px` to the right.
Frame wide_frame(int number, int shift_px) {
  std::mt19937 random(number);
  std::normal_distribution<float> noise;
  Frame frame(number, 1400, 64);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& albedo = frame.add(Aov::albedo);
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      const auto value = static_cast<float>(pattern(x - shift_px, y, 6));
      for (int c = 0; c < 3; ++c) {
        beauty.at(x, y, c) = (random() % 60 == 0 ? 20.0f : 1.0f) * (0.2f + value + 0.1f * noise(random));
        albedo.at(x, y, c) = value;
      }
    }
  }
  beauty.at(700, 40, 1) = std::numeric_limits<float>::quiet_NaN();
  return frame;
}

TEST_F(PairAlignerTest, TilesDoNotShow) {
  const Frame target = wide_frame(1, 0);
  const Frame source = wide_frame(2, 13);
  for (const char* change : {"match_downsample=1", "match_downsample=2"}) {
    Settings settings = preset("final");
    set(settings, change);
    const auto aligner = [&](std::uint64_t limit) {
      return PairAligner(device(), settings, target.width(), target.height(), target.aovs(), limit);
    };
    PairAligner whole = aligner(std::numeric_limits<std::uint64_t>::max());
    const PairAlignment expected = whole.align(target, source, report);
    EXPECT_EQ(whole.memory().tiles, 1u);
    for (const double share : {0.8, 0.6}) {
      const auto limit =
          static_cast<std::uint64_t>(share * static_cast<double>(whole.memory().device.total()));
      PairAligner cut = aligner(limit);
      EXPECT_GT(cut.memory().tiles, 1u);
      EXPECT_LE(cut.memory().device.total(), limit);
      const PairAlignment found = cut.align(target, source, report);
      EXPECT_TRUE(std::ranges::equal(found.offset.data(), expected.offset.data())) << change << share;
      EXPECT_TRUE(std::ranges::equal(found.residual.data(), expected.residual.data())) << change << share;
    }
    EXPECT_THROW(aligner(100'000), gpu::DeviceLimitError);
  }
}

TEST_F(PairAlignerTest, RefusesFramesThatDiffer) {
  const Frame target = frame_with({Aov::beauty}, 0);
  PairAligner aligner(device(), preset("final"), kWidth, kHeight, target.aovs());
  const auto refusal = [&](const Frame& source) -> std::string {
    try {
      aligner.align(target, source, report);
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), ExitStatus::bad_input);
      return error.what();
    }
    return "none";
  };
  Frame lacking = frame_with({Aov::beauty}, 1);
  lacking.remove(Aov::albedo);
  EXPECT_EQ(refusal(lacking), "frame 2: no layer 'albedo', which the aligner's frames have");
  lacking.remove(Aov::beauty);
  EXPECT_EQ(refusal(lacking), "frame 2: no layer 'beauty', which the aligner's frames have");
  Frame smaller(3, kWidth / 2, kHeight);
  smaller.add(Aov::beauty);
  EXPECT_EQ(refusal(smaller), "frame 3: size 80x112: expected 160x112 as the aligner's frames");
}

}  // namespace
}  // namespace becalm::filter::pair_aligner_test
