#include "tracer/lights/environment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "frame/error.h"
#include "tracer/lights/light_sample.h"
#include "tracer/math/picture_lookup.h"
#include "tracer/math/shading_frame.h"
#include "tracer/sampling/discrete_distribution.h"

namespace becalm::tracer {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// What a value of +Inf becomes: the largest half, since such files are halves that overflowed.
constexpr float kOverflowedHalf = 65504.0f;
/// Scaled values stop here, so that sums of a few of them are finite.
constexpr float kLargestRadiance = 1e37f;

V3f rgb(const Image& image, int x, int y) {
  const auto texel = image.pixel(x, y);
  return {texel[0], texel[1], texel[2]};
}

int wrapped(int x, int width) {
  return x < 0 ? x + width : x >= width ? x - width : x;
}

/// Of a constant environment's samples.
float even_pdf(const Receiver& at, const V3f& dir_world) {
  return at.faces() ? std::max(0.0f, at.normal.dot(dir_world)) / kPi : 0.25f / kPi;
}

std::optional<Environment::Sample> sample_evenly(const Receiver& at, const V2f& u) {
  const float phi = 2.0f * kPi * u.x;
  const float cosine = at.faces() ? std::sqrt(1.0f - u.y) : 1.0f - 2.0f * u.y;
  const float sine = at.faces() ? std::sqrt(u.y) : 2.0f * std::sqrt(std::max(0.0f, u.y * (1.0f - u.y)));
  const V3f local(sine * std::cos(phi), sine * std::sin(phi), cosine);
  const V3f dir = at.faces() ? ShadingFrame::from_normal(at.normal).to_world(local) : local;
  const float pdf = even_pdf(at, dir);
  if (!(pdf > 0.0f)) return std::nullopt;
  return Environment::Sample{dir, pdf};
}

}  // namespace

/// The scaled image and the tables that it is sampled by.
struct Environment::Map {
  Image texels;
  DiscreteDistribution rows;
  std::vector<DiscreteDistribution> columns;  ///< a row each
  /// cos(theta) of the height + 1 row borders, 1 to -1. Double: 1 - cos of the rows at the poles of a 16k
  /// image lies below the resolution of float.
  std::vector<double> row_cos;

  double solid_angle(std::size_t y) const {
    return (row_cos[y] - row_cos[y + 1]) * 2.0 * std::numbers::pi / texels.width();
  }
  float pdf(std::size_t x, std::size_t y) const {
    return static_cast<float>(rows.probability(y) * columns[y].probability(x) / solid_angle(y));
  }
  void build_tables();
};

/// A texel weighs what bilinear reading gives on average over it, (1 6 1)/8 in x and y, so that every
/// direction of positive radiance can be drawn; rows weigh by their solid angle besides.
void Environment::Map::build_tables() {
  const int width = texels.width();
  const int height = texels.height();
  row_cos.resize(static_cast<std::size_t>(height) + 1);
  for (int y = 0; y <= height; ++y) row_cos[y] = std::cos(std::numbers::pi * y / height);

  std::vector<double> row_weights(height);
  std::vector<double> down(width);  // the row filtered in y
  std::vector<double> weights(width);
  columns.reserve(height);
  for (int y = 0; y < height; ++y) {
    const int above = std::max(y - 1, 0);
    const int below = std::min(y + 1, height - 1);
    for (int x = 0; x < width; ++x) {
      down[x] = (channel_mean(rgb(texels, x, above)) + 6.0 * channel_mean(rgb(texels, x, y)) +
                 channel_mean(rgb(texels, x, below))) /
                8.0;
    }
    double sum = 0.0;
    for (int x = 0; x < width; ++x) {
      weights[x] = (down[wrapped(x - 1, width)] + 6.0 * down[x] + down[wrapped(x + 1, width)]) / 8.0;
      sum += weights[x];
    }
    columns.emplace_back(weights);
    row_weights[y] = sum * solid_angle(y);
  }
  rows = DiscreteDistribution(row_weights);
}

Environment Environment::constant(const V3f& radiance) {
  Environment environment;
  environment.constant_ = radiance;
  environment.measure();
  return environment;
}

/// Projects the radiance onto spherical harmonics. Those used vary slowly: an image is summed up in sectors
/// of its rows first.
void Environment::measure() {
  LowHarmonics::Coefficients radiance{}, squared{};
  const auto add = [&](const V3d& dir_world, double sum, double sum_of_squares) {
    const LowHarmonics::Coefficients basis = LowHarmonics::at(dir_world);
    for (std::size_t i = 0; i < basis.size(); ++i) {
      radiance[i] += sum * basis[i];
      squared[i] += sum_of_squares * basis[i];
    }
  };
  if (!map_) {
    // Only the first harmonic has a mean.
    const double value = channel_mean(constant_), sphere = 4.0 * std::numbers::pi;
    radiance[0] = value * sphere * LowHarmonics::at(V3d(0.0, 1.0, 0.0))[0];
    squared[0] = value * radiance[0];
    irradiance_ = {LowHarmonics(radiance), LowHarmonics(squared)};
    return;
  }
  const int width = map_->texels.width();
  const int sectors = std::min(width, 128);
  for (int y = 0; y < map_->texels.height(); ++y) {
    const double cosine = 0.5 * (map_->row_cos[y] + map_->row_cos[y + 1]);
    const double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
    for (int sector = 0; sector < sectors; ++sector) {
      const int begin = static_cast<int>(std::int64_t{width} * sector / sectors);
      const int end = static_cast<int>(std::int64_t{width} * (sector + 1) / sectors);
      double sum = 0.0, sum_of_squares = 0.0;
      for (int x = begin; x < end; ++x) {
        const double value = channel_mean(rgb(map_->texels, x, y));
        sum += value;
        sum_of_squares += value * value;
      }
      const double phi = (0.5 * (begin + end) / width - 0.5) * 2.0 * std::numbers::pi;
      const double solid_angle = map_->solid_angle(y);
      add(to_world({sine * std::sin(phi), cosine, -sine * std::cos(phi)}), sum * solid_angle,
          sum_of_squares * solid_angle);
    }
  }
  irradiance_ = {LowHarmonics(radiance), LowHarmonics(squared)};
}

V3d Environment::to_world(const V3d& dir_image) const {
  return {cos_rotation_ * dir_image.x + sin_rotation_ * dir_image.z, dir_image.y,
          cos_rotation_ * dir_image.z - sin_rotation_ * dir_image.x};
}

Environment Environment::image(const Image& rgb, float scale, float rotate_y_deg) {
  if (rgb.empty() || rgb.channels() == 2) {
    throw Error(ExitStatus::bad_input, "environment image: expected 1 or at least 3 channels");
  }
  Environment environment;
  const double angle = rotate_y_deg * std::numbers::pi / 180.0;
  environment.cos_rotation_ = static_cast<float>(std::cos(angle));
  environment.sin_rotation_ = static_cast<float>(std::sin(angle));
  auto map = std::make_shared<Map>();
  map->texels = Image(rgb.width(), rgb.height(), 3);
  for (int y = 0; y < rgb.height(); ++y) {
    for (int x = 0; x < rgb.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        float value = rgb.at(x, y, rgb.channels() == 1 ? 0 : c);
        if (!(value >= 0.0f) || std::isinf(value)) {
          ++environment.replaced_values_;
          value = value > 0.0f ? kOverflowedHalf : 0.0f;
        }
        map->texels.at(x, y, c) = std::min(value * scale, kLargestRadiance);
      }
    }
  }
  map->build_tables();
  environment.map_ = std::move(map);
  environment.measure();
  return environment;
}

V2f Environment::image_position(const V3f& dir_world) const {
  const V3f dir(cos_rotation_ * dir_world.x - sin_rotation_ * dir_world.z, dir_world.y,
                sin_rotation_ * dir_world.x + cos_rotation_ * dir_world.z);
  // theta by atan2: acos loses half of its digits near the poles.
  const float theta = std::atan2(std::sqrt(dir.x * dir.x + dir.z * dir.z), dir.y);
  const float phi = dir.x == 0.0f && dir.z == 0.0f ? 0.0f : std::atan2(dir.x, -dir.z);
  return {(0.5f + phi / (2.0f * kPi)) * static_cast<float>(map_->texels.width()),
          theta / kPi * static_cast<float>(map_->texels.height())};
}

V3f Environment::radiance(const V3f& dir_world) const {
  return map_ ? radiance_at(image_position(dir_world)) : constant_;
}

V3f Environment::radiance_at(const V2f& image_position) const {
  const Image& texels = map_->texels;
  const auto [r, g, b] =
      bilinear<3, PictureRows::hold>(texels.data().data(), texels.width(), texels.height(), image_position);
  return {r, g, b};
}

std::optional<Environment::Sample> Environment::sample(const Receiver& at, const V2f& u) const {
  if (!(total() > 0.0)) return std::nullopt;
  if (!map_) return sample_evenly(at, u);
  const DiscreteDistribution::Choice row = map_->rows.sample(u.y);
  const DiscreteDistribution::Choice column = map_->columns[row.index].sample(u.x);
  // Radiance is asked for next; large images do not lie in the caches.
  __builtin_prefetch(map_->texels.pixel(static_cast<int>(column.index), static_cast<int>(row.index)).data());
  // Uniform by solid angle inside the texel: linear in the cosine.
  const double cos_theta = map_->row_cos[row.index] * (1.0 - row.u) + map_->row_cos[row.index + 1] * row.u;
  const double sin_theta = std::sqrt(std::max(0.0, (1.0 - cos_theta) * (1.0 + cos_theta)));
  const float turn = (static_cast<float>(column.index) + column.u) / static_cast<float>(map_->texels.width());
  const float phi = (turn - 0.5f) * 2.0f * kPi;
  return Sample{V3f(to_world({sin_theta * std::sin(phi), cos_theta, -sin_theta * std::cos(phi)})),
                map_->pdf(column.index, row.index)};
}

Environment::Seen Environment::look(const V3f& dir_world) const {
  if (!map_) return {constant_, dir_world, total() > 0.0 ? std::nullopt : std::optional(0.0f)};
  const V2f position = image_position(dir_world);
  return {radiance_at(position), dir_world, pdf_at(position)};
}

float Environment::Seen::pdf_solid_angle(const Receiver& at) const {
  return image_pdf ? *image_pdf : even_pdf(at, dir_world);
}

float Environment::pdf_at(const V2f& position) const {
  const int x = std::clamp(static_cast<int>(position.x), 0, map_->texels.width() - 1);
  const int y = std::clamp(static_cast<int>(position.y), 0, map_->texels.height() - 1);
  return map_->pdf(static_cast<std::size_t>(x), static_cast<std::size_t>(y));
}

}  // namespace becalm::tracer
