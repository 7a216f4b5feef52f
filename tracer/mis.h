#pragma once

#include <cassert>

#include "tracer/scene/scene_description.h"

namespace becalm::tracer {

/// Weight of a sample of density `pdf` that another technique would have found with `other_pdf`, both in the
/// same measure (Veach and Guibas 1995).
inline float mis_weight(Heuristic heuristic, float pdf, float other_pdf) {
  assert(pdf > 0.0f);
  const float ratio = other_pdf / pdf;  // in this form nothing overflows to NaN
  return 1.0f / (1.0f + (heuristic == Heuristic::power ? ratio * ratio : ratio));
}

}  // namespace becalm::tracer
