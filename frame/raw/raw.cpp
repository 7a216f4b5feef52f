#include "frame/raw/raw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <vector>

#include "frame/error.h"
#include "frame/pictures/embedded_library.h"
#include "frame/raw/dng.h"
#include "frame/regular_file.h"

extern "C" {
// NOLINTBEGIN(readability-identifier-naming): symbols of becalm_embed_module
extern const std::byte becalm_raw_module[];
extern const std::byte becalm_raw_module_end[];
// NOLINTEND(readability-identifier-naming)
}

namespace becalm::raw {

Library& library() {
  static Library& loaded = *reinterpret_cast<Library* (*)()>(
      load_embedded_library({becalm_raw_module, becalm_raw_module_end}, "becalm_raw_library", "LibRaw"))();
  return loaded;
}

std::unique_ptr<File> open(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw Error(ExitStatus::bad_input, fmt::format("{}: no such file", path));
  constexpr const char* expected = "a camera's raw file or a DNG file";
  refuse_other_than_file(path, expected);
  Library& opens = library();
  try {
    return opens.open(path);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: {}; expected {}", path, error.what(), expected));
  }
}

Mosaic read(File& file, const std::string& path) {
  try {
    file.unpack();
    Mosaic mosaic{Image(file.info().width, file.info().height, 1), file.info().cfa};
    file.read(mosaic.samples.data());
    return mosaic;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: {}", path, error.what()));
  }
}

namespace {

/// Turns an image upright.
Image upright(const Image& image, int flip) {
  if (flip == 0) return image;
  const bool transposed = (flip & 4) != 0;
  Image result(transposed ? image.height() : image.width(), transposed ? image.width() : image.height(),
               image.channels());
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      int from_x = transposed ? y : x;
      int from_y = transposed ? x : y;
      if (flip & 2) from_y = image.height() - 1 - from_y;
      if (flip & 1) from_x = image.width() - 1 - from_x;
      std::ranges::copy(image.pixel(from_x, from_y), result.pixel(x, y).begin());
    }
  }
  return result;
}

/// LibRaw demosaics no X-Trans pictures that are smaller.
constexpr int kLeastDemosaiced = 516;

/// A sample of the same colour inside of the mosaic.
int inside(int at, int size, const CfaPattern& cfa) {
  return at < size ? at : at - cfa.period * ((at - size) / cfa.period + 1);
}

Image top_left(const Image& image, int width, int height) {
  if (image.width() == width && image.height() == height) return image;
  Image part(width, height, image.channels());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) std::ranges::copy(image.pixel(x, y), part.pixel(x, y).begin());
  }
  return part;
}

}  // namespace

Image develop(const Mosaic& mosaic, const Info& info) {
  // LibRaw's samples have 16 bits and no sign: they are white-balanced, so that its decisions are those that
  // it would take, and keep noise below black.
  constexpr float pedestal = 2048.0f;
  const float least_factor = *std::ranges::min_element(info.white_balance);
  const float largest_factor = *std::ranges::max_element(info.white_balance);
  const float scale = (65535.0f - pedestal) / largest_factor;
  const Image& samples = mosaic.samples;
  const int width = std::max(samples.width(), kLeastDemosaiced);
  const int height = std::max(samples.height(), kLeastDemosaiced);
  std::vector<std::uint16_t> values(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float sample =
          samples.at(inside(x, samples.width(), mosaic.cfa), inside(y, samples.height(), mosaic.cfa), 0);
      const float balanced = sample * info.white_balance[mosaic.cfa.color(x, y)];
      values[static_cast<std::size_t>(y) * width + x] =
          static_cast<std::uint16_t>(std::lround(std::clamp(pedestal + balanced * scale, 0.0f, 65535.0f)));
    }
  }
  Info plain;
  plain.width = width;
  plain.height = height;
  plain.cfa = mosaic.cfa;
  Image rgb(plain.width, plain.height, 3);
  try {
    library().demosaic(dng_bytes(plain, {.values = values}), rgb.data());
  } catch (const std::exception& error) {
    throw Error(ExitStatus::resource,
                fmt::format("the merged mosaic cannot be demosaiced: {}", error.what()));
  }
  rgb = top_left(rgb, samples.width(), samples.height());
  const auto pixels = rgb.data();
  for (std::size_t i = 0; i < rgb.pixel_count(); ++i) {
    float camera[3];
    for (int c = 0; c < 3; ++c)
      camera[c] = std::min((pixels[3 * i + c] - pedestal) / (scale * least_factor), 1.0f);
    for (int c = 0; c < 3; ++c) {
      const float* row = info.camera_to_rec709.data() + 3 * c;
      pixels[3 * i + c] = row[0] * camera[0] + row[1] * camera[1] + row[2] * camera[2];
    }
  }
  return upright(rgb, info.flip);
}

}  // namespace becalm::raw
