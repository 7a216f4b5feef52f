#include "app/expected_error.h"

#include <numeric>
#include <span>

namespace becalm::app {

Image expected_error(const Frame& filtered, float exposure) {
  constexpr double added_square = 0.01;  // below a tenth of the typical brightness, errors count as they are
  Image error(filtered.width(), filtered.height(), 1);
  const std::span<const float> beauty = filtered.image(Aov::beauty).data();
  const std::span<const float> variance = filtered.image(Aov::variance).data();
  const double square = double(exposure) * exposure;
  for (std::size_t i = 0; i < error.pixel_count(); ++i) {
    const double brightness = (double(beauty[4 * i]) + beauty[4 * i + 1] + beauty[4 * i + 2]) / 3.0;
    error.data()[i] =
        static_cast<float>(square * variance[3 * i] / (square * brightness * brightness + added_square));
  }
  return error;
}

double mean_expected_error(const Frame& filtered, float exposure) {
  const Image error = expected_error(filtered, exposure);
  return std::accumulate(error.data().begin(), error.data().end(), 0.0) /
         static_cast<double>(error.pixel_count());
}

}  // namespace becalm::app
