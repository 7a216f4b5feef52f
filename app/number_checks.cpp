#include "app/number_checks.h"

#include <fmt/format.h>

#include <optional>

#include "app/parse_numbers.h"

namespace becalm::app {

CLI::Validator number_from(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        const std::optional<double> value = parse_number<double>(text);
        const bool fits = value && *value >= low && *value <= high;
        return fits ? std::string()
                    : fmt::format("expected a number from {} to {}, found {}", low, high, text);
      },
      "");
}

CLI::Validator whole_number_from(std::int64_t low, std::int64_t high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        const std::optional<std::int64_t> value = parse_number<std::int64_t>(text);
        const bool fits = value && *value >= low && *value <= high;
        return fits ? std::string()
                    : fmt::format("expected a whole number from {} to {}, found {}", low, high, text);
      },
      "");
}

}  // namespace becalm::app
