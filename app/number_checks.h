#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace becalm::app {

/// A number of that range, and no NaN, which CLI::Range takes.
CLI::Validator number_from(double low, double high);

/// A whole number of that range in decimal digits: neither `1e3` nor `8x`.
CLI::Validator whole_number_from(std::int64_t low, std::int64_t high);

}  // namespace becalm::app
