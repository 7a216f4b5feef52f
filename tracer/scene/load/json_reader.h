#pragma once

#include <array>
#include <initializer_list>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace becalm::tracer {

/// A value of a JSON file that knows where it stands, so that whatever is wrong with it can be said as
/// `FILE: /json/pointer: message`. Every accessor throws Error(bad_input) of that form when the value is not
/// what it was asked to be. Valid as long as the document.
class JsonValue {
 public:
  JsonValue(const nlohmann::json& value, const std::string& file, std::string pointer)
      : value_(&value), file_(&file), pointer_(std::move(pointer)) {}

  [[noreturn]] void fail(const std::string& message) const;

  bool is_object() const;
  bool is_array() const;

  /// Throws for a value that is not an object, or has another key.
  void allow_keys(std::initializer_list<std::string_view> keys) const;
  bool has(std::string_view key) const;
  JsonValue at(std::string_view key) const;
  std::optional<JsonValue> find(std::string_view key) const;

  /// Members of an object in the order of their names, or elements of an array.
  std::vector<std::pair<std::string, JsonValue>> members() const;
  std::vector<JsonValue> elements() const;

  std::string string() const;
  bool boolean() const;
  double number(double low = -std::numeric_limits<float>::max(),
                double high = std::numeric_limits<float>::max()) const;
  int integer(int low, int high) const;

  /// A list of exactly N numbers.
  template <std::size_t N>
  std::array<double, N> numbers(double low = -std::numeric_limits<float>::max(),
                                double high = std::numeric_limits<float>::max()) const {
    const std::vector<JsonValue> list = numbers_of_length(N);
    std::array<double, N> result;
    for (std::size_t i = 0; i < N; ++i) result[i] = list[i].number(low, high);
    return result;
  }

  /// [r, g, b], or one number for all three.
  std::array<double, 3> triple(double low, double high) const;

  /// The index of the string among the choices.
  std::size_t choice(std::span<const std::string_view> choices) const;
  std::size_t choice(std::initializer_list<std::string_view> choices) const {
    return choice(std::span(choices.begin(), choices.size()));
  }

 private:
  std::vector<JsonValue> numbers_of_length(std::size_t count) const;

  const nlohmann::json* value_;
  const std::string* file_;
  std::string pointer_;
};

/// Parses a JSON file. Throws Error(bad_input): for a file that cannot be read, `FILE:LINE:COLUMN: message`
/// for a syntax error, and `FILE: /json/pointer: message` for a key given twice and a number beyond double.
nlohmann::json parse_json_file(const std::string& file);

}  // namespace becalm::tracer
