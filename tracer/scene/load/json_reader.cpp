#include "tracer/scene/load/json_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "frame/error.h"
#include "tracer/scene/load/text_file.h"

namespace becalm::tracer {

using nlohmann::json;

namespace {

/// One step of a JSON pointer (RFC 6901).
std::string escape(std::string_view key) {
  std::string escaped = "/";
  for (const char c : key) {
    if (c == '~') {
      escaped += "~0";
    } else if (c == '/') {
      escaped += "~1";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

/// The value as it stands in the file, cut to a length that leaves a message readable.
std::string brief(const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  constexpr std::size_t longest = 40;
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  return text;
}

}  // namespace

void JsonValue::fail(const std::string& message) const {
  throw Error(ExitStatus::bad_input, *file_ + ": " + (pointer_.empty() ? "/" : pointer_) + ": " + message);
}

bool JsonValue::is_object() const {
  return value_->is_object();
}
bool JsonValue::is_array() const {
  return value_->is_array();
}

void JsonValue::allow_keys(std::initializer_list<std::string_view> keys) const {
  if (!value_->is_object()) fail("expected an object, found " + brief(*value_));
  for (const auto& [key, value] : value_->items()) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
      JsonValue(value, *file_, pointer_ + escape(key))
          .fail(fmt::format("unknown key; expected one of {}", fmt::join(keys, ", ")));
    }
  }
}

bool JsonValue::has(std::string_view key) const {
  return value_->is_object() && value_->contains(key);
}

std::optional<JsonValue> JsonValue::find(std::string_view key) const {
  if (!value_->is_object()) fail("expected an object, found " + brief(*value_));
  const auto member = value_->find(key);
  if (member == value_->end()) return std::nullopt;
  return JsonValue(*member, *file_, pointer_ + escape(key));
}

JsonValue JsonValue::at(std::string_view key) const {
  const std::optional<JsonValue> member = find(key);
  if (!member) fail(fmt::format("'{}' is missing", key));
  return *member;
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::members() const {
  if (!value_->is_object()) fail("expected an object, found " + brief(*value_));
  std::vector<std::pair<std::string, JsonValue>> result;
  for (const auto& [key, value] : value_->items()) {
    result.emplace_back(key, JsonValue(value, *file_, pointer_ + escape(key)));
  }
  return result;
}

std::vector<JsonValue> JsonValue::elements() const {
  if (!value_->is_array()) fail("expected a list, found " + brief(*value_));
  std::vector<JsonValue> result;
  for (const json& value : *value_) {
    result.emplace_back(value, *file_, pointer_ + "/" + std::to_string(result.size()));
  }
  return result;
}

std::string JsonValue::string() const {
  if (!value_->is_string()) fail("expected a string, found " + brief(*value_));
  auto text = value_->get<std::string>();
  // The system would take a path or an argument for what stands before it.
  if (text.find('\0') != std::string::npos)
    fail("expected a string without \\u0000, found " + brief(*value_));
  return text;
}

bool JsonValue::boolean() const {
  if (!value_->is_boolean()) fail("expected true or false, found " + brief(*value_));
  return value_->get<bool>();
}

double JsonValue::number(double low, double high) const {
  const double value = value_->is_number() ? value_->get<double>() : std::nan("");
  if (value >= low && value <= high) return value;
  constexpr double any_number = std::numeric_limits<float>::max();
  if (low == -any_number && high == any_number) fail("expected a number, found " + brief(*value_));
  if (high == any_number)
    fail(fmt::format("expected a number of at least {}, found {}", low, brief(*value_)));
  fail(fmt::format("expected a number from {} to {}, found {}", low, high, brief(*value_)));
}

int JsonValue::integer(int low, int high) const {
  if (value_->is_number_integer()) {
    const double value = value_->get<double>();
    if (value >= low && value <= high) return static_cast<int>(value);
  }
  fail(fmt::format("expected a whole number from {} to {}, found {}", low, high, brief(*value_)));
}

std::vector<JsonValue> JsonValue::numbers_of_length(std::size_t count) const {
  if (!value_->is_array() || value_->size() != count) {
    fail(fmt::format("expected a list of {} numbers, found {}", count, brief(*value_)));
  }
  return elements();
}

std::array<double, 3> JsonValue::triple(double low, double high) const {
  if (value_->is_array()) return numbers<3>(low, high);
  if (!value_->is_number()) fail("expected a number or a list of 3 numbers, found " + brief(*value_));
  const double value = number(low, high);
  return {value, value, value};
}

std::size_t JsonValue::choice(std::span<const std::string_view> choices) const {
  const auto found = value_->is_string()
                         ? std::find(choices.begin(), choices.end(), value_->get<std::string>())
                         : choices.end();
  if (found == choices.end()) {
    fail(fmt::format("expected one of {}, found {}", fmt::join(choices, ", "), brief(*value_)));
  }
  return static_cast<std::size_t>(found - choices.begin());
}

json parse_json_file(const std::string& file) {
  const std::optional<std::string> contents = read_text_file(file);
  if (!contents) throw Error(ExitStatus::bad_input, file + ": cannot read it");
  const std::string& text = *contents;

  // The library keeps the last of equal keys and drops the others silently.
  std::vector<std::set<std::string>> open_objects;
  const auto reject = [&](int depth, json::parse_event_t event, json& parsed) {
    // Later readers recurse into the document.
    constexpr int deepest = 100;
    if (depth > deepest)
      throw Error(ExitStatus::bad_input,
                  fmt::format("{}: values are nested more than {} deep", file, deepest));
    if (event == json::parse_event_t::object_start) open_objects.emplace_back();
    if (event == json::parse_event_t::object_end) open_objects.pop_back();
    if (event == json::parse_event_t::key && !open_objects.back().insert(parsed.get<std::string>()).second) {
      throw Error(ExitStatus::bad_input,
                  fmt::format("{}: the key {} is given twice in one object", file, brief(parsed)));
    }
    return true;
  };
  try {
    return json::parse(text, reject);
  } catch (const json::parse_error& error) {
    const std::size_t at = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
    const auto begin = text.begin(), end = text.begin() + static_cast<std::ptrdiff_t>(at);
    const std::size_t line_start = text.rfind('\n', at == 0 ? 0 : at - 1);
    const std::size_t column = at == 0 || line_start == std::string::npos ? at + 1 : at - line_start;
    // what() is "[json.exception...] parse error at line L, column C: what happened".
    const std::string what = error.what();
    const std::size_t colon = what.find(": ");
    throw Error(ExitStatus::bad_input,
                fmt::format("{}:{}:{}: {}", file, std::count(begin, end, '\n') + 1, column,
                            colon == std::string::npos ? what : what.substr(colon + 2)));
  } catch (const json::exception& error) {  // a number beyond double's range
    throw Error(ExitStatus::bad_input, file + ": " + error.what());
  }
}

}  // namespace becalm::tracer
