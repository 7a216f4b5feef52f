#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace becalm::app {

/// JSON has no infinity: it is the text "inf" or "-inf". NaN, of what was not measured, is null.
inline nlohmann::ordered_json json_number(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  return value;
}

}  // namespace becalm::app
