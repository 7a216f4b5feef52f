#include "tracer/scene/alpha_mask.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tracer/scene/image_channel.h"

namespace becalm::tracer {

namespace {

/// The index below v - 0.5 and above it, in a picture of `size` texels that repeats; v in [0,1).
struct Neighbours {
  int low, high;
  float fraction;
};
Neighbours neighbours(float v, int size) {
  const float x = v * static_cast<float>(size) - 0.5f;
  const float below = std::floor(x);
  const int low = (static_cast<int>(below) + size) % size;
  return {low, low + 1 == size ? 0 : low + 1, x - below};
}

std::uint8_t to_byte(float v) {
  return v > 0.0f ? static_cast<std::uint8_t>(std::lround(255.0f * std::min(v, 1.0f))) : 0;
}

}  // namespace

AlphaMask AlphaMask::read(const std::string& path, TextureContent content, const V2f& repeat) {
  const std::unique_ptr<OIIO::ImageInput> file = open_image(path);
  if (!file) throw std::runtime_error(OIIO::geterror());
  const OIIO::ImageSpec& spec = file->spec();
  require_flat(spec);
  constexpr std::string_view names[] = {"a", "", "r", "g", "b", "a"};
  const std::string_view name = names[static_cast<std::size_t>(content)];
  const int channel = find_channel(spec, name);
  if (channel < 0 && content != TextureContent::color)
    throw std::runtime_error("it has no channel '" + std::string(name) + "'");

  AlphaMask mask;
  mask.width_ = spec.width;
  mask.height_ = spec.height;
  mask.repeat_ = repeat;
  const std::size_t count = static_cast<std::size_t>(spec.width) * spec.height;
  std::vector<float> pixels(count * spec.nchannels);
  if (!file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, pixels.data()))
    throw std::runtime_error(file->geterror());
  mask.texels_.reserve(count);
  for (const float* p = pixels.data(); p != pixels.data() + pixels.size(); p += spec.nchannels) {
    if (channel >= 0) {
      mask.texels_.push_back(to_byte(p[channel]));
    } else {
      mask.texels_.push_back(
          to_byte(has_colors(spec) ? 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2] : p[0]));
    }
  }
  return mask;
}

float AlphaMask::opacity(const V2f& uv) const {
  const float u = uv.x * repeat_.x, v = 1.0f - uv.y * repeat_.y;  // v runs up, rows run down
  if (!std::isfinite(u) || !std::isfinite(v)) return 0.0f;
  const Neighbours x = neighbours(u - std::floor(u), width_);
  const Neighbours y = neighbours(v - std::floor(v), height_);
  const auto texel = [&](int column, int row) {
    return static_cast<float>(texels_[static_cast<std::size_t>(row) * width_ + column]);
  };
  const float top = texel(x.low, y.low) + x.fraction * (texel(x.high, y.low) - texel(x.low, y.low));
  const float bottom = texel(x.low, y.high) + x.fraction * (texel(x.high, y.high) - texel(x.low, y.high));
  return std::min(1.0f, (top + y.fraction * (bottom - top)) / 255.0f);
}

}  // namespace becalm::tracer
