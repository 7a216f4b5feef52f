#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>

#include <Imath/half.h>

#include <algorithm>
#include <cmath>

#include "frame/io/exr_parts.h"

namespace becalm::io {
namespace {

/// To two bits after the first, at most 12 % of the deviation and on average none.
float rounded(float deviation) {
  int exponent = 0;
  const float mantissa = std::frexp(deviation, &exponent);
  return std::ldexp(std::round(mantissa * 8.0f), exponent - 3);
}

/// The root of the variance: half does not reach as far as squares do.
Image standard_deviation(const Image& variance) {
  Image deviation = variance;
  for (float& value : deviation.data()) value = rounded(std::sqrt(std::max(0.0f, value)));
  return deviation;
}

bool is_opaque(const Image& beauty) {
  for (int y = 0; y < beauty.height(); ++y) {
    for (int x = 0; x < beauty.width(); ++x) {
      if (beauty.at(x, y, 3) != 1.0f) return false;
    }
  }
  return true;
}

/// Half if it holds every colour to its relative precision of 2^-11, or to a small part of the pixel's
/// deviation or of the mean colour.
Imf::PixelType smallest_type(const Image& image, const Image& deviation) {
  constexpr float precision = 0x1p-11f;
  constexpr float share_of_deviation = 0.0625f;
  double sum = 0.0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) sum += std::abs(image.at(x, y, c));
    }
  }
  const auto mean = static_cast<float>(sum / (3.0 * static_cast<double>(image.pixel_count())));
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const float value = image.at(x, y, c);
        const float noise = deviation.empty() ? precision * mean : share_of_deviation * deviation.at(x, y, c);
        const float error = std::abs(static_cast<float>(Imath::half(value)) - value);
        if (error > std::max(precision * std::abs(value), noise)) return Imf::FLOAT;
      }
    }
  }
  return Imf::HALF;
}

bool exceeds_half(const Image& image) {
  return std::ranges::any_of(image.data(),
                             [](float value) { return std::isfinite(value) && std::abs(value) > HALF_MAX; });
}

}  // namespace

void write_compact_exr(const std::string& path, const Frame& frame, const Attributes& attributes,
                       const Imath::V2i& first) {
  const Imath::Box2i window(first, first + Imath::V2i(frame.width() - 1, frame.height() - 1));
  Imf::Header header(window, window);
  header.setType(Imf::SCANLINEIMAGE);
  header.compression() = Imf::ZIP_COMPRESSION;
  insert_attributes(header, attributes);
  FrameChannels channels;
  const auto add = [&](const std::string& name, Imf::PixelType type, const Image& image, int channel) {
    header.channels().insert(name, Imf::Channel(type));
    channels[name] = {&image, channel, first};
  };
  Image deviation;
  if (frame.has(Aov::variance)) {
    deviation = standard_deviation(frame.image(Aov::variance));
    const Imf::PixelType type = smallest_type(deviation, Image());
    for (int c = 0; c < 3; ++c) add(std::string("noiselevel.") + "RGB"[c], type, deviation, c);
  }
  const Image& beauty = frame.image(Aov::beauty);
  const Imf::PixelType type = smallest_type(beauty, deviation);
  for (int c = 0; c < 3; ++c) add(std::string(1, "RGB"[c]), type, beauty, c);
  if (!is_opaque(beauty)) add("A", Imf::HALF, beauty, 3);
  for (const AovInfo& entry : kAovTable) {
    if (!frame.has(entry.aov) || entry.aov == Aov::beauty || entry.aov == Aov::variance) continue;
    const Imf::PixelType type_of_layer = exceeds_half(frame.image(entry.aov)) ? Imf::FLOAT : Imf::HALF;
    add_layer(frame, entry.aov, "", type_of_layer, first, header, channels);
  }
  WriteReport report;
  writing(path, {header},
          [&](Imf::MultiPartOutputFile& file) { write_part(file, 0, channels, nullptr, report); });
}

}  // namespace becalm::io
