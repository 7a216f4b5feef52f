#include "tracer/scene/mip_texture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "tracer/math/picture_lookup.h"

namespace becalm::tracer {

namespace {

constexpr float kSteps = 65535.0f;

int stored_channels(int channels) {
  return channels == 3 ? 4 : 1;
}

/// Which texels of a row of `from` make texel `i` of the row of `to` that it is averaged into, and how much
/// of each.
struct Cover {
  int first, last;
  double first_share, last_share;
  double total;

  Cover(int i, int from, int to) {
    const double begin = static_cast<double>(i) * from / to, end = static_cast<double>(i + 1) * from / to;
    first = static_cast<int>(begin);
    last = std::min(static_cast<int>(std::ceil(end)), from) - 1;
    first_share = first == last ? end - begin : first + 1 - begin;
    last_share = end - last;
    total = end - begin;
  }
  double share(int texel) const { return texel == first ? first_share : texel == last ? last_share : 1.0; }
};

/// The level of half the size, each texel the mean over the area that it covers.
std::vector<float> halved(const std::vector<float>& texels, int width, int height, int channels) {
  const int to_width = std::max(1, width / 2), to_height = std::max(1, height / 2);
  std::vector<float> result;
  result.reserve(static_cast<std::size_t>(to_width) * to_height * channels);
  for (int y = 0; y < to_height; ++y) {
    const Cover rows(y, height, to_height);
    for (int x = 0; x < to_width; ++x) {
      const Cover columns(x, width, to_width);
      double sum[3] = {0.0, 0.0, 0.0};
      for (int row = rows.first; row <= rows.last; ++row) {
        for (int column = columns.first; column <= columns.last; ++column) {
          const double share = rows.share(row) * columns.share(column);
          const float* texel = &texels[(static_cast<std::size_t>(row) * width + column) * channels];
          for (int c = 0; c < channels; ++c) sum[c] += share * texel[c];
        }
      }
      for (int c = 0; c < channels; ++c)
        result.push_back(static_cast<float>(sum[c] / (rows.total * columns.total)));
    }
  }
  return result;
}

}  // namespace

std::size_t MipTexture::bytes(int width, int height, int channels) {
  std::size_t texels = 0;
  for (;; width = std::max(1, width / 2), height = std::max(1, height / 2)) {
    texels += static_cast<std::size_t>(width) * height;
    if (width == 1 && height == 1) break;
  }
  return texels * stored_channels(channels) * sizeof(std::uint16_t);
}

MipTexture::MipTexture(int width, int height, int channels, const std::vector<float>& texels)
    : channels_(channels) {
  assert((channels == 1 || channels == 3) &&
         texels.size() == static_cast<std::size_t>(width) * height * channels);
  const auto [least, largest] = std::ranges::minmax(texels);
  least_ = least;
  step_ = largest / kSteps - least / kSteps;
  steps_.reserve(bytes(width, height, channels) / sizeof(std::uint16_t));
  add_level(width, height, texels);
  std::vector<float> level;
  while (width > 1 || height > 1) {
    level = halved(levels_.size() == 1 ? texels : level, width, height, channels);
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
    add_level(width, height, level);
  }
}

void MipTexture::add_level(int width, int height, const std::vector<float>& texels) {
  const int stored = stored_channels(channels_);
  levels_.push_back({width, height, steps_.size() / stored});
  const float inverse = step_ > 0.0f ? 1.0f / step_ : 0.0f;
  for (std::size_t i = 0; i < texels.size(); i += channels_) {
    for (int c = 0; c < stored; ++c) {
      const float value = c < channels_ ? (texels[i + c] - least_) * inverse : 0.0f;
      steps_.push_back(static_cast<std::uint16_t>(std::clamp(value + 0.5f, 0.0f, kSteps)));
    }
  }
}

inline void MipTexture::get(std::size_t number, Texel1& texel) const {
  texel = steps_[number];
}

inline void MipTexture::get(std::size_t number, Texel4& texel) const {
  using Steps = std::uint16_t __attribute__((vector_size(8)));
  using Numbers = std::int32_t __attribute__((vector_size(16)));
  Steps steps;
  std::memcpy(&steps, &steps_[number * 4], sizeof(steps));
  texel = __builtin_convertvector(__builtin_convertvector(steps, Numbers), Texel4);
}

template <class Texel>
inline void MipTexture::at_level(std::size_t level, const V2f& st, Texel& value) const {
  const auto& [width, height, first] = levels_[level];
  const V2f position(st.x * static_cast<float>(width), st.y * static_cast<float>(height));
  value = texels_around(width, height, position).mix([&, first = first](std::size_t number) {
    Texel texel;
    get(first + number, texel);
    return texel;
  });
}

template <class Texel>
inline void MipTexture::trilinear(float lod, const V2f& st, Texel& value) const {
  const float last = static_cast<float>(levels_.size() - 1);
  const float level = std::clamp(lod, 0.0f, last);
  const auto finer = static_cast<std::size_t>(level);
  const float coarse_share = level - static_cast<float>(finer);
  at_level(finer, st, value);
  if (coarse_share == 0.0f) return;
  Texel coarse;
  at_level(finer + 1, st, coarse);
  value += coarse_share * (coarse - value);
}

template <class Texel>
void MipTexture::probes(const V2f& st, const V2f& dst_dx, const V2f& dst_dy, Texel& value) const {
  const V2f size(static_cast<float>(levels_[0].width), static_cast<float>(levels_[0].height));
  const float length_x = (dst_dx * size).length(), length_y = (dst_dy * size).length();
  const V2f& along = length_x > length_y ? dst_dx : dst_dy;
  const float longer = std::max(length_x, length_y);
  const float shorter = std::max(std::min(length_x, length_y), longer / kAnisotropy);
  if (!(longer > 1.0f)) return at_level(0, st, value);
  // Each probe averages a square of the shorter side.
  const float lod = std::log2(std::max(shorter, 1.0f));
  const int count =
      std::clamp(static_cast<int>(std::ceil(longer / std::max(shorter, 1.0f) - 0.5f)), 1, kAnisotropy);
  if (count == 1) return trilinear(lod, st, value);
  value = Texel{};
  for (int i = 0; i < count; ++i) {
    V2f at = st + along * ((static_cast<float>(i) + 0.5f) / static_cast<float>(count) - 0.5f);
    at.x -= std::floor(at.x);
    at.y -= std::floor(at.y);
    Texel probe;
    trilinear(lod, at, probe);
    value += probe;
  }
  value /= static_cast<float>(count);
}

void MipTexture::read(const V2f& st, const V2f& dst_dx, const V2f& dst_dy, float* values) const {
  if (channels_ == 3) {
    Texel4 steps;
    probes(st, dst_dx, dst_dy, steps);
    for (int c = 0; c < 3; ++c) values[c] = least_ + step_ * steps[c];
  } else {
    Texel1 steps;
    probes(st, dst_dx, dst_dy, steps);
    values[0] = least_ + step_ * steps;
  }
}

}  // namespace becalm::tracer
