#include "app/noise_report.h"

#include <fmt/format.h>

namespace becalm::app {

std::string noise_text(double noise, double target, const std::deque<AdaptiveSampling>& sampling) {
  AdaptiveSampling::Spent spent;
  for (const AdaptiveSampling& of_eye : sampling) {
    spent.frames += of_eye.spent().frames;
    spent.spp += of_eye.spent().spp;
    spent.capped += of_eye.spent().capped;
  }
  std::string text = fmt::format("noise expected in the frames: {:.3g} (--noise-target {})", noise, target);
  if (spent.frames == 0.0) return text;  // all were rendered before
  text += fmt::format(", of {:.3g} samples per pixel on average", spent.spp / spent.frames);
  constexpr double near = 1.05;         // over the target
  constexpr double many_capped = 0.01;  // of the pixels
  if (noise <= near * target) return text;
  const double capped = spent.capped / spent.frames;
  if (capped > many_capped)
    return text + fmt::format("; {:.0f} % of the pixels have the most that --spp allows", 100.0 * capped);
  return text + fmt::format(
                    "; they are estimated from {:g} pilot samples per pixel, which misjudged: a lower "
                    "target takes more",
                    AdaptiveSampling::pilot_spp());
}

}  // namespace becalm::app
