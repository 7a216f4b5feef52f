#include "filter/sequence/spilled_light.h"

#include <algorithm>
#include <atomic>

#include "filter/for_rows.h"
#include "filter/luminance.h"

namespace becalm::filter {
namespace {

/// Of soft edges with a coverage of 0.1, at 4 samples, one pixel in three has alpha.
constexpr int kReach = 3;
/// Of factors, whose squares stay within floats.
constexpr double kLargest = 1e6;

/// Calls `body(i)` for the index of every pixel at most `reach` away from (x, y) in x and y.
template <class Body>
void for_each_near(const Image& image, int x, int y, int reach, const Body& body) {
  const int bottom = std::min(y + reach + 1, image.height());
  const int right = std::min(x + reach + 1, image.width());
  for (int v = std::max(y - reach, 0); v < bottom; ++v) {
    for (int u = std::max(x - reach, 0); u < right; ++u)
      body(static_cast<std::size_t>(v) * image.width() + u);
  }
}

double light_of(const Image& image, std::size_t i) {
  return std::max(luminance(image.data().subspan(4 * i, 3)), 0.0f);
}

}  // namespace

std::vector<float> spilled_light(const Image& beauty, std::span<const std::uint8_t> empty,
                                 const Image& denoised) {
  if (std::ranges::find(empty, 1) == empty.end()) return {};
  const auto takes_light = [&](std::size_t i) { return empty[i] == 0 && beauty.data()[4 * i + 3] > 0.0f; };
  std::vector<double> parts(empty.size());  // of an empty pixel: its light over that around it
  std::atomic<bool> any = false;
  for_each_pixel(denoised.width(), denoised.height(), [&](int x, int y, std::size_t i) {
    if (empty[i] == 0 || light_of(denoised, i) == 0.0) return;
    double around = 0.0;
    for_each_near(denoised, x, y, kReach, [&](std::size_t near) {
      if (takes_light(near)) around += light_of(denoised, near);
    });
    if (around == 0.0) return;
    parts[i] = light_of(denoised, i) / around;
    any = true;
  });
  if (!any) return {};
  std::vector<float> factors(empty.size(), 1.0f);
  for_each_pixel(denoised.width(), denoised.height(), [&](int x, int y, std::size_t i) {
    const double light = light_of(denoised, i);
    if (!takes_light(i) || light == 0.0) return;
    double factor = 1.0;
    for_each_near(denoised, x, y, kReach, [&](std::size_t near) { factor += parts[near]; });
    double brightest = light;
    for_each_near(beauty, x, y, 1,
                  [&](std::size_t near) { brightest = std::max(brightest, light_of(beauty, near)); });
    factors[i] = static_cast<float>(std::min({factor, brightest / light, kLargest}));
  });
  return factors;
}

}  // namespace becalm::filter
