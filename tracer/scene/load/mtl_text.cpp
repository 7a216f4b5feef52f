#include "tracer/scene/load/mtl_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "tracer/scene/load/fail_in_file.h"
#include "tracer/scene/load/text_words.h"
#include "tracer/scene/load/wavefront_text.h"

namespace becalm::tracer {

namespace {

constexpr float kAny = std::numeric_limits<float>::infinity();

/// How many numbers follow a keyword, and their range. Others are taken as the nearest in it, but for an
/// index of refraction below 1: files with an Ni of 0 do not mean 1.
struct NumberRule {
  int count;
  float low;
  float high;
};

const NumberRule* find_rule(std::string_view keyword) {
  static const std::map<std::string_view, NumberRule> rules = {
      {"Kd", {3, 0, 1}},    {"Ks", {3, 0, 1}},    {"Ke", {3, 0, kAny}},  {"Tf", {3, 0, 1}},
      {"Ns", {1, 0, kAny}}, {"Ni", {1, 1, 10}},   {"d", {1, 0, 1}},      {"Tr", {1, 0, 1}},
      {"Pr", {1, 0, 1}},    {"Pm", {1, 0, 1}},    {"Ps", {1, 0, 1}},     {"Pc", {1, 0, 1}},
      {"Pcr", {1, 0, 1}},   {"aniso", {1, 0, 1}}, {"anisor", {1, 0, 1}}, {"illum", {1, -kAny, kAny}}};
  const auto found = rules.find(keyword);
  return found == rules.end() ? nullptr : &found->second;
}

/// The word that makes the statement one of a form that is not supported; empty if none does.
std::string_view unsupported_form(std::string_view keyword, std::string_view rest) {
  const std::string_view word = take_word(rest);
  const NumberRule* rule = find_rule(keyword);
  const bool is_color = rule != nullptr && rule->count == 3;
  const bool unsupported = is_color ? word == "spectral" || word == "xyz" : keyword == "d" && word == "-halo";
  return unsupported ? word : std::string_view();
}

/// What follows the keyword; of a colour with green and blue, which equal red where they are left out.
std::string with_all_channels(std::string_view keyword, std::string_view rest) {
  const NumberRule* rule = find_rule(keyword);
  std::string_view numbers = without_comment(rest);
  const std::string_view red = take_word(numbers);
  if (rule == nullptr || rule->count != 3 || red.empty() || !trimmed(numbers).empty())
    return std::string(rest);
  return fmt::format(" {0} {0} {0}", red);
}

/// Of the first number out of range; empty if there is none.
std::string problem_of(const std::string& path, int line_number, std::string_view keyword,
                       std::string_view numbers) {
  const NumberRule* rule = find_rule(keyword);
  if (rule == nullptr) return "";
  std::string problem;
  numbers = without_comment(numbers);
  for (int i = 0; i < rule->count; ++i) {
    const std::string_view word = take_word(numbers);
    const std::optional<float> number = parse_float(word);
    if (!number) {
      fail_in_file(path, fmt::format("line {}: '{}' needs {} finite numbers, found '{}'", line_number,
                                     keyword, rule->count, word));
    }
    if (!problem.empty() || (*number >= rule->low && *number <= rule->high)) continue;
    const std::string range = rule->high == kAny ? fmt::format("of at least {}", rule->low)
                                                 : fmt::format("from {} to {}", rule->low, rule->high);
    const bool left_out = keyword == "Ni" && *number < rule->low;
    problem = fmt::format(
        "{} {}: expected a number {}; {}", keyword, word, range,
        left_out ? "left out" : fmt::format("taken as {}", std::clamp(*number, rule->low, rule->high)));
  }
  return problem;
}

/// What may stand before an image's name.
struct ImageOption {
  std::string_view name;
  int values;                ///< at most
  std::string_view padding;  ///< for each value that is left out; empty: none may be
};
constexpr ImageOption kImageOptions[] = {
    {"-o", 3, "0"},     {"-s", 3, "1"},      {"-t", 3, "0"},        {"-mm", 2, ""},    {"-bm", 1, ""},
    {"-boost", 1, ""},  {"-blendu", 1, ""},  {"-blendv", 1, ""},    {"-clamp", 1, ""}, {"-type", 1, ""},
    {"-texres", 1, ""}, {"-imfchan", 1, ""}, {"-colorspace", 1, ""}};

/// What follows the keyword of an image: with all numbers of its options, since tinyobjloader would take the
/// image's name for one that is left out.
std::string with_all_numbers(std::string_view rest) {
  std::string result;
  while (true) {
    std::string_view after = rest;
    const auto option = std::ranges::find(kImageOptions, take_word(after), &ImageOption::name);
    if (option == std::end(kImageOptions)) return result.append(" ").append(trimmed(rest));
    result.append(" ").append(option->name);
    for (int i = 0; i < option->values; ++i) {
      std::string_view behind = after;
      const std::string_view word = take_word(behind);
      const bool left_out = !option->padding.empty() && !parse_float(word);
      result.append(" ").append(left_out ? option->padding : word);
      if (!left_out) after = behind;
    }
    rest = after;
  }
}

bool names_image(std::string_view keyword) {
  return keyword.starts_with("map_") || keyword == "bump" || keyword == "norm";
}

}  // namespace

MtlText read_mtl(const std::string& path) {
  const std::optional<std::string> file = read_wavefront_text(path);
  if (!file) fail_in_file(path, "cannot read the material file");
  MtlText mtl;
  std::string_view text = *file;
  std::string name;
  for (int line_number = 1; !text.empty(); ++line_number) {
    const std::string_view line = take_line(text);
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (const std::string_view form = unsupported_form(keyword, rest); !form.empty()) {
      if (!mtl.materials.empty()) {
        mtl.warnings.push_back(mtl_warning(
            path, line_number, name, fmt::format("{}: '{}' is not supported; left out", keyword, form)));
      }
      continue;
    }
    const std::string values =
        names_image(keyword) ? with_all_numbers(rest) : with_all_channels(keyword, rest);
    mtl.text.append(keyword).append(values) += '\n';
    if (keyword == "newmtl") {
      name = trimmed(rest);
      mtl.materials[name];
      continue;
    }
    const std::string problem = problem_of(path, line_number, keyword, values);
    if (keyword.empty() || mtl.materials.empty()) continue;  // what stands before any material is of none
    mtl.materials[name].emplace(keyword, line_number);
    if (!problem.empty()) mtl.warnings.push_back(mtl_warning(path, line_number, name, problem));
  }
  return mtl;
}

std::string mtl_warning(const std::string& path, int line, std::string_view material,
                        std::string_view message) {
  return fmt::format("{}: line {}: material '{}': {}", path, line, material, message);
}

}  // namespace becalm::tracer
