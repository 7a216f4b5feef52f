// Temporal antialiasing: against the reference in doubles, and what must hold of any result.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "filter/antialias/antialias_filter.h"
#include "filter/antialias/sample_grid.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/reference/antialias.h"

namespace becalm::filter::antialias_test {
namespace {

using reference::Antialiased;
using reference::Grid;
using reference::Rgb;

constexpr int kWidth = 61;
constexpr int kHeight = 43;

AntialiasSettings settings_of(const char* preset, const std::vector<const char*>& changes = {}) {
  AntialiasSettings settings = antialias_preset(preset);
  for (const char* change : changes) set(settings, change);
  return settings;
}

/// Halton's positions in a pixel, from its centre.
Imath::V2f position(int frame, int cycle) {
  const auto inverse = [](int index, int base) {
    double value = 0.0, digit = 1.0;
    for (; index > 0; index /= base) value += (digit /= base) * (index % base);
    return static_cast<float>(value - 0.5);
  };
  return {inverse(frame % cycle + 1, 2), inverse(frame % cycle + 1, 3)};
}

/// Light of a picture without a limit of resolution, at a point in pixels.
using Scene = Rgb (*)(double x, double y);

/// Discs of three colours, with edges in all directions, on a ramp.
Rgb discs(double x, double y) {
  const double u = std::fmod(std::abs(x), 17.0) - 8.5;
  const double v = std::fmod(std::abs(y), 13.0) - 6.5;
  const bool inside = u * u + v * v < 22.0;
  return {inside ? 0.9 : 0.1 + 0.002 * x, inside ? 0.4 : 0.2, inside ? 0.05 + 0.003 * y : 0.6};
}

/// One sample a pixel at its place of the frame, which moves by `motion` a frame, with motion and depth.
Frame jittered(int number, Scene scene, Imath::V2d motion = {0.0, 0.0}, int cycle = 16, int width = kWidth,
               int height = kHeight) {
  Frame frame(number, width, height);
  frame.set_jitter(FrameJitter{.positions_px = {position(number, cycle)}});
  const Imath::V2f at = frame.jitter()->positions_px.front();
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::depth, 1.0f);
  Image& vectors = frame.add(Aov::motion);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Rgb light = scene(x + at.x + motion.x * number, y + at.y + motion.y * number);
      for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = static_cast<float>(light[c]);
      vectors.at(x, y, 0) = static_cast<float>(motion.x);
      vectors.at(x, y, 1) = static_cast<float>(motion.y);
    }
  }
  return frame;
}

/// The mean under the Blackman-Harris filter of radius 1.5, by 32x32 samples.
Image supersampled(Scene scene, Imath::V2d moved = {0.0, 0.0}) {
  constexpr int side = 32;
  std::vector<double> weights(side);
  for (int i = 0; i < side; ++i) weights[i] = blackman_harris_window(std::abs((i + 0.5) / side * 2.0 - 1.0));
  Image image(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Rgb sum{};
      double weight = 0.0;
      for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
          const Rgb light =
              scene(x + moved.x + 3.0 * (i + 0.5) / side - 1.5, y + moved.y + 3.0 * (j + 0.5) / side - 1.5);
          const double w = weights[i] * weights[j];
          for (int c = 0; c < 3; ++c) sum[c] += w * light[c];
          weight += w;
        }
      }
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(sum[c] / weight);
    }
  }
  return image;
}

/// Root of the mean squared difference of the colours, without a border.
double rmse(const Image& a, const Image& b, int border = 3) {
  double sum = 0.0;
  int count = 0;
  for (int y = border; y < a.height() - border; ++y) {
    for (int x = border; x < a.width() - border; ++x) {
      for (int c = 0; c < 3; ++c, ++count) sum += std::pow(a.at(x, y, c) - b.at(x, y, c), 2);
    }
  }
  return std::sqrt(sum / count);
}

class AntialiasTest : public DeviceTest {
 protected:
  static AntialiasFilter make(const AntialiasSettings& settings, const Frame& like) {
    return {device(), settings, like.width(), like.height(), like.aovs(), {}};
  }

  /// The last result of a forward filter.
  static Frame last(AntialiasFilter& filter, const std::vector<Frame>& frames) {
    std::optional<Frame> result;
    for (const Frame& frame : frames) result = run(filter, frame);
    return std::move(*result);
  }

  static Frame run(AntialiasFilter& filter, const Frame& frame, FrameReport report = {}) {
    return *filter.run({.frame = frame.number()}, frame, report);
  }

  /// All frames in one segment, in both directions.
  static std::vector<Frame> segment(AntialiasFilter& filter, const std::vector<Frame>& frames) {
    std::vector<Frame> results;
    FrameReport report;
    const int last = static_cast<int>(frames.size()) - 1;
    for (int i = last; i >= 0; --i) {
      filter.run({.frame = frames[i].number(), .direction = Direction::backward, .new_history = i == last},
                 frames[i], report);
    }
    for (int i = 0; i <= last; ++i) {
      results.push_back(*filter.run({.frame = frames[i].number(), .new_history = i == 0}, frames[i], report));
    }
    return results;
  }

  static std::vector<Frame> frames(int count, Scene scene, Imath::V2d motion = {0.0, 0.0}) {
    std::vector<Frame> result;
    for (int number = 0; number < count; ++number) result.push_back(jittered(number, scene, motion));
    return result;
  }
};

TEST_F(AntialiasTest, AgreesWithTheReference) {
  const std::vector<std::vector<const char*>> all{
      {"accumulate=exponential"},
      {"accumulate=gain", "reconstruct=no"},
      {"accumulate=variance"},
      {"accumulate=variance", "reconstruct=no"},
      {"accumulate=exponential", "rectify=clamp", "bounds=extremes", "reconstruct=no"},
      {"accumulate=gain", "rectify=clamp", "bounds=deviation"},
      {"accumulate=variance", "rectify=clamp", "bounds=extremes"}};
  // A light that changes makes bias; the vectors are zero, so the history is read where it lies.
  const auto scene = [](int number) {
    Frame frame = jittered(number, discs);
    for (int x = 0; x < 20; ++x) {
      for (int y = 0; y < kHeight; ++y) frame.image(Aov::beauty).at(x, y, 1) *= 1.0f + 0.3f * (number % 3);
    }
    return frame;
  };
  for (const std::vector<const char*>& changes : all) {
    SCOPED_TRACE(std::string(changes.front()) + " " + changes.back());
    AntialiasSettings settings = settings_of("forward", changes);
    settings.reproject = Reproject::vectors;
    AntialiasFilter filter = make(settings, scene(0));
    Grid<Antialiased> history(kWidth, kHeight);
    for (int number = 0; number < 6; ++number) {
      const Frame frame = scene(number);
      const Frame found = run(filter, frame);
      Grid<Rgb> samples(kWidth, kHeight);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          for (int c = 0; c < 3; ++c) samples.at(x, y)[c] = frame.image(Aov::beauty).at(x, y, c);
        }
      }
      const SampleGrid grid = sample_grid(settings.reconstruct ? frame.jitter() : std::nullopt);
      ASSERT_EQ(grid.shift, Imath::V2i(0));
      std::array<double, 10> weights{};
      std::ranges::copy(grid.weights, weights.begin());
      history = reference::accumulate(samples, reference::reconstruct(samples, weights), history, settings);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(found.image(Aov::beauty).at(x, y, c), history.at(x, y).color[c], 2e-4)
                << "frame " << number << " pixel " << x << "," << y;
          }
        }
      }
    }
  }
}

TEST_F(AntialiasTest, AStillSceneConvergesToTheSupersampledMean) {
  const std::vector<Frame> shot = frames(32, discs);
  const Image truth = supersampled(discs);
  const double one_frame = rmse(shot.back().image(Aov::beauty), truth);
  AntialiasFilter forward = make(settings_of("forward"), shot.front());
  EXPECT_LT(rmse(last(forward, shot).image(Aov::beauty), truth), one_frame / 10);
  AntialiasFilter both = make(settings_of("best"), shot.front());
  EXPECT_LT(rmse(segment(both, shot)[8].image(Aov::beauty), truth), one_frame / 10);
}

TEST_F(AntialiasTest, AMovingSceneIsSmootherThanItsFrames) {
  const Imath::V2d motion(0.3, -0.7);
  const std::vector<Frame> shot = frames(12, discs, motion);
  for (const char* preset : {"forward", "clamping", "gain", "best"}) {
    SCOPED_TRACE(preset);
    AntialiasFilter filter = make(settings_of(preset), shot.front());
    const std::vector<Frame> results =
        std::string(preset) == "best" ? segment(filter, shot) : std::vector<Frame>{last(filter, shot)};
    const int number = results.back().number();
    const Image truth = supersampled(discs, motion * static_cast<double>(number));
    EXPECT_LT(rmse(results.back().image(Aov::beauty), truth),
              0.6 * rmse(shot.back().image(Aov::beauty), truth));
  }
}

TEST_F(AntialiasTest, ConstantsStayConstant) {
  const auto grey = [](double, double) { return Rgb{0.3, 0.7, 0.011}; };
  for (const char* preset : {"best", "clamping", "gain", "paper"}) {
    SCOPED_TRACE(preset);
    AntialiasFilter filter = make(settings_of(preset), jittered(0, grey));
    for (const Frame& frame : frames(5, grey, {1.37, 0.41})) {
      const Frame result = run(filter, frame);
      const auto found = result.image(Aov::beauty).data();
      const auto given = frame.image(Aov::beauty).data();
      for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], given[i], 1e-6f * given[i]);
    }
  }
}

TEST_F(AntialiasTest, AClampedHistoryStaysInTheRangeOfTheFrame) {
  AntialiasFilter filter = make(settings_of("clamping"), jittered(0, discs));
  for (int number = 0; number < 6; ++number) {
    Frame frame = jittered(number, discs, {5.0, 2.0});
    frame.add(Aov::motion);  // wrong vectors: the history is of elsewhere
    const Frame result = run(filter, frame);
    const Image& samples = frame.image(Aov::beauty);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        for (int c = 0; c < 3; ++c) {
          float low = INFINITY, high = -INFINITY;
          for (int k = 0; k < 9; ++k) {
            const float v = samples.at(std::clamp(x + k % 3 - 1, 0, kWidth - 1),
                                       std::clamp(y + k / 3 - 1, 0, kHeight - 1), c);
            low = std::min(low, v);
            high = std::max(high, v);
          }
          ASSERT_GE(result.image(Aov::beauty).at(x, y, c), low - 1e-5f);
          ASSERT_LE(result.image(Aov::beauty).at(x, y, c), high + 1e-5f);
        }
      }
    }
  }
}

/// A bright square that moves by 3 px a frame over stripes which stand still.
Frame moving_square(int number) {
  Frame frame = jittered(number, [](double x, double y) {
    const double stripe = 0.2 + 0.1 * std::sin(0.7 * x + 0.4 * y);
    return Rgb{stripe, stripe, stripe};
  });
  const Imath::V2f at = frame.jitter()->positions_px.front();
  const double left = 4.0 + 3.0 * number;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double u = x + at.x - left;
      if (u < 0.0 || u > 12.0 || y + at.y < 10.0 || y + at.y > 30.0) continue;
      for (int c = 0; c < 3; ++c) frame.image(Aov::beauty).at(x, y, c) = 2.0f;
      frame.image(Aov::motion).at(x, y, 0) = -3.0f;
      frame.image(Aov::depth).at(x, y, 0) = 0.5f;
    }
  }
  return frame;
}

TEST_F(AntialiasTest, DisocclusionLeavesNoGhost) {
  for (const std::vector<const char*>& changes :
       {std::vector<const char*>{}, {"accumulate=exponential", "rectify=clamp"}}) {
    AntialiasFilter filter = make(settings_of("forward", changes), moving_square(0));
    double ghost = 0.0;
    for (int number = 0; number < 10; ++number) {
      const Frame frame = moving_square(number);
      const Frame result = run(filter, frame);
      if (number < 4) continue;
      // Where the square has been in the last two frames: three pixels from its edge on.
      const int left = 4 + 3 * number;
      for (int y = 14; y < 26; ++y) {
        for (int x = left - 8; x < left - 3; ++x) {
          const double truth = 0.2 + 0.1 * std::sin(0.7 * x + 0.4 * y);
          ghost = std::max(ghost, std::abs(result.image(Aov::beauty).at(x, y, 0) - truth));
        }
      }
    }
    EXPECT_LT(ghost, 0.12) << "of a square that is brighter by 1.8, with " << changes.size() << " changes";
  }
}

TEST_F(AntialiasTest, ReportsHowLongHistoriesAreAndWhatWasRejected) {
  const std::vector<Frame> shot = frames(8, discs);
  AntialiasFilter filter = make(settings_of("forward"), shot.front());
  FrameReport report;
  filter.run({.frame = shot.front().number(), .new_history = true}, shot.front(), report);
  EXPECT_EQ(report.mean_rejected, 1.0);
  for (const Frame& frame : std::span(shot).subspan(1)) {
    report = {};
    filter.run({.frame = frame.number()}, frame, report);
  }
  EXPECT_GT(report.mean_sample_count, 4.0);
  EXPECT_LT(report.mean_rejected, 0.2);
}

TEST_F(AntialiasTest, AHistoryCountsAs64FramesAtMost) {
  const Frame frame = jittered(0, discs);
  AntialiasFilter filter = make(settings_of("forward"), frame);
  FrameReport report;
  for (int number = 0; number < 70; ++number) {
    report = {};
    filter.run({.frame = number}, frame, report);
    EXPECT_LE(report.mean_sample_count, 64.0);
  }
  EXPECT_GT(report.mean_sample_count, 60.0);
}

TEST_F(AntialiasTest, AFireflyOfTheFirstFrameDoesNotBlindTheOthers) {
  const std::vector<Frame> shot = frames(4, discs, {0.6, 0.2});
  std::vector<Frame> bright = shot;
  bright.front().image(Aov::beauty).at(1, 1, 1) = 1e30f;
  for (const char* preset : {"best", "clamping", "gain"}) {
    AntialiasFilter plain = make(settings_of(preset), shot.front());
    AntialiasFilter filter = make(settings_of(preset), bright.front());
    const Frame expected = last(plain, shot), found = last(filter, bright);
    int different = 0;
    for (int y = 8; y < kHeight; ++y) {
      for (int x = 8; x < kWidth; ++x) {
        const float truth = expected.image(Aov::beauty).at(x, y, 1);
        different += !(std::abs(found.image(Aov::beauty).at(x, y, 1) - truth) <= 1e-3f * truth);
      }
    }
    EXPECT_LT(different, kWidth * kHeight / 100) << preset;
  }
}

TEST_F(AntialiasTest, FaintTailsDoNotDimWhatIsBright) {
  std::vector<Frame> shot = frames(4, discs, {0.6, 0.2});
  for (Frame& frame : shot) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = kWidth / 4; x < kWidth; ++x) {
        for (int c = 0; c < 3; ++c) frame.image(Aov::beauty).at(x, y, c) = 1e-30f;
      }
    }
  }
  AntialiasFilter filter = make(settings_of("best"), shot.front());
  const Frame found = last(filter, shot);
  const float truth = shot.back().image(Aov::beauty).at(4, kHeight / 2, 1);
  EXPECT_NEAR(found.image(Aov::beauty).at(4, kHeight / 2, 1), truth, 0.5f * truth);
}

TEST_F(AntialiasTest, ScalesWithTheRadiance) {
  const std::vector<Frame> shot = frames(4, discs, {0.6, 0.2});
  for (const char* preset : {"best", "clamping", "gain"}) {
    AntialiasFilter plain = make(settings_of(preset), shot.front());
    const Frame expected = last(plain, shot);
    for (const float scale : {0x1p-90f, 0x1p90f}) {
      std::vector<Frame> scaled = shot;
      for (Frame& frame : scaled) {
        for (std::size_t i = 0; i < frame.image(Aov::beauty).data().size(); ++i) {
          if (i % 4 != 3) frame.image(Aov::beauty).data()[i] *= scale;
        }
      }
      AntialiasFilter filter = make(settings_of(preset), scaled.front());
      const Frame found = last(filter, scaled);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          for (int c = 0; c < 3; ++c) {
            const float truth = expected.image(Aov::beauty).at(x, y, c);
            ASSERT_NEAR(found.image(Aov::beauty).at(x, y, c) / scale, truth, 1e-4f * truth)
                << preset << scale;
          }
        }
      }
    }
  }
}

TEST_F(AntialiasTest, NonFinitePixelsComeOutAsTheyCameAndSpoilNothing) {
  AntialiasFilter filter = make(settings_of("forward"), jittered(0, discs));
  for (int number = 0; number < 4; ++number) {
    Frame frame = jittered(number, discs);
    if (number == 1) {
      frame.image(Aov::beauty).at(20, 20, 1) = std::numeric_limits<float>::quiet_NaN();
      frame.image(Aov::beauty).at(40, 5, 0) = std::numeric_limits<float>::infinity();
    }
    FrameReport report;
    const Frame result = *filter.run({.frame = number}, frame, report);
    EXPECT_EQ(report.non_finite_pixels, number == 1 ? 2u : 0u);
    int bad = 0;
    for (const float value : result.image(Aov::beauty).data()) bad += std::isfinite(value) ? 0 : 1;
    EXPECT_EQ(bad, number == 1 ? 2 : 0);
  }
}

TEST_F(AntialiasTest, TakesEveryKindOfFrame) {
  for (const auto& [width, height] : {std::pair{1, 1}, {16384, 16}, {3, 200}}) {
    const Frame first = jittered(0, discs, {0.5, 0.0}, 4, width, height);
    AntialiasFilter filter = make(settings_of("forward"), first);
    run(filter, first);
    const Frame result = run(filter, jittered(1, discs, {0.5, 0.0}, 4, width, height));
    for (const float value : result.image(Aov::beauty).data()) ASSERT_TRUE(std::isfinite(value));
  }
  Frame bare(0, kWidth, kHeight);
  bare.add(Aov::beauty, 0.5f);
  for (const std::vector<const char*>& changes :
       {std::vector<const char*>{}, {"rectify=clamp", "mask=yes"}}) {
    AntialiasFilter filter = make(settings_of("best", changes), bare);
    run(filter, bare);
    const Frame result = run(filter, bare);
    for (const float value : result.image(Aov::beauty).data()) ASSERT_NEAR(value, 0.5f, 1e-6f);
  }
}

}  // namespace
}  // namespace becalm::filter::antialias_test
