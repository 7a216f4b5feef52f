#include "filter/align/align.h"

#include <fmt/format.h>

#include <random>

#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"
#include "tests/filter/reference/align.h"

namespace becalm::filter {
namespace {

using reference::Grid;
using reference::Vec2;
using Planes = std::vector<Grid<double>>;

struct GpuAlignment {
  Grid<Vec2> offset;
  Grid<double> residual;
};

/// Aligns features at matching resolution on the device; the offsets are at full resolution.
GpuAlignment align_on(gpu::Device& device, const Settings& settings, gpu::Extent full, const Planes& target,
                      const Planes& source) {
  gpu::Chain chain(device, "align test");
  gpu::Extent extent = pyramid_extents(settings, full.width, full.height).front();
  extent.planes = static_cast<int>(target.size());
  const gpu::ImageId target_image = chain.input("features.target.L0", gpu::Format::f32, extent);
  const gpu::ImageId source_image = chain.input("features.source.L0", gpu::Format::f32, extent);
  const Alignment alignment =
      add_align_passes(chain, settings, full, {target_image, extent.planes}, {source_image, extent.planes});
  chain.output(alignment.offset);
  chain.output(alignment.residual);
  chain.build();
  const auto upload = [&](gpu::ImageId image, const Planes& planes) {
    auto out = chain.upload<float>(image).begin();
    for (const auto& plane : planes) out = std::ranges::copy(plane.data, out).out;
  };
  upload(target_image, target);
  upload(source_image, source);
  chain.run();

  GpuAlignment result{Grid<Vec2>(full.width, full.height), Grid<double>(extent.width, extent.height)};
  const auto offset = chain.download<float>(alignment.offset);
  for (std::size_t i = 0; i < result.offset.data.size(); ++i) {
    result.offset.data[i] = {offset[2 * i], offset[2 * i + 1]};
  }
  std::ranges::copy(chain.download<float>(alignment.residual), result.residual.data.begin());
  return result;
}

/// The pattern, scaled to the range of the filter's features.
Grid<double> feature_image(int width, int height, Vec2 shift, unsigned seed) {
  Grid<double> image = pattern_image(width, height, shift, seed);
  for (double& value : image.data) value *= 16.0;
  return image;
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + values.size() / 2);
  return values[values.size() / 2];
}

class AlignTest : public DeviceTest {};

/// The source shows the target's content displaced by `truth`. Content within `border` px of the border may
/// be outside the source.
void expect_shift_found(gpu::Device& device, Vec2 truth, double bound_px) {
  const int width = 1920, height = 1080;
  Settings settings = preset("final");
  const GpuAlignment found =
      align_on(device, settings, {width, height}, {feature_image(width, height, {}, 3)},
               {feature_image(width, height, {-truth.x, -truth.y}, 3)});
  const int border = 200;
  std::vector<double> errors;
  for (int y = border; y < height - border; ++y) {
    for (int x = border; x < width - border; ++x) {
      const Vec2 offset = found.offset.at(x, y);
      errors.push_back(std::hypot(offset.x - truth.x, offset.y - truth.y));
    }
  }
  const double error = median(errors);
  testing::Test::RecordProperty("median_error_px", fmt::format("{}", error));
  EXPECT_LT(error, bound_px) << "shift " << truth.x << ", " << truth.y;
}

TEST_F(AlignTest, FindsASubpixelShift) {
  expect_shift_found(device(), {7.25, -12.5}, 0.1);
}
TEST_F(AlignTest, FindsAFarShift) {
  expect_shift_found(device(), {150, 90}, 0.1);
}

TEST_F(AlignTest, FlatAndEqualImagesStayStill) {
  for (const Distance distance : {Distance::l2, Distance::l1, Distance::log_l1, Distance::log_l1_centered}) {
    Settings settings = preset("final");
    settings.distance = distance;
    const Grid<double> flat(70, 41, 0.25);
    const Grid<double> textured = feature_image(70, 41, {}, 5);
    for (const auto& image : {flat, textured}) {
      const GpuAlignment found = align_on(device(), settings, {70, 41}, {image}, {image});
      for (const Vec2& offset : found.offset.data) {
        ASSERT_LT(std::hypot(offset.x, offset.y), 1e-3) << "distance " << static_cast<int>(distance);
      }
      for (const double residual : found.residual.data) ASSERT_NEAR(residual, 0.0, 1e-5);
    }
  }
}

struct Case {
  const char* name;
  std::vector<std::string> settings;
  int width;
  int height;
  int planes;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class AlignAgainstReference : public AlignTest, public testing::WithParamInterface<Case> {};

TEST_P(AlignAgainstReference, OffsetsAndResidualsAgree) {
  const Case& c = GetParam();
  Settings settings = preset("final");
  for (const std::string& assignment : c.settings) set(settings, assignment);
  const gpu::Extent full{c.width, c.height};
  const auto extents = pyramid_extents(settings, c.width, c.height);
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.0, 0.3);
  Planes target, source;
  for (int plane = 0; plane < c.planes; ++plane) {
    target.push_back(feature_image(extents[0].width, extents[0].height, {}, 20 + plane));
    source.push_back(
        feature_image(extents[0].width, extents[0].height, {3.3 - 0.1 * plane, -1.6}, 20 + plane));
    // Both hold exactly the floats that the device gets.
    for (double& value : target.back().data) value = static_cast<float>(value + noise(random));
    for (double& value : source.back().data) value = static_cast<float>(value + noise(random));
  }
  const GpuAlignment found = align_on(device(), settings, full, target, source);
  const reference::Alignment truth = reference::align(target, source, settings, extents.size());

  const int scale = settings.match_downsample;
  std::size_t certain = 0, agreeing = 0;
  double worst_residual = 0.0;
  Grid<double> truth_x(extents[0].width, extents[0].height), truth_y = truth_x, doubt = truth_x;
  for (std::size_t i = 0; i < truth_x.data.size(); ++i) {
    truth_x.data[i] = truth.offset.data[i].x;
    truth_y.data[i] = truth.offset.data[i].y;
    doubt.data[i] = truth.ambiguous.data[i];
  }
  for (int y = 0; y < c.height; ++y) {
    for (int x = 0; x < c.width; ++x) {
      const double mx = (x + 0.5) / scale - 0.5, my = (y + 0.5) / scale - 0.5;
      if (bilinear(doubt, mx, my) > 0.0) continue;
      ++certain;
      const Vec2 offset = found.offset.at(x, y);
      const double error = std::hypot(offset.x - scale * bilinear(truth_x, mx, my),
                                      offset.y - scale * bilinear(truth_y, mx, my));
      agreeing += error <= 1.0 / 16.0;
    }
  }
  for (std::size_t i = 0; i < truth.residual.data.size(); ++i) {
    if (!truth.ambiguous.data[i]) {
      const double error = std::abs(truth.residual.data[i] - found.residual.data[i]);
      worst_residual = std::max(worst_residual, error / std::max(1.0, truth.residual.data[i]));
    }
  }
  EXPECT_GE(certain, static_cast<std::size_t>(0.8 * c.width * c.height))
      << "the case is too ambiguous to test anything";
  EXPECT_GE(static_cast<double>(agreeing), 0.995 * static_cast<double>(certain));
  EXPECT_LT(worst_residual, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(
    Modes, AlignAgainstReference,
    testing::Values(Case{"l2", {"distance=l2"}, 90, 61, 1}, Case{"l1", {"distance=l1"}, 90, 61, 1},
                    Case{"log_l1", {"distance=log_l1"}, 90, 61, 1},
                    Case{"log_l1_centered", {"distance=log_l1_centered"}, 90, 61, 1},
                    Case{"factor_4", {"pyramid=4x2"}, 101, 64, 1},
                    Case{"half_resolution", {"match_downsample=2"}, 120, 75, 1},
                    Case{"quarter_resolution", {"match_downsample=4"}, 131, 90, 1},
                    Case{"three_planes", {"pyramid=2x3"}, 64, 48, 3},
                    Case{"radii_per_level", {"blur_radius=10,4,2", "pyramid=2x3"}, 80, 60, 1},
                    Case{"small_radii", {"blur_radius=1,2"}, 80, 60, 1},
                    Case{"radius_zero", {"blur_radius=2,0", "pyramid=2x2"}, 64, 48, 1},
                    Case{"unrefined", {"refine_levels=0"}, 64, 48, 1},
                    Case{"all_refined", {"refine_levels=12"}, 90, 61, 1}, Case{"one_row", {}, 64, 1, 1}),
    [](const auto& info) { return info.param.name; });

TEST_F(AlignTest, OnePixelImages) {
  for (const int downsample : {1, 2, 4}) {
    Settings settings = preset("final");
    settings.match_downsample = downsample;
    const GpuAlignment found =
        align_on(device(), settings, {1, 1}, {Grid<double>(1, 1, 0.5)}, {Grid<double>(1, 1, 0.1)});
    EXPECT_EQ(found.offset.at(0, 0).x, 0.0);
    EXPECT_EQ(found.offset.at(0, 0).y, 0.0);
  }
}

TEST(Pyramid, ReachFollowsFromTheImage) {
  for (const char* name : {"draft", "balanced", "final"}) {
    const Settings settings = preset(name);
    const auto full_hd = pyramid_extents(settings, 1920, 1080);
    EXPECT_GE(reach_px(settings, full_hd.size()), 170) << name;
    EXPECT_GE(reach_px(settings, pyramid_extents(settings, 3840, 2160).size()), 340) << name;
    EXPECT_EQ(pyramid_extents(settings, 1, 1).size(), 1u) << name;
    EXPECT_EQ(pyramid_extents(settings, 16384, 1).size(), 1u) << name;
  }
  Settings paper = preset("final");
  paper.pyramid.factor = 4;
  paper.pyramid.levels = 4;
  EXPECT_EQ(reach_px(paper, pyramid_extents(paper, 1920, 1080).size()), 170);
}

}  // namespace
}  // namespace becalm::filter
