// Known motion as a candidate of the search and as the offset itself.
#include <cmath>
#include <limits>

#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::known_motion_test {
namespace {

constexpr int kWidth = 192;
constexpr int kHeight = 96;
constexpr float kFar = 60.0f;  // px; beyond the reach of the two levels that the tests search

/// The pattern, displaced by `shift` px to the right, with the motion AOV `motion`.
Frame frame_displaced(float shift, float motion) {
  Frame frame(1, kWidth, kHeight);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      std::ranges::fill(beauty.pixel(x, y).first(3), static_cast<float>(pattern(x - shift, y, 9)));
    }
  }
  Image& vectors = frame.add(Aov::motion);
  for (std::size_t i = 0; i < vectors.pixel_count(); ++i) vectors.data()[2 * i] = motion;
  return frame;
}

/// Share of the pixels, of those whose content is in both frames, with the offset (shift, 0) to within half a
/// pixel.
double share_found(const Image& offset, float shift) {
  int found = 0, all = 0;
  for (int y = 8; y < kHeight - 8; ++y) {
    for (int x = 8; x + shift < kWidth - 8; ++x) {
      found += std::hypot(offset.at(x, y, 0) - shift, offset.at(x, y, 1)) < 0.5f;
      ++all;
    }
  }
  return static_cast<double>(found) / all;
}

class KnownMotion : public DeviceTest {
 protected:
  static Settings with(std::initializer_list<const char*> assignments) {
    Settings settings = preset("final");
    settings.directions = Directions::forward;
    settings.smooth = Smooth::none;  // frames are matched as they are
    settings.pyramid.levels = 2;     // a reach of 6 px
    settings.blur_radius = {4};
    for (const char* assignment : assignments) set(settings, assignment);
    return settings;
  }
  /// The offsets at which `target` reads its history, which is `source`.
  static Image flow(const Settings& settings, const Frame& target, const Frame& source) {
    AovSet diagnostics;
    diagnostics.set(static_cast<std::size_t>(Aov::flow));
    SequenceFilter filter(device(), settings, kWidth, kHeight, target.aovs(), {.diagnostics = diagnostics});
    denoise_frame(filter, source);
    return denoise_frame(filter, target).frame.image(Aov::flow);
  }
};

TEST_F(KnownMotion, GuidesTheSearchBeyondItsReach) {
  const Frame target = frame_displaced(0.0f, kFar + 0.7f);  // nearly right: the search corrects the rest
  const Frame source = frame_displaced(kFar, 0.0f);
  EXPECT_LT(share_found(flow(with({"motion=none"}), target, source), kFar), 0.1);
  EXPECT_GT(share_found(flow(with({"motion=guide"}), target, source), kFar), 0.95);
}

TEST_F(KnownMotion, IsNotFollowedWhereItIsWrong) {
  const Frame target = frame_displaced(0.0f, -25.0f);
  const Frame source = frame_displaced(3.0f, 0.0f);
  const double unguided = share_found(flow(with({"motion=none", "pyramid=2x3"}), target, source), 3.0f);
  ASSERT_GT(unguided, 0.85);
  EXPECT_GT(share_found(flow(with({"motion=guide", "pyramid=2x3"}), target, source), 3.0f), unguided - 0.02);
}

TEST_F(KnownMotion, OverridesWhereItIsKnown) {
  Frame target = frame_displaced(0.0f, 17.25f);
  const Frame source = frame_displaced(3.0f, 0.0f);
  // Non-finite motion is masked out.
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kWidth / 2; x < kWidth; ++x) {
      target.image(Aov::motion).at(x, y, x % 2) = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const Image offset = flow(with({"motion=override"}), target, source);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth / 2; ++x) ASSERT_EQ(offset.at(x, y, 0), 17.25f) << x << "," << y;
    for (int x = kWidth / 2; x < kWidth - 12; ++x)
      ASSERT_NEAR(offset.at(x, y, 0), 3.0f, 1.0f) << x << "," << y;
  }
}

TEST_F(KnownMotion, WithoutTheAovChangesNothing) {
  Frame target = frame_displaced(0.0f, 0.0f);
  const Frame source = frame_displaced(3.0f, 0.0f);
  const Image with_it = flow(with({"motion=none"}), target, source);
  target.remove(Aov::motion);
  const Image without = flow(with({"motion=override"}), target, source);
  EXPECT_TRUE(std::ranges::equal(with_it.data(), without.data()));
}

}  // namespace
}  // namespace becalm::filter::known_motion_test
