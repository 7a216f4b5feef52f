#include "frame/audit/audit.h"

namespace becalm::audit {

std::vector<Finding> audit(const Subject& subject) {
  std::vector<Finding> findings;
  for (const auto check :
       {check_duplicate, check_fixed_noise, check_denoised, check_clamped, check_not_a_number, check_overflow,
        check_fireflies, check_premultiplied, check_albedo, check_albedo_flipped, check_normal_length,
        check_normal_space, check_motion, check_same_halves, check_variance}) {
    if (std::optional<Finding> finding = check(subject)) findings.push_back(std::move(*finding));
  }
  return findings;
}

}  // namespace becalm::audit
