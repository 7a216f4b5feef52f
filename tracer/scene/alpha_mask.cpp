#include "tracer/scene/alpha_mask.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tracer/math/picture_lookup.h"
#include "tracer/scene/image_channel.h"

namespace becalm::tracer {

namespace {

std::uint8_t to_byte(float v) {
  return v > 0.0f ? static_cast<std::uint8_t>(std::lround(255.0f * std::min(v, 1.0f))) : 0;
}

}  // namespace

AlphaMask AlphaMask::read(const std::string& path, TextureContent content,
                          const PicturePlacement& placement) {
  const std::unique_ptr<pictures::Picture> file = pictures::library().open(path, pictures::Alpha::separate);
  const pictures::Header& header = file->header();
  constexpr std::string_view names[] = {"a", "", "r", "g", "b", "a"};
  const std::string_view name = names[static_cast<std::size_t>(content)];
  const int channel =
      content == TextureContent::color ? find_channel(header, name) : require_channel(header, name);

  AlphaMask mask;
  mask.width_ = header.width;
  mask.height_ = header.height;
  mask.placement_ = placement;
  const std::size_t count = static_cast<std::size_t>(header.width) * header.height;
  std::vector<float> pixels(count * header.channels);
  file->read(pixels);
  mask.texels_.reserve(count);
  for (const float* p = pixels.data(); p != pixels.data() + pixels.size(); p += header.channels) {
    if (channel >= 0) {
      mask.texels_.push_back(to_byte(p[channel]));
    } else {
      mask.texels_.push_back(
          to_byte(has_colors(header) ? 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2] : p[0]));
    }
  }
  return mask;
}

float AlphaMask::opacity(const V2f& uv) const {
  const V2f place = placement_(uv);
  if (!std::isfinite(place.x) || !std::isfinite(place.y)) return 0.0f;
  const V2f st = picture_point(place);
  const V2f position(st.x * static_cast<float>(width_), st.y * static_cast<float>(height_));
  return std::min(1.0f, bilinear<1>(texels_.data(), width_, height_, position)[0] / 255.0f);
}

}  // namespace becalm::tracer
