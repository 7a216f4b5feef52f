#include "frame/io/coloured_light.h"

#include <algorithm>
#include <cmath>

namespace becalm::io {
namespace {

constexpr int kBlock = 16;  // px

float quotient(float product, float colour) {
  return colour == 0.0f ? 0.0f : product / colour;
}

/// The largest magnitude of each channel in each block, of finite values.
Image block_maxima(const Image& image) {
  Image maxima((image.width() + kBlock - 1) / kBlock, (image.height() + kBlock - 1) / kBlock,
               image.channels());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < image.channels(); ++c) {
        const float size = std::abs(image.at(x, y, c));
        float& largest = maxima.at(x / kBlock, y / kBlock, c);
        if (std::isfinite(size)) largest = std::max(largest, size);
      }
    }
  }
  return maxima;
}

/// The largest of each block and of those around it.
Image around(const Image& blocks) {
  Image largest(blocks.width(), blocks.height(), blocks.channels());
  for (int y = 0; y < blocks.height(); ++y) {
    for (int x = 0; x < blocks.width(); ++x) {
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, blocks.height() - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, blocks.width() - 1); ++u) {
          for (int c = 0; c < blocks.channels(); ++c) {
            largest.at(x, y, c) = std::max(largest.at(x, y, c), blocks.at(u, v, c));
          }
        }
      }
    }
  }
  return largest;
}

Image divided(const Image& product, const Image& colour) {
  Image light(product.width(), product.height(), product.channels());
  std::ranges::transform(product.data(), colour.data(), light.data().begin(), quotient);
  return light;
}

}  // namespace

Image light_without_colour(const Image& product, const Image& colour, const Image& came) {
  const Image limits = around(block_maxima(divided(came, colour)));
  Image light = divided(product, colour);
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x) {
      for (int c = 0; c < light.channels(); ++c) {
        const float limit = limits.at(x / kBlock, y / kBlock, c);
        float& value = light.at(x, y, c);
        // What came not finite is passed on; any other quotient may overflow by a tiny colour.
        if (std::isfinite(came.at(x, y, c)) || std::isfinite(value)) value = std::clamp(value, -limit, limit);
      }
    }
  }
  return light;
}

}  // namespace becalm::io
