#include "filter/align/pair_aligner.h"

#include <fmt/format.h>

#include "filter/align/align.h"
#include "frame/error.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter {
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

class PairAlignerTest : public DeviceTest {};

TEST_F(PairAlignerTest, FindsAShiftInRadianceInAlbedoAndInBoth) {
  for (const auto& patterned :
       {std::initializer_list<Aov>{Aov::beauty}, {Aov::albedo}, {Aov::beauty, Aov::albedo}}) {
    const Frame target = frame_with(patterned, 0);
    const Frame source = frame_with(patterned, 1);
    PairAligner aligner(device(), preset("final"), kWidth, kHeight, target.aovs());
    const PairAlignment found = aligner.align(target, source);
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
    const PairAlignment found = aligner.align(target, frame);
    double sum = 0;
    for (const float value : found.residual.front().data()) sum += value;
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
  const PairAlignment found = aligner.align(frame, frame);
  EXPECT_EQ(found.offset.width(), kWidth);
  EXPECT_EQ(found.offset.height(), kHeight);
  EXPECT_EQ(found.offset.channels(), 2);
  const auto extents = pyramid_extents(settings, kWidth, kHeight);
  ASSERT_EQ(found.residual.size(), extents.size());
  for (std::size_t l = 0; l < extents.size(); ++l) {
    EXPECT_EQ(found.residual[l].width(), extents[l].width);
    EXPECT_EQ(found.residual[l].height(), extents[l].height);
  }
  EXPECT_FALSE(found.passes.empty());
  EXPECT_LT(aligner.device_bytes(), aligner.device_bytes_unaliased());
}

TEST_F(PairAlignerTest, RefusesFramesThatDiffer) {
  const Frame target = frame_with({Aov::beauty}, 0);
  PairAligner aligner(device(), preset("final"), kWidth, kHeight, target.aovs());
  const auto refusal = [&](const Frame& source) -> std::string {
    try {
      aligner.align(target, source);
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
}  // namespace becalm::filter
