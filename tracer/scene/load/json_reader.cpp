#include "tracer/scene/load/json_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "frame/error.h"
#include "frame/regular_file.h"
#include "frame/text_file.h"

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

/// Cut to a length that leaves a message readable.
std::string shortened(std::string text) {
  constexpr std::size_t longest = 40;
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  return text;
}

/// The value as it stands in the file, shortened.
std::string brief(const json& value) {
  return shortened(value.dump(-1, ' ', false, json::error_handler_t::replace));
}

[[noreturn]] void fail_at(const std::string& file, const std::string& pointer, const std::string& message) {
  throw Error(ExitStatus::bad_input, file + ": " + (pointer.empty() ? "/" : pointer) + ": " + message);
}

/// Follows the library's parser, which keeps the last of equal keys and drops the others silently, and does
/// not tell the place of a number that it cannot hold.
class ParserWatch {
 public:
  explicit ParserWatch(const std::string& file) : file_(file) {}

  /// Throws for a key that its object already has, and for what is nested too deep.
  void see(int depth, json::parse_event_t event, const json& parsed) {
    using Event = json::parse_event_t;
    // Later readers recurse into the document.
    constexpr int deepest = 100;
    if (depth > deepest)
      throw Error(ExitStatus::bad_input,
                  fmt::format("{}: values are nested more than {} deep", file_, deepest));
    if (event == Event::object_start || event == Event::array_start)
      open_.push_back({.is_array = event == Event::array_start});
    if (event == Event::object_end || event == Event::array_end) open_.pop_back();
    if (event == Event::key) see_key(parsed);
    const bool ends_value = event == Event::value || event == Event::object_end || event == Event::array_end;
    if (ends_value && !open_.empty()) ++open_.back().values;
  }

  /// JSON pointer of the value that is being read.
  std::string pointer() const { return pointer(open_.size()); }

 private:
  struct Container {
    bool is_array;
    std::size_t values = 0;           ///< read so far
    std::string key = {};             ///< of an object: the last one
    std::set<std::string> keys = {};  ///< of an object
  };

  void see_key(const json& parsed) {
    Container& object = open_.back();
    object.key = parsed.get<std::string>();
    if (!object.keys.insert(object.key).second)
      fail_at(file_, pointer(open_.size() - 1), fmt::format("the key {} is given twice", brief(parsed)));
  }

  /// Of what is read in the `depth`-th open container.
  std::string pointer(std::size_t depth) const {
    std::string steps;
    for (std::size_t i = 0; i < depth; ++i)
      steps += escape(open_[i].is_array ? std::to_string(open_[i].values) : open_[i].key);
    return steps;
  }

  const std::string& file_;
  std::vector<Container> open_;
};

/// The part of the library's message that follows `words`; all of it if they are not there.
std::string after(std::string_view words, const std::string& message) {
  const std::size_t at = message.find(words);
  return at == std::string::npos ? message : message.substr(at + words.size());
}

[[noreturn]] void fail_syntax(const std::string& file, const std::string& text,
                              const json::parse_error& error) {
  const std::size_t at = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
  const auto begin = text.begin(), end = text.begin() + static_cast<std::ptrdiff_t>(at);
  const std::size_t line_start = text.rfind('\n', at == 0 ? 0 : at - 1);
  const std::size_t column = at == 0 || line_start == std::string::npos ? at + 1 : at - line_start;
  // what() is "[json.exception...] parse error at line L, column C: what happened".
  throw Error(ExitStatus::bad_input, fmt::format("{}:{}:{}: {}", file, std::count(begin, end, '\n') + 1,
                                                 column, after(": ", error.what())));
}

[[noreturn]] void fail_number(const std::string& file, const std::string& pointer,
                              const json::out_of_range& error) {
  // what() is "[json.exception...] number overflow parsing 'NUMBER'".
  std::string number = after("parsing '", error.what());
  number.pop_back();
  fail_at(file, pointer, "expected a number of at most 1.8e308 in size, found " + shortened(number));
}

}  // namespace

void JsonValue::fail(const std::string& message) const {
  fail_at(*file_, pointer_, message);
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
  if (high == any_number && (value > high || (value < low && low == -any_number)))
    fail("expected a number of at most 3.4e38 in size, found " + brief(*value_));
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
  // Of a pipe nothing would be left for the hash of a scene, so that --resume took frames of another one.
  refuse_other_than_file(file, "a JSON file");
  const std::optional<std::string> contents = read_text_file(file);
  if (!contents) throw Error(ExitStatus::bad_input, file + ": cannot read it");
  if (contents->starts_with("\x76\x2f\x31\x01")) {
    throw Error(ExitStatus::bad_input,
                file + ": an EXR file, expected a JSON file; becalm denoise takes EXR files");
  }
  ParserWatch watch(file);
  try {
    return json::parse(*contents, [&](int depth, json::parse_event_t event, const json& parsed) {
      watch.see(depth, event, parsed);
      return true;
    });
  } catch (const json::parse_error& error) {
    fail_syntax(file, *contents, error);
  } catch (const json::out_of_range& error) {
    fail_number(file, watch.pointer(), error);
  }
}

}  // namespace becalm::tracer
