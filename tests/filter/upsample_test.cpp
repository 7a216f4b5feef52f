// Antialiasing to another size and of checkerboards: against the reference in doubles, and what must hold of
// any result.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "filter/antialias/antialias_filter.h"
#include "filter/antialias/sample_grid.h"
#include "frame/error.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/reference/antialias.h"

namespace becalm::filter::upsample_test {
namespace {

using reference::Grid;
using reference::Rgb;

/// Of results; frames are smaller.
constexpr int kWidth = 60;
constexpr int kHeight = 42;

/// Uniform in the pixel: Halton's points 1 to `cycle`.
FrameJitter box_jitter(int frame, int cycle) {
  const auto inverse = [](int index, int base) {
    double value = 0.0, digit = 1.0;
    for (; index > 0; index /= base) value += (digit /= base) * (index % base);
    return static_cast<float>(value - 0.5);
  };
  const int index = frame % cycle + 1;
  return {.positions_px = {{inverse(index, 2), inverse(index, 3)}}};
}

/// Smooth and sharp structure in coordinates of the result's pixels.
Rgb picture(double x, double y) {
  const double u = std::fmod(std::abs(x), 17.0) - 8.5;
  const double v = std::fmod(std::abs(y), 13.0) - 6.5;
  const bool inside = u * u + v * v < 22.0;
  return {inside ? 0.9 : 0.1 + 0.002 * x, inside ? 0.4 : 0.2, 0.5 + 0.3 * std::sin(1.1 * x + 0.6 * y)};
}

struct Shot {
  Scale scale;
  bool checkerboard = false;
  Imath::V2d motion{0.0, 0.0};  ///< of the picture in pixels of the result, a frame
  int cycle = 64;
};

Frame frame_of(const Shot& shot, int number) {
  const double scale = shot.scale.value();
  const int width = static_cast<int>(std::lround(kWidth / scale));
  const int height = static_cast<int>(std::lround(kHeight / scale));
  Frame frame(number, width, height);
  frame.set_jitter(box_jitter(shot.checkerboard ? number / 2 : number, shot.cycle));
  if (shot.checkerboard) frame.set_checkerboard(number % 2 == 0 ? Parity::even : Parity::odd);
  const Imath::V2f at = frame.jitter()->positions_px.front();
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::depth, 1.0f);
  Image& vectors = frame.add(Aov::motion);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool holds = !shot.checkerboard || has_sample(*frame.checkerboard(), x, y);
      const Rgb light = picture(scale * (x + 0.5 + at.x) - 0.5 + shot.motion.x * number,
                                scale * (y + 0.5 + at.y) - 0.5 + shot.motion.y * number);
      for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = holds ? static_cast<float>(light[c]) : 0.0f;
      if (!holds) frame.image(Aov::depth).at(x, y, 0) = std::numeric_limits<float>::infinity();
      vectors.at(x, y, 0) = holds ? static_cast<float>(shot.motion.x / scale) : 0.0f;
      vectors.at(x, y, 1) = holds ? static_cast<float>(shot.motion.y / scale) : 0.0f;
    }
  }
  return frame;
}

/// The picture under the pixel filter, by 24x24 samples.
Image truth_of(const Shot& shot, int number) {
  constexpr int side = 24;
  Image image(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Rgb sum{};
      double weight = 0.0;
      for (int k = 0; k < side * side; ++k) {
        const double dx = 3.0 * (k % side + 0.5) / side - 1.5;
        const double dy = 3.0 * (k / side + 0.5) / side - 1.5;
        const double w =
            blackman_harris_window(std::abs(dx) / 1.5) * blackman_harris_window(std::abs(dy) / 1.5);
        const Rgb light = picture(x + dx + shot.motion.x * number, y + dy + shot.motion.y * number);
        for (int c = 0; c < 3; ++c) sum[c] += w * light[c];
        weight += w;
      }
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(sum[c] / weight);
    }
  }
  return image;
}

double rmse(const Image& a, const Image& b, int border = 4) {
  double sum = 0.0;
  int count = 0;
  for (int y = border; y < kHeight - border; ++y) {
    for (int x = border; x < kWidth - border; ++x) {
      for (int c = 0; c < 3; ++c, ++count) sum += std::pow(a.at(x, y, c) - b.at(x, y, c), 2);
    }
  }
  return std::sqrt(sum / count);
}

AntialiasSettings settings_of(const Shot& shot, const std::vector<const char*>& changes = {},
                              const char* preset = "forward") {
  AntialiasSettings settings = antialias_preset(preset);
  for (const char* change : changes) set(settings, change);
  settings.scale = shot.scale;
  settings.checkerboard = shot.checkerboard;
  return settings;
}

class UpsampleTest : public DeviceTest {
 protected:
  static AntialiasFilter make(const AntialiasSettings& settings, const Frame& like,
                              Imath::V2i origin = {0, 0}) {
    return {device(), settings, like.width(), like.height(), like.aovs(), {.origin = origin}};
  }
  static Frame run(AntialiasFilter& filter, const Frame& frame) {
    FrameReport report;
    return *filter.run({.frame = frame.number()}, frame, report);
  }
};

const std::vector<Shot> kShots{{.scale = {2, 1}},
                               {.scale = {3, 2}},
                               {.scale = {3, 1}},
                               {.scale = {1, 1}, .checkerboard = true},
                               {.scale = {3, 2}, .checkerboard = true}};

TEST_F(UpsampleTest, ReconstructionAgreesWithTheReference) {
  for (const Shot& shot : kShots) {
    for (int number = 0; number < 3; ++number) {
      SCOPED_TRACE(shot.scale.value());
      const Frame frame = frame_of(shot, number);
      AntialiasFilter filter = make(settings_of(shot), frame);
      const Frame result = run(filter, frame);  // without a history: the reconstruction
      Grid<Rgb> samples(frame.width(), frame.height());
      for (int y = 0; y < frame.height(); ++y) {
        for (int x = 0; x < frame.width(); ++x) {
          for (int c = 0; c < 3; ++c) samples.at(x, y)[c] = frame.image(Aov::beauty).at(x, y, c);
        }
      }
      const Imath::V2f at = frame.jitter()->positions_px.front();
      const auto expected = reference::reconstruct_sparse(
          samples, {at.x, at.y}, shot.scale.value(), shot.checkerboard ? 1.5 : 1.0,
          [&](int x, int y) { return !shot.checkerboard || has_sample(*frame.checkerboard(), x, y); });
      ASSERT_EQ(result.width(), kWidth);
      ASSERT_EQ(result.height(), kHeight);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          if (expected.at(x, y).count < 1e-4) continue;  // a corner under no filter
          for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(result.image(Aov::beauty).at(x, y, c), expected.at(x, y).color[c], 1e-4)
                << "frame " << number << " pixel " << x << "," << y;
          }
        }
      }
    }
  }
}

TEST_F(UpsampleTest, AStillSceneConvergesToTheFullSizeImage) {
  for (Shot shot : kShots) {
    SCOPED_TRACE(shot.scale.value());
    const Image truth = truth_of(shot, 0);
    AntialiasFilter filter = make(settings_of(shot), frame_of(shot, 0));
    const double first = rmse(run(filter, frame_of(shot, 0)).image(Aov::beauty), truth);
    // So that samples under a pixel number at least 32.
    const int frames =
        static_cast<int>(32 * shot.scale.value() * shot.scale.value()) * (shot.checkerboard ? 2 : 1);
    shot.cycle = frames;
    for (int number = 1; number < frames - 1; ++number) run(filter, frame_of(shot, number));
    const double last = rmse(run(filter, frame_of(shot, frames - 1)).image(Aov::beauty), truth);
    EXPECT_LT(last, first / 4);
  }
}

TEST_F(UpsampleTest, AMovingSceneHasMoreThanItsFrames) {
  for (Shot shot : kShots) {
    SCOPED_TRACE(shot.scale.value());
    shot.motion = {0.37, -0.61};
    AntialiasFilter filter = make(settings_of(shot), frame_of(shot, 0));
    const double first = rmse(run(filter, frame_of(shot, 0)).image(Aov::beauty), truth_of(shot, 0));
    for (int number = 1; number < 15; ++number) run(filter, frame_of(shot, number));
    const Frame result = run(filter, frame_of(shot, 15));
    EXPECT_LT(rmse(result.image(Aov::beauty), truth_of(shot, 15)), 0.8 * first);
  }
}

TEST_F(UpsampleTest, TheSearchFindsMotionInPixelsOfTheResult) {
  for (Shot shot : kShots) {
    SCOPED_TRACE(shot.scale.value());
    shot.motion = {3.0, -1.5};
    AntialiasSettings settings = settings_of(shot, {"reproject=search"});
    const Frame first = frame_of(shot, 0);
    AovSet flow;
    flow.set(static_cast<std::size_t>(Aov::flow));
    AntialiasFilter filter(device(), settings, first.width(), first.height(), first.aovs(),
                           {.diagnostics = flow});
    run(filter, first);
    const Frame result = run(filter, frame_of(shot, 1));
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<float> offsets;
      for (int y = 8; y < kHeight - 8; ++y) {
        for (int x = 8; x < kWidth - 8; ++x) offsets.push_back(result.image(Aov::flow).at(x, y, axis));
      }
      std::ranges::nth_element(offsets, offsets.begin() + offsets.size() / 2);
      EXPECT_NEAR(offsets[offsets.size() / 2], shot.motion[axis], 1.0) << "axis " << axis;
    }
  }
}

TEST_F(UpsampleTest, ConstantsStayConstantInBothDirections) {
  for (const Shot& shot : kShots) {
    SCOPED_TRACE(shot.scale.value());
    std::vector<Frame> frames;
    for (int number = 0; number < 4; ++number) {
      Frame frame = frame_of(shot, number);
      for (float& value : frame.image(Aov::beauty).data()) value = value == 0.0f ? 0.0f : 0.37f;
      frames.push_back(std::move(frame));
    }
    for (const char* preset : {"best", "clamping", "gain", "paper"}) {
      AntialiasFilter filter =
          make(settings_of(shot, {"rectify=clamp", "directions=both"}, preset), frames[0]);
      FrameReport report;
      for (int i = 3; i >= 0; --i) {
        filter.run({.frame = i, .direction = Direction::backward, .new_history = i == 3}, frames[i], report);
      }
      for (int i = 0; i < 4; ++i) {
        const Frame result = *filter.run({.frame = i, .new_history = i == 0}, frames[i], report);
        // Predictions are kept as half.
        for (const float value : result.image(Aov::beauty).data()) ASSERT_NEAR(value, 0.37f, 2e-4f) << preset;
      }
    }
  }
}

TEST_F(UpsampleTest, PublishedPresetsGoByThePlacesOfSamples) {
  const Shot shot{.scale = {2, 1}};
  const Image truth = truth_of(shot, 0);
  for (const char* preset : {"clamping", "gain"}) {
    SCOPED_TRACE(preset);
    const auto error = [&](bool places_known) {
      AntialiasFilter filter = make(settings_of(shot, {}, preset), frame_of(shot, 0));
      Frame result(0, 1, 1);
      for (int number = 0; number < 16; ++number) {
        Frame frame = frame_of(shot, number);
        if (!places_known) frame.set_jitter(std::nullopt);
        result = run(filter, frame);
      }
      return rmse(result.image(Aov::beauty), truth);
    };
    EXPECT_LT(error(true), 0.9 * error(false));
  }
}

TEST_F(UpsampleTest, SeveralSamplesWeighByTheMeanOfTheirFilters) {
  const auto columns = [](std::vector<Imath::V2f> positions) {
    return sparse_grid(FrameJitter{.positions_px = std::move(positions)}, {2, 1}, {{0, 0}, {7, 7}}, false)
        .columns;
  };
  const Imath::V2f left(-0.1f, 0.0f);
  const Imath::V2f right(0.2f, 0.0f);
  const std::vector<float> of_left = columns({left});
  const std::vector<float> of_right = columns({right});
  const std::vector<float> of_both = columns({left, right});
  for (std::size_t i = 0; i < of_both.size() / 2; ++i) {  // the pixel filter's: nearest sample, three weights
    EXPECT_NEAR(of_both[i], 0.5f * (of_left[i] + of_right[i]), 1e-6f) << i;
  }
}

TEST_F(UpsampleTest, HistoryThatMovesFastIsHeldAgainstFewerSamples) {
  const Shot shot{.scale = {2, 1}};
  // Of the four samples around pixel (22, 22), the farthest alone is as bright as the history.
  const auto after_bright_frame = [&](float speed_px) {
    Frame bright = frame_of(shot, 0);
    bright.set_jitter(FrameJitter{.positions_px = {{0.0f, 0.0f}}});
    for (float& value : bright.image(Aov::beauty).data()) value = 1.0f;
    Frame dark = bright;
    for (float& value : dark.image(Aov::beauty).data()) value = 0.1f;
    for (int c = 0; c < 3; ++c) dark.image(Aov::beauty).at(10, 10, c) = 1.0f;
    for (float& value : dark.image(Aov::motion).data()) value = speed_px / 2.0f;
    Frame second(1, dark.width(), dark.height());
    for (const Aov aov : {Aov::beauty, Aov::depth, Aov::motion}) second.image(aov) = dark.image(aov);
    second.set_jitter(dark.jitter());
    AntialiasFilter filter = make(settings_of(shot, {}, "clamping"), bright);
    for (int frame = 0; frame < 8; ++frame) run(filter, bright);  // so that one dark one has little weight
    return run(filter, second).image(Aov::beauty).at(22, 22, 0);
  };
  EXPECT_GT(after_bright_frame(0.0f), 0.8f);
  EXPECT_LT(after_bright_frame(4.0f), 0.3f);
}

TEST_F(UpsampleTest, NonFinitePixelsComeOutAsTheyCameAndSpoilNothing) {
  const Shot shot{.scale = {2, 1}};
  AntialiasFilter filter = make(settings_of(shot), frame_of(shot, 0));
  for (int number = 0; number < 4; ++number) {
    Frame frame = frame_of(shot, number);
    if (number == 1) frame.image(Aov::beauty).at(10, 9, 1) = std::numeric_limits<float>::quiet_NaN();
    FrameReport report;
    const Frame result = *filter.run({.frame = number}, frame, report);
    EXPECT_EQ(report.non_finite_pixels, number == 1 ? 1u : 0u);
    int bad = 0;
    for (const float value : result.image(Aov::beauty).data()) bad += std::isfinite(value) ? 0 : 1;
    EXPECT_EQ(bad, number == 1 ? 4 : 0) << "the pixels that the sample's pixel covers";
    EXPECT_EQ(std::isnan(result.image(Aov::beauty).at(20, 18, 1)), number == 1);
  }
}

TEST_F(UpsampleTest, HolesMayHoldAnything) {
  const Shot shot{.scale = {1, 1}, .checkerboard = true};
  const Frame zeros = frame_of(shot, 0);
  Frame nans = zeros;
  for (int y = 0; y < nans.height(); ++y) {
    for (int x = 0; x < nans.width(); ++x) {
      if (has_sample(*nans.checkerboard(), x, y)) continue;
      std::ranges::fill(nans.image(Aov::beauty).pixel(x, y), std::numeric_limits<float>::quiet_NaN());
    }
  }
  AntialiasFilter of_zeros = make(settings_of(shot), zeros);
  AntialiasFilter of_nans = make(settings_of(shot), nans);
  FrameReport report;
  const std::optional<Frame> made = of_nans.run({.frame = 0}, nans, report);
  EXPECT_EQ(report.non_finite_pixels, 0u);
  EXPECT_TRUE(
      std::ranges::equal(made->image(Aov::beauty).data(), run(of_zeros, zeros).image(Aov::beauty).data()));
}

TEST_F(UpsampleTest, TakesEveryKindOfFrame) {
  for (const bool checkerboard : {false, true}) {
    for (const auto& [width, height] : {std::pair{1, 1}, {5, 1}, {3, 200}}) {
      for (const float radiance : {1e-30f, 1e30f}) {
        AntialiasSettings settings = antialias_preset("best");
        settings.scale = {7, 4};
        settings.checkerboard = checkerboard;
        Frame frame(0, width, height);
        frame.add(Aov::beauty, radiance);
        if (checkerboard) frame.set_checkerboard(Parity::even);
        AntialiasFilter filter = make(settings, frame);
        for (int i = 0; i < 2; ++i) {
          const Frame result = run(filter, frame);
          EXPECT_EQ(result.width(), Scale({7, 4}).edge(width));
          for (const float value : result.image(Aov::beauty).data()) {
            ASSERT_NEAR(value / radiance, 1.0f, 1e-5f);
          }
        }
      }
    }
  }
}

TEST_F(UpsampleTest, PixelsAreAlignedToTheImagePlane) {
  // The same picture, cropped by an odd number of columns at a scale of 3/2.
  const Shot shot{.scale = {3, 2}};
  const Frame whole = frame_of(shot, 2);
  const Imath::V2i origin(5, 3);
  Frame cropped(2, whole.width() - origin.x, whole.height() - origin.y);
  cropped.set_jitter(whole.jitter());
  Image& beauty = cropped.add(Aov::beauty);
  for (int y = 0; y < cropped.height(); ++y) {
    for (int x = 0; x < cropped.width(); ++x) {
      std::ranges::copy(whole.image(Aov::beauty).pixel(x + origin.x, y + origin.y),
                        beauty.pixel(x, y).begin());
    }
  }
  AntialiasFilter of_whole = make(settings_of(shot), whole);
  AntialiasFilter of_cropped = make(settings_of(shot), cropped, origin);
  const Frame a = run(of_whole, whole);
  const Frame b = run(of_cropped, cropped);
  EXPECT_EQ(b.width(), kWidth - shot.scale.edge(origin.x));
  for (int y = 3; y < b.height() - 3; ++y) {
    for (int x = 3; x < b.width() - 3; ++x) {
      ASSERT_NEAR(b.image(Aov::beauty).at(x, y, 2),
                  a.image(Aov::beauty).at(x + shot.scale.edge(origin.x), y + shot.scale.edge(origin.y), 2),
                  1e-5f);
    }
  }
}

TEST_F(UpsampleTest, AFrameThatHidesItsCheckerboardIsRefused) {
  const Shot shot{.scale = {1, 1}, .checkerboard = true};
  Frame frame = frame_of(shot, 0);
  AntialiasFilter filter = make(settings_of(shot), frame);
  frame.set_checkerboard(std::nullopt);
  EXPECT_THROW(run(filter, frame), Error);
}

TEST(NearestSampleTest, FindsTheSampleNextToAPixel) {
  const NearestSample doubled{.scale = {2, 1}, .window = {{0, 0}, {3, 3}}, .position_px = {0.4f, 0.0f}};
  EXPECT_EQ(doubled.at(2, 2), Imath::V2i(0, 1))
      << "0.4 to the right of its centre, sample 0 is nearer than sample 1";
  EXPECT_EQ(doubled.at(7, 7), Imath::V2i(3, 3));
  NearestSample board{.scale = {1, 1}, .window = {{0, 0}, {3, 3}}};
  board.checkerboard = Parity::odd;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      const Imath::V2i at = board.at(x, y);
      EXPECT_TRUE(has_sample(Parity::odd, at.x, at.y));
      EXPECT_LE(std::abs(at.x - x) + std::abs(at.y - y), 1);
    }
  }
}

}  // namespace
}  // namespace becalm::filter::upsample_test
