#include "filter/align/match_features.h"

#include <cmath>
#include <map>
#include <utility>

#include "filter/input/host_images.h"
#include "filter/input/radiance_scale.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::match_features_test {
namespace {

constexpr int kWidth = 13;
constexpr int kHeight = 7;

class FeaturesAtResolution : public DeviceTest, public testing::WithParamInterface<int> {};

TEST_P(FeaturesAtResolution, AreCompressedLuminanceAndWeightedGuides) {
  const int downsample = GetParam();
  Settings settings = preset("final");
  settings.match_downsample = downsample;
  const gpu::Extent full{kWidth, kHeight};
  gpu::Extent extent = pyramid_extents(settings, kWidth, kHeight).front();
  extent.planes = 2;

  gpu::Chain chain(device(), "features test");
  const gpu::ImageId color = chain.input("color", gpu::Format::f32x4, full);
  const gpu::ImageId exposure_image = chain.input("exposure", gpu::Format::f32, {1, 1});
  const gpu::ImageId guide = chain.input("guide", gpu::Format::f32, {kWidth, kHeight, 2});
  const gpu::ImageId guide_features = chain.image("guide.features", gpu::Format::f32, extent);
  add_guide_passes(chain, settings, full, guide, {1.0f, 0.25f}, guide_features);
  const Features features =
      add_feature_passes(chain, settings, full, "target", {color, exposure_image, guide_features, 2});
  ASSERT_EQ(features.planes, 3);
  chain.output(features.image);
  chain.build();

  const auto value = [](int x, int y, unsigned plane) { return static_cast<float>(pattern(x, y, plane)); };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int i = y * kWidth + x;
      std::ranges::fill_n(chain.upload<float>(color).begin() + 4 * i, 4, 3.0f * value(x, y, 0));
      for (int plane = 0; plane < 2; ++plane) {
        chain.upload<float>(guide)[plane * kWidth * kHeight + i] = value(x, y, 1 + plane);
      }
    }
  }
  chain.upload<float>(exposure_image)[0] = 2.0f;
  chain.run();

  const auto found = chain.download<float>(features.image);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      std::array<double, 3> mean{};
      int count = 0;
      for (int v = y * downsample; v < std::min((y + 1) * downsample, kHeight); ++v) {
        for (int u = x * downsample; u < std::min((x + 1) * downsample, kWidth); ++u) {
          for (unsigned plane = 0; plane < 3; ++plane) mean[plane] += value(u, v, plane);
          ++count;
        }
      }
      const double exposed = 2.0 * 3.0 * mean[0] / count;
      // Guides come first; the features' range is 16.
      const std::array<double, 3> expected{16.0 * mean[1] / count, 16.0 * 0.25 * mean[2] / count,
                                           16.0 * exposed / (1.0 + exposed)};
      for (int plane = 0; plane < 3; ++plane) {
        EXPECT_NEAR(found[(plane * extent.height + y) * extent.width + x], expected[plane], 1e-4)
            << "plane " << plane << " pixel " << x << "," << y;
      }
    }
  }
}

TEST_P(FeaturesAtResolution, AFireflyIsTheMeanOfItsNearestInTheFrame) {
  Settings settings = preset("final");
  settings.match_downsample = GetParam();
  const gpu::Extent full{kWidth, kHeight};
  gpu::Chain chain(device(), "firefly test");
  const gpu::ImageId color = chain.input("color", gpu::Format::f32x4, full);
  const gpu::ImageId exposure_image = chain.input("exposure", gpu::Format::f32, {1, 1});
  const Features features =
      add_feature_passes(chain, settings, full, "target", {color, exposure_image, std::nullopt, 0});
  chain.output(features.image);
  chain.build();

  const auto radiance = [](int x, int y) { return 0.5 + pattern(x, y, 0); };
  // Inside, on the border, and in a corner.
  const std::map<std::pair<int, int>, double> fireflies{
      {{6, 3}, 0.25 * (radiance(5, 3) + radiance(7, 3) + radiance(6, 2) + radiance(6, 4))},
      {{9, 0}, (radiance(8, 0) + radiance(10, 0) + radiance(9, 1)) / 3},
      {{0, kHeight - 1}, 0.5 * (radiance(1, kHeight - 1) + radiance(0, kHeight - 2))}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool firefly = fireflies.contains({x, y});
      std::ranges::fill_n(chain.upload<float>(color).begin() + 4 * (y * kWidth + x), 4,
                          firefly ? 1e6f : static_cast<float>(radiance(x, y)));
    }
  }
  chain.upload<float>(exposure_image)[0] = 1.0f;
  chain.run();

  const auto found = chain.download<float>(features.image);
  const gpu::Extent extent = pyramid_extents(settings, kWidth, kHeight).front();
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      double sum = 0.0;
      int count = 0;
      for (int v = y * GetParam(); v < std::min((y + 1) * GetParam(), kHeight); ++v) {
        for (int u = x * GetParam(); u < std::min((x + 1) * GetParam(), kWidth); ++u, ++count) {
          const auto firefly = fireflies.find({u, v});
          sum += firefly == fireflies.end() ? radiance(u, v) : firefly->second;
        }
      }
      const double expected = sum / count;
      EXPECT_NEAR(found[y * extent.width + x], 16.0 * expected / (1.0 + expected), 1e-4)
          << "pixel " << x << "," << y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Downsample, FeaturesAtResolution, testing::Values(1, 2, 4));

TEST(HostImages, ExposureBringsTheTypicalLuminanceToOne) {
  Image image(4, 4, 4, 0.0f);
  EXPECT_EQ(exposure(image), 1.0f) << "a black frame";
  for (std::size_t i = 0; i < image.pixel_count(); ++i) {
    std::ranges::fill(image.data().subspan(4 * i, 3), i % 2 ? 0.1f : 10.0f);
  }
  EXPECT_NEAR(exposure(image), 1.0f, 1e-5f) << "geometric mean";
  image.at(0, 0, 1) = std::nanf("");
  image.at(1, 0, 1) = INFINITY;
  EXPECT_NEAR(exposure(image), 1.0f, 1e-5f) << "what is not finite does not count";
  Image lit(64, 32, 4);
  std::ranges::fill(lit.data(), 0.5f);
  for (const float firefly : {1e6f, 1e13f, 1e20f, 1e30f}) {
    lit.at(3, 3, 1) = firefly;
    EXPECT_NEAR(exposure(lit), 2.0f, 0.1f) << firefly;
  }
  for (float& v : image.data()) v = 1e-30f;
  EXPECT_TRUE(std::isfinite(exposure(image)));
  EXPECT_GT(exposure(image), 1e10f);
}

TEST(HostImages, TracesOfLightDoNotMoveTheExposure) {
  Image image(4, 4, 4, 0.5f);
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 2; ++y) std::ranges::fill(image.pixel(x, y).first(3), 1e-8f);
  }
  EXPECT_NEAR(exposure(image), 2.0f, 1e-5f);
}

TEST(RadianceScale, IsThatOfTheLuminancesThatCount) {
  const auto scale = [](float radiance, float other = 0.0f, int others = 0) {
    Frame frame(1, 64, 64);
    Image& beauty = frame.add(Aov::beauty);
    std::ranges::fill(beauty.data(), radiance);
    std::ranges::fill(beauty.data().first(4 * others), other);
    return radiance_scale(frame);
  };
  EXPECT_EQ(scale(1.0f), 1.0f);
  EXPECT_EQ(scale(0x1p-38f), 1.0f);
  EXPECT_EQ(scale(0x1p-42f), 0x1p80f);
  EXPECT_EQ(scale(0x1p-130f), 0x1p80f);
  EXPECT_EQ(scale(0x1p100f), 0x1p-80f);
  EXPECT_EQ(scale(0.0f), 1.0f) << "black";
  EXPECT_EQ(scale(1.0f, 1e-30f, 4000), 1.0f) << "traces of light";
  EXPECT_EQ(scale(1e-30f, 1.0f, 1), 0x1p80f) << "a firefly";
  EXPECT_EQ(scale(1.0f, 1e30f, 1000), 1.0f);
  EXPECT_EQ(scale(1e25f, 1.0f, 10), 0x1p-80f) << "what is usual beside it is a trace";
}

TEST(RadianceScale, VarianceBeyondTheRangeComesFromTheHalvesOrTheRadiance) {
  const auto scaled = [](float radiance, float variance, bool has_halves) {
    Frame frame(1, 1, 1);
    frame.add(Aov::beauty, radiance);
    frame.add(Aov::variance, variance);
    if (has_halves) {
      frame.add(Aov::half_a, radiance);
      frame.add(Aov::half_b, 3.0f * radiance);
    }
    scale_radiance(frame, radiance < 1.0f ? 0x1p80f : 0x1p-80f);
    return frame.image(Aov::variance).at(0, 0, 1);
  };
  constexpr float largest = std::numeric_limits<float>::max();
  EXPECT_EQ(scaled(0x1p-80f, 0.0f, true), 1.0f);
  EXPECT_EQ(scaled(0x1p-80f, 1e-44f, true), 1.0f) << "denormal";
  EXPECT_EQ(scaled(0x1p80f, largest, true), 1.0f);
  EXPECT_EQ(scaled(0x1p-62f, 0x1p-124f, true), 0x1p36f) << "in the range";
  EXPECT_EQ(scaled(0x1p-80f, 0.0f, false), 1.0f);
  EXPECT_EQ(scaled(0x1p80f, largest, false), 1.0f);
  EXPECT_EQ(scaled(0x1p-62f, 0x1p-124f, false), 0x1p36f) << "in the range";
  EXPECT_EQ(scaled(0.0f, 0.0f, false), 0.0f) << "black";
  EXPECT_EQ(scaled(0x1p80f, 0.0f, false), 0.0f) << "a clean sky";
  EXPECT_LT(scaled(0x1p-80f, -1.0f, true), 0.0f) << "is counted as replaced";
  EXPECT_TRUE(std::isnan(scaled(0x1p-80f, std::nanf(""), true)));
}

TEST(RadianceScale, AllThatIsRadianceScalesAndAlphaDoesNot) {
  Frame frame(1, 1, 1);
  const std::vector<Aov> radiances{Aov::beauty,   Aov::half_a, Aov::half_b,     Aov::direct,
                                   Aov::indirect, Aov::bias,   Aov::accumulated};
  const std::vector<Aov> squares{Aov::variance, Aov::remaining_variance, Aov::accumulated_variance};
  for (const Aov aov : radiances) frame.add(aov, 0x1p-60f);
  for (const Aov aov : squares) frame.add(aov, 0x1p-120f);
  frame.image(Aov::beauty).at(0, 0, 3) = 0.75f;
  frame.light_groups().push_back({"key", Image(1, 1, 3, 0x1p-60f)});
  Frame scaled = frame;
  scale_radiance(scaled, 0x1p80f);
  for (const Aov aov : radiances) EXPECT_EQ(scaled.image(aov).data()[0], 0x1p20f) << info(aov).name;
  for (const Aov aov : squares) EXPECT_EQ(scaled.image(aov).data()[0], 0x1p40f) << info(aov).name;
  EXPECT_EQ(scaled.light_groups()[0].radiance.at(0, 0, 2), 0x1p20f);
  EXPECT_EQ(scaled.image(Aov::beauty).at(0, 0, 3), 0.75f);
  scale_radiance_back(scaled, 0x1p80f, frame);
  for (const AovInfo& entry : kAovTable) {
    EXPECT_TRUE(std::ranges::equal(scaled.image(entry.aov).data(), frame.image(entry.aov).data()))
        << entry.name;
  }
  EXPECT_EQ(scaled.light_groups()[0].radiance.at(0, 0, 1), 0x1p-60f);
}

TEST(RadianceScale, FaultyPixelsComeBackAsTheyWere) {
  Frame frame(1, 2, 1);
  frame.add(Aov::beauty, 1e-30f);
  frame.image(Aov::beauty).at(0, 0, 0) = std::nanf("");
  frame.image(Aov::beauty).at(0, 0, 1) = 1e20f;  // beyond the range of floats if scaled
  frame.image(Aov::beauty).at(1, 0, 1) = 1e20f;
  Frame scaled = frame;
  scale_radiance(scaled, 0x1p80f);
  scale_radiance_back(scaled, 0x1p80f, frame);
  EXPECT_TRUE(std::isnan(scaled.image(Aov::beauty).at(0, 0, 0)));
  EXPECT_EQ(scaled.image(Aov::beauty).at(0, 0, 1), 1e20f);
  EXPECT_LT(scaled.image(Aov::beauty).at(1, 0, 1), 1e20f) << "the filter may have changed it";
  EXPECT_EQ(scaled.image(Aov::beauty).at(1, 0, 0), 1e-30f);
}

TEST(RadianceScale, AVarianceOfNothingComesBack) {
  Frame frame(1, 2, 1);
  frame.add(Aov::beauty, 0x1p60f);
  frame.add(Aov::variance, 0.0f);
  frame.image(Aov::variance).at(1, 0, 0) = 0x1p100f;
  Frame scaled = frame;
  scale_radiance(scaled, 0x1p-80f);
  scale_radiance_back(scaled, 0x1p-80f, frame);
  EXPECT_EQ(scaled.image(Aov::variance).at(0, 0, 0), 0.0f);
  EXPECT_EQ(scaled.image(Aov::variance).at(1, 0, 0), 0x1p100f);
}

TEST(HostImages, HolesAreFilledFromTheirNeighbours) {
  Image image(3, 1, 4, 2.0f);
  image.at(1, 0, 0) = std::nanf("");
  image.at(2, 0, 3) = 4.0f;
  std::vector<float> packed(12);
  const auto finite = finite_pixels(image);
  EXPECT_EQ(finite, (std::vector<std::uint8_t>{1, 0, 1}));
  pack_color(image, finite, {0, 0, 3, 1}, packed);
  EXPECT_EQ(packed[4], 2.0f);
  EXPECT_EQ(packed[7], 3.0f);
}

TEST(HostImages, HolesAreFilledFromEverySide) {
  for (int hole = 0; hole < 9; ++hole) {
    Image image(3, 3, 4);
    for (int i = 0; i < 9; ++i) std::ranges::fill(image.pixel(i % 3, i / 3), static_cast<float>(1 << i));
    image.at(hole % 3, hole / 3, 2) = INFINITY;
    int sum = 0, count = 0;
    for (int i = 0; i < 9; ++i) {
      if (i == hole || std::abs(i % 3 - hole % 3) > 1 || std::abs(i / 3 - hole / 3) > 1) continue;
      sum += 1 << i;
      ++count;
    }
    std::vector<float> packed(36);
    pack_color(image, finite_pixels(image), {0, 0, 3, 3}, packed);
    EXPECT_FLOAT_EQ(packed[4 * hole], static_cast<float>(sum) / static_cast<float>(count)) << hole;
  }
}

TEST(HostImages, TheUsualDepthIsThatOfSurfaces) {
  Frame frame(1, 5, 1);
  Image& depth = frame.add(Aov::depth);
  std::ranges::copy(std::vector{4.0f, 9.0f, 1e10f, INFINITY, NAN}, depth.data().begin());
  AovSet used;
  used.set(static_cast<std::size_t>(Aov::depth));
  EXPECT_FLOAT_EQ(typical_depth(frame, used), 6.0f);
}

TEST(HostImages, HolesBetweenTheBrightestPixelsAreFinite) {
  constexpr float largest = std::numeric_limits<float>::max();
  Image image(3, 1, 4, largest);
  image.at(1, 0, 0) = std::nanf("");
  std::vector<float> packed(12);
  pack_color(image, finite_pixels(image), {0, 0, 3, 1}, packed);
  EXPECT_EQ(packed, std::vector<float>(12, largest));
}

TEST(HostImages, NormalsOfAnyLengthAreLimited) {
  Frame frame(1, 1, 1);
  frame.add(Aov::beauty);
  std::ranges::copy(std::vector{1e30f, -7.0f, 0.5f}, frame.add(Aov::normal).data().begin());
  const NewFrame with_normal{.frame = frame,
                             .finite = {1},
                             .exposure = 1.0f,
                             .usual_depth = 1.0f,
                             .noise_ratio = 1.0f,
                             .additive = {}};
  AovSet used;
  used.set(static_cast<std::size_t>(Aov::normal));
  std::vector<float> albedo_depth(4), normal(4);
  pack_features(with_normal, used, {0, 0, 1, 1}, albedo_depth, normal);
  EXPECT_EQ(normal, (std::vector{1.0f, -1.0f, 0.5f, 0.0f}));
}

TEST(HostImages, GuidesTellTheSixAxesApart) {
  Frame frame(1, 6, 1);
  Image& normal = frame.add(Aov::normal);
  for (int axis = 0; axis < 6; ++axis) normal.at(axis, 0, axis / 2) = axis % 2 ? -1.0f : 1.0f;
  std::vector<float> planes(12);
  pack_guide(nullptr, &normal, {0, 0, 6, 1}, planes);
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < a; ++b) {
      EXPECT_GT(std::hypot(planes[a] - planes[b], planes[6 + a] - planes[6 + b]), 0.5f) << a << " and " << b;
    }
  }
}

}  // namespace
}  // namespace becalm::filter::match_features_test
