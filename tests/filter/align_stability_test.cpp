// Offsets must not depend on fireflies, flat and periodic areas, borders, the images' scale or shared memory.
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "filter/align/align.h"
#include "filter/align/pair_aligner.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::align_stability_test {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 80;

/// A frame with the grey beauty `value(x, y)`.
template <class Value>
Frame frame_of(int width, int height, const Value& value) {
  Frame frame(1, width, height);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::ranges::fill(beauty.pixel(x, y).first(3), static_cast<float>(value(x, y)));
    }
  }
  return frame;
}

Frame displaced(double shift_x, double shift_y, double gain = 1.0) {
  return frame_of(kWidth, kHeight,
                  [=](int x, int y) { return gain * pattern(x - shift_x, y - shift_y, 12); });
}

float distance_px(const Image& a, const Image& b, int x, int y) {
  return std::hypot(a.at(x, y, 0) - b.at(x, y, 0), a.at(x, y, 1) - b.at(x, y, 1));
}

float length_px(const Image& offset, int x, int y) {
  return std::hypot(offset.at(x, y, 0), offset.at(x, y, 1));
}

class AlignStability : public DeviceTest {
 protected:
  static PairAlignment align(const Settings& settings, const Frame& target, const Frame& source) {
    PairAligner aligner(device(), settings, target.width(), target.height(), target.aovs());
    FrameReport report;
    return aligner.align(target, source, report);
  }
};

TEST_F(AlignStability, AFireflyMovesNoNeighbour) {
  for (const char* name : {"draft", "balanced", "final"}) {
    const Settings settings = preset(name);
    const Frame source = displaced(2.0, -1.0);
    const Image calm = align(settings, displaced(0.0, 0.0), source).offset;
    Frame target = displaced(0.0, 0.0);
    std::ranges::fill(target.image(Aov::beauty).pixel(48, 40).first(3), 1e6f);
    const Image disturbed = align(settings, target, source).offset;
    float near = 0.0f, far = 0.0f;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (x == 48 && y == 40) continue;
        float& worst = std::max(std::abs(x - 48), std::abs(y - 40)) <= 20 ? near : far;
        worst = std::max(worst, distance_px(calm, disturbed, x, y));
      }
    }
    EXPECT_LT(near, 0.1f) << name;
    EXPECT_LT(far, 0.25f) << name << ": the frame's exposure changes by a fifth of a percent";
  }
}

TEST_F(AlignStability, FlatAreasUnderNoiseStayStill) {
  std::mt19937 random(4);
  std::normal_distribution<float> noise(1.0f, 0.02f);
  const auto noisy = [&] { return frame_of(kWidth, kHeight, [&](int, int) { return noise(random); }); };
  const Image offset = align(preset("final"), noisy(), noisy()).offset;
  double sum = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) sum += length_px(offset, x, y);
  }
  EXPECT_LT(sum / (kWidth * kHeight), 0.5);
}

TEST_F(AlignStability, APeriodicPatternThatStandsStillStaysStill) {
  const Frame stripes =
      frame_of(kWidth, kHeight, [](int x, int y) { return 1.0 + (x / 2 % 2) + 0.5 * (y / 3 % 2); });
  for (const char* distance : {"distance=l2", "distance=l1", "distance=log_l1", "distance=log_l1_centered"}) {
    Settings settings = preset("final");
    set(settings, distance);
    const Image offset = align(settings, stripes, stripes).offset;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) ASSERT_LT(length_px(offset, x, y), 1e-3f) << distance;
    }
  }
}

TEST_F(AlignStability, MotionThatOnlyTheFinestLevelSeesIsFound) {
  // A grainy square, smaller than the coarser levels' patches, moves over a static background.
  const auto scene = [](int shift) {
    return frame_of(kWidth, kHeight, [=](int x, int y) {
      const bool in_square = x - shift >= 40 && x - shift < 52 && y >= 34 && y < 46;
      const unsigned grain =
          (static_cast<unsigned>(x - shift) * 0x9e3779b9u) ^ (static_cast<unsigned>(y) * 0x85ebca6bu);
      return in_square ? 0.2 + (grain >> 13) % 97 / 60.0 : 1.0 + 0.2 * pattern(x, y, 3);
    });
  };
  Settings settings = preset("final");
  const Image offset = align(settings, scene(0), scene(2)).offset;
  std::vector<float> inside, outside;
  for (int y = 38; y < 42; ++y) {
    for (int x = 44; x < 48; ++x) inside.push_back(std::hypot(offset.at(x, y, 0) - 2.0f, offset.at(x, y, 1)));
    for (int x = 8; x < 24; ++x) outside.push_back(length_px(offset, x, y));
  }
  std::ranges::nth_element(inside, inside.begin() + inside.size() / 2);
  EXPECT_LT(inside[inside.size() / 2], 0.25f);
  EXPECT_LT(*std::ranges::max_element(outside), 0.1f);
}

TEST_F(AlignStability, ContentThatReachesTheBorderIsFollowedThere) {
  const Image offset = align(preset("final"), displaced(0, 0), displaced(-3, 0)).offset;
  // The content of the right border is in both frames; that of the left border is not.
  int found = 0;
  for (int y = 0; y < kHeight; ++y) found += std::abs(offset.at(kWidth - 1, y, 0) + 3.0f) < 0.5f;
  EXPECT_GE(found, kHeight * 8 / 10);
}

TEST_F(AlignStability, APowerOfTwoOfBrightnessChangesNothing) {
  for (const char* distance : {"distance=l1", "distance=log_l1_centered"}) {
    Settings settings = preset("balanced");
    set(settings, distance);
    const PairAlignment one = align(settings, displaced(0, 0), displaced(2.5, 1));
    for (const double gain : {0x1p-20, 0x1p20}) {
      const PairAlignment other = align(settings, displaced(0, 0, gain), displaced(2.5, 1, gain));
      for (std::size_t i = 0; i < one.offset.data().size(); ++i) {
        // The exposure is computed from a mean of logarithms, which rounds.
        ASSERT_NEAR(one.offset.data()[i], other.offset.data()[i], 1e-3f) << distance << " gain " << gain;
      }
    }
  }
}

/// Offsets between two feature images, from two runs of one chain.
template <class Target, class Source>
std::array<std::vector<float>, 2> align_features(gpu::Device& device, const Settings& settings,
                                                 bool shares_memory, const Target& target_value,
                                                 const Source& source_value) {
  const gpu::Extent full{kWidth, kHeight};
  gpu::Chain chain(device, "align", {.alias_memory = shares_memory});
  const gpu::ImageId target = chain.input("t", gpu::Format::f32, full);
  const gpu::ImageId source = chain.input("s", gpu::Format::f32, full);
  const Alignment alignment = add_align_passes(chain, settings, full, {target, 1}, {source, 1});
  chain.output(alignment.offset);
  chain.build();
  std::array<std::vector<float>, 2> offsets;
  for (auto& run : offsets) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        chain.upload<float>(target)[y * kWidth + x] = static_cast<float>(16 * target_value(x, y));
        chain.upload<float>(source)[y * kWidth + x] = static_cast<float>(16 * source_value(x, y));
      }
    }
    chain.run();
    const auto offset = chain.download<float>(alignment.offset);
    run.assign(offset.begin(), offset.end());
  }
  return offsets;
}

TEST_F(AlignStability, ShiftingBothImagesShiftsNothingElse) {
  Settings settings = preset("final");
  settings.pyramid.levels = 3;
  settings.blur_radius = {1, 2};  // larger patches see the borders from everywhere
  constexpr int by = 8;  // a multiple of the coarsest level's pixel, so that the pyramids are the same
  const auto offsets = [&](int shift) {
    return align_features(
        device(), settings, true, [=](int x, int y) { return pattern(x - shift, y, 12); },
        [=](int x, int y) { return pattern(x - 3 - shift, y + 2, 12); })[0];
  };
  const auto here = offsets(0), there = offsets(by);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 32; x < kWidth - 32 - by; ++x) {
      for (int c = 0; c < 2; ++c) {
        ASSERT_NEAR(here[2 * (y * kWidth + x) + c], there[2 * (y * kWidth + x + by) + c], 1e-3f)
            << x << "," << y;
      }
    }
  }
}

TEST_F(AlignStability, RunsGiveTheSameBitsWithAndWithoutSharedMemory) {
  const auto offsets = [&](bool shares) {
    return align_features(
        device(), preset("final"), shares, [](int x, int y) { return pattern(x, y, 2); },
        [](int x, int y) { return pattern(x - 4.3, y + 1.2, 2); });
  };
  const auto first = offsets(true), second = offsets(true), apart = offsets(false);
  EXPECT_EQ(first[0], first[1]);
  EXPECT_EQ(first[0], second[0]);
  EXPECT_EQ(first[0], apart[0]);
}

TEST_F(AlignStability, ExtremeImagesGiveFiniteOffsetsWithinReach) {
  const float inf = std::numeric_limits<float>::infinity();
  const auto value = [](int x, int y) { return std::pow(10.0, -30 + 60.0 * ((x * 31 + y * 17) % 97) / 96); };
  struct Extreme {
    const char* name;
    Frame frame;
  };
  const Extreme extremes[] = {
      {"1e-30 to 1e30", frame_of(kWidth, kHeight, value)},
      {"black", frame_of(kWidth, kHeight, [](int, int) { return 0.0; })},
      {"negative", frame_of(kWidth, kHeight, [](int x, int) { return -1.0 - x; })},
      {"not finite", frame_of(kWidth, kHeight,
                              [=](int x, int y) {
                                return (x + y) % 3 == 0 ? inf : (x + y) % 3 == 1 ? std::nan("") : 1.0f;
                              })},
      {"one row", frame_of(97, 1, [](int x, int) { return pattern(x, 0, 1); })},
      {"one column", frame_of(1, 97, [](int, int y) { return pattern(0, y, 1); })},
      {"one pixel", frame_of(1, 1, [](int, int) { return 0.5; })},
  };
  for (const auto& [name, frame] : extremes) {
    for (const char* preset_name : {"draft", "balanced", "final"}) {
      const Settings settings = preset(preset_name);
      const int reach = reach_px(settings, pyramid_extents(settings, frame.width(), frame.height()).size());
      const PairAlignment found = align(settings, frame, frame);
      for (int y = 0; y < frame.height(); ++y) {
        for (int x = 0; x < frame.width(); ++x) {
          ASSERT_LE(length_px(found.offset, x, y), 1.5f * static_cast<float>(reach))
              << name << ", " << preset_name;
        }
      }
      for (const float residual : found.residual.data()) {
        ASSERT_TRUE(std::isfinite(residual) && residual >= 0.0f) << name << ", " << preset_name;
      }
    }
  }
}

}  // namespace
}  // namespace becalm::filter::align_stability_test
