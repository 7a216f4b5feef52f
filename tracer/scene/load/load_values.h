#pragma once

#include <fmt/format.h>

#include <limits>
#include <map>
#include <string>

#include "tracer/math/keyframes.h"
#include "tracer/math/vec.h"
#include "tracer/scene/load/json_reader.h"

// What the readers of the scene file's sections share.

namespace becalm::tracer {

inline constexpr double kLargestNumber = std::numeric_limits<float>::max();
/// Of places: rays of larger ones are not finite to Embree.
inline constexpr double kLargestCoordinate = 1e17;

V3f to_v3f(const std::array<double, 3>& v);

/// [r, g, b] or one number, each in [0, high].
V3f read_color(const JsonValue& json, double high);

/// A path in the scene file, which is relative to that file.
std::string beside(const std::string& scene_file, const std::string& path);

/// Throws at the value that names the file if it is not there.
void expect_file(const JsonValue& json, const std::string& path);

/// The numbers of things by their names in the file.
using Names = std::map<std::string, std::uint32_t, std::less<>>;

/// The number of what `json` names; `what` says in the message what was expected.
std::uint32_t read_reference(const JsonValue& json, const Names& names, const char* what);

/// {"interpolation": ..., "keys": [{"frame": ..., ...}, ...]}, each key's values read by `read_value`.
template <std::size_t N, class ReadValue>
Curve<N> read_keys(const JsonValue& json, const ReadValue& read_value) {
  json.allow_keys({"interpolation", "keys"});
  Interpolation interpolation = Interpolation::linear;
  if (const auto value = json.find("interpolation")) {
    interpolation = static_cast<Interpolation>(value->choice({"linear", "smooth"}));
  }
  std::vector<typename Curve<N>::Key> keys;
  for (const JsonValue& element : json.at("keys").elements()) {
    const typename Curve<N>::Key key{element.at("frame").number(), read_value(element)};
    if (!keys.empty() && key.frame <= keys.back().frame) {
      element.at("frame").fail(
          fmt::format("expected a frame after the key before, {}, found {}", keys.back().frame, key.frame));
    }
    keys.push_back(key);
  }
  if (keys.empty()) json.at("keys").fail("expected at least one key");
  return {std::move(keys), interpolation};
}

/// A value, or {"keys": [{"frame": ..., "value": ...}, ...]}, each read by `read_value`.
template <std::size_t N, class ReadValue>
Curve<N> read_curve(const JsonValue& json, const ReadValue& read_value) {
  if (!json.is_object()) return read_value(json);
  return read_keys<N>(json, [&](const JsonValue& key) {
    key.allow_keys({"frame", "value"});
    return read_value(key.at("value"));
  });
}

/// The number of the light group that `owner` names by "group", "default" without one; new names are added.
std::uint16_t read_light_group(const JsonValue& owner, std::vector<std::string>& groups);

/// One number in [low, high] over time.
Curve<1> read_number_curve(const JsonValue& json, double low, double high);

/// Three numbers, or one for all, in [low, high] over time.
Curve<3> read_triple_curve(const JsonValue& json, double low, double high);

}  // namespace becalm::tracer
