#include "app/number_checks.h"

#include <fmt/format.h>

#include <array>
#include <span>

#include "app/parse_numbers.h"

namespace becalm::app {

CLI::Validator number_from(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        double value = 0.0;
        const bool fits = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
        return fits ? std::string() : fmt::format("expected a number from {} to {}", low, high);
      },
      "");
}

CLI::Validator whole_number_from(std::int64_t low, std::int64_t high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        std::array<std::int64_t, 1> value{};
        const std::string digits = text.substr(text.starts_with('+') ? 1 : 0);
        const bool fits =
            parse_numbers(digits, ',', std::span<std::int64_t>(value)) && value[0] >= low && value[0] <= high;
        return fits ? std::string()
                    : fmt::format("expected a whole number from {} to {}, found {}", low, high, text);
      },
      "");
}

}  // namespace becalm::app
