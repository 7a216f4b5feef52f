#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "filter/settings.h"
#include "frame/error.h"

namespace becalm::filter {

/// Names of Directions, which both tables of settings have.
inline constexpr std::array<std::string_view, 2> kDirectionsNames{"forward", "both"};

/// How a member of `S` is read from text and written as text.
template <class S>
struct SettingField {
  std::function<bool(S&, std::string_view)> assign;  ///< false if the text is no value of the field
  std::function<std::string(const S&)> text;
};

template <class S>
struct SettingRow {
  SettingInfo info;
  SettingField<S> field;
};

inline std::optional<int> parse_number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The numbers of a text that `separator` joins, each within its range; nothing if the text is anything else.
inline std::optional<std::vector<int>> parse_numbers(std::string_view text, char separator, int lowest,
                                                     int highest) {
  std::vector<int> values;
  while (true) {
    const auto end = text.find(separator);
    const auto value = parse_number(text.substr(0, end));
    if (!value || *value < lowest || *value > highest) return std::nullopt;
    values.push_back(*value);
    if (end == std::string_view::npos) return values;
    text.remove_prefix(end + 1);
  }
}

/// A number within a range.
template <class S>
SettingField<S> number_field(int S::*member, int lowest, int highest) {
  return {.assign =
              [=](S& settings, std::string_view text) {
                const auto value = parse_number(text);
                if (!value || *value < lowest || *value > highest) return false;
                settings.*member = *value;
                return true;
              },
          .text = [=](const S& settings) { return fmt::format("{}", settings.*member); }};
}

/// Whether something is done: 1 or yes, 0 or no. `names` are those that are written, of false and of true.
template <class S>
SettingField<S> switch_field(bool S::*member, std::array<std::string_view, 2> names) {
  return {.assign =
              [=](S& settings, std::string_view text) {
                const bool on = text == "1" || text == "yes";
                if (!on && text != "0" && text != "no") return false;
                settings.*member = on;
                return true;
              },
          .text = [=](const S& settings) { return std::string(names[settings.*member ? 1 : 0]); }};
}

/// A value of an enum. The names are in the order of its values, from `first` on.
template <class S, class Enum>
SettingField<S> name_field(Enum S::*member, std::span<const std::string_view> names, Enum first = Enum{}) {
  const auto offset = static_cast<std::size_t>(first);
  return {.assign =
              [=](S& settings, std::string_view text) {
                for (std::size_t i = 0; i < names.size(); ++i) {
                  if (names[i] != text) continue;
                  settings.*member = static_cast<Enum>(i + offset);
                  return true;
                }
                return false;
              },
          .text =
              [=](const S& settings) {
                return std::string(names[static_cast<std::size_t>(settings.*member) - offset]);
              }};
}

/// `Rows` is a range of SettingRow, here and below.
template <class Rows>
std::vector<SettingInfo> infos_of(const Rows& rows) {
  std::vector<SettingInfo> infos;
  for (const auto& row : rows) infos.push_back(row.info);
  return infos;
}

/// Applies one `KEY=VALUE`. Throws Error(usage) naming the key, the value and the range.
template <class Rows, class S>
void assign_setting(const Rows& rows, S& settings, std::string_view assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    throw Error(ExitStatus::usage, fmt::format("--set '{}': expected KEY=VALUE", assignment));
  }
  const std::string_view key = assignment.substr(0, equals);
  const std::string_view value = assignment.substr(equals + 1);
  std::vector<std::string_view> keys;
  for (const auto& row : rows) {
    keys.push_back(row.info.key);
    if (row.info.key != key) continue;
    if (row.field.assign(settings, value)) return;
    throw Error(ExitStatus::usage,
                fmt::format("--set {}: value '{}': expected {}", key, value, row.info.type));
  }
  throw Error(ExitStatus::usage,
              fmt::format("--set: no setting '{}'; there are {}", key, fmt::join(keys, ", ")));
}

/// All settings as `key=value` pairs joined by spaces, in the rows' order.
template <class Rows, class S>
std::string settings_text(const Rows& rows, const S& settings) {
  std::string text;
  for (const auto& row : rows) {
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", row.info.key, row.field.text(settings));
  }
  return text;
}

}  // namespace becalm::filter
