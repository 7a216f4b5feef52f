#include "tracer/scene/load/load_values.h"

#include <algorithm>
#include <filesystem>

namespace becalm::tracer {

V3f to_v3f(const std::array<double, 3>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

V3f read_color(const JsonValue& json, double high) {
  return to_v3f(json.triple(0.0, high));
}

std::string beside(const std::string& scene_file, const std::string& path) {
  return (std::filesystem::path(scene_file).parent_path() / path).string();
}

void expect_file(const JsonValue& json, const std::string& path) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) json.fail(fmt::format("no file '{}'", path));
}

std::uint32_t read_reference(const JsonValue& json, const Names& names, const char* what) {
  const std::string name = json.string();
  const auto found = names.find(name);
  if (found == names.end()) json.fail(fmt::format("no {} '{}'", what, name));
  return found->second;
}

std::uint16_t read_light_group(const JsonValue& owner, std::vector<std::string>& groups) {
  const auto json = owner.find("group");
  const std::string name = json ? json->string() : "default";
  if (name.empty()) json->fail("expected a name, found \"\"");
  // It becomes part of the names of channels, which EXR files cut at 255 bytes.
  constexpr std::size_t longest = 200;
  if (name.size() > longest ||
      std::ranges::any_of(name, [](unsigned char c) { return c < 0x20 || c == '.'; }))
    json->fail(fmt::format("expected a name of 1 to {} bytes without dots or control characters", longest));
  const auto found = std::find(groups.begin(), groups.end(), name);
  const auto number = static_cast<std::size_t>(found - groups.begin());
  if (found == groups.end()) {
    if (number > std::numeric_limits<std::uint16_t>::max()) owner.fail("expected at most 65536 light groups");
    groups.push_back(name);
  }
  return static_cast<std::uint16_t>(number);
}

Curve<1> read_number_curve(const JsonValue& json, double low, double high) {
  return read_curve<1>(json,
                       [&](const JsonValue& value) { return Curve<1>::Value{value.number(low, high)}; });
}

Curve<3> read_triple_curve(const JsonValue& json, double low, double high) {
  return read_curve<3>(json, [&](const JsonValue& value) { return value.triple(low, high); });
}

}  // namespace becalm::tracer
