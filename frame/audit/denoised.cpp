#include <fmt/format.h>

#include "frame/audit/audit.h"
#include "frame/audit/pixels.h"

namespace becalm::audit {
namespace {

/// Clean pictures have less; a frame of noise alone has a fifth, and one whose noise is seen 2 %.
constexpr double kFewestRough = 0.003;

}  // namespace

std::optional<Finding> check_denoised(const Subject& subject) {
  const std::optional<double> share = rough_share(subject.frame.image(Aov::beauty));
  if (!share || *share >= kFewestRough) return std::nullopt;
  return Finding{
      "denoised",
      fmt::format("only {:.2f} % of the lit pixels stick out from their neighbours as noise does, so "
                  "the frame seems to be denoised already: give becalm the renderer's own output",
                  100.0 * *share)};
}

}  // namespace becalm::audit
