#include "frame/io/part_names.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "frame/io/additive_layers.h"

namespace becalm::io {
namespace {

/// Names of parts whose bare channels look like colours and are none; and of those that are seldom a beauty.
/// Only the letters of the last of a name's parts between dots count.
constexpr std::string_view kNoColours[] = {"position", "worldposition", "p",      "pworld", "pref",
                                           "uv",       "indexob",       "indexma"};
constexpr std::string_view kBearersOfIds[] = {"",         "object", "obj",   "material", "mat",
                                              "instance", "node",   "shape", "primitive"};
constexpr std::string_view kSeldomBeauties[] = {"ao",
                                                "occlusion",
                                                "shadow",
                                                "shadows",
                                                "mask",
                                                "matte",
                                                "mist",
                                                "denoised",
                                                "vraydenoiser",
                                                "rgbadenoise",
                                                "effectsresult",
                                                "glossyreflection",
                                                "beautyunshadowed"};
/// Karma's lobes are one of the first before one of the second.
constexpr std::string_view kKarmasPaths[] = {"combined", "direct", "indirect"};
constexpr std::string_view kKarmasLobes[] = {
    "diffuse", "glossyreflection", "glossytransmission", "coat", "emission", "volume", "sss", "lighting"};

/// Of a name in lower case.
std::string letters_of(std::string_view part) {
  if (const auto dot = part.rfind('.'); dot != std::string_view::npos) part.remove_prefix(dot + 1);
  std::string letters;
  std::ranges::copy_if(part, std::back_inserter(letters), [](char c) { return c >= 'a' && c <= 'z'; });
  return letters;
}

bool is_among(std::string_view name, const auto& names) {
  return std::ranges::find(names, name) != std::ranges::end(names);
}

}  // namespace

bool is_seldom_beauty(std::string_view part) {
  const std::string name = letters_of(part);
  const bool is_lobe = std::ranges::any_of(kKarmasPaths, [&](std::string_view path) {
    return name.starts_with(path) && is_among(std::string_view(name).substr(path.size()), kKarmasLobes);
  });
  return is_lobe || names_a_summand(part) || part.starts_with(kLightScope) || is_among(name, kSeldomBeauties);
}

bool is_no_colour(std::string_view part) {
  const std::string name = letters_of(part);
  const bool is_id =
      name.ends_with("id") && is_among(std::string_view(name).substr(0, name.size() - 2), kBearersOfIds);
  const bool is_matte = name.starts_with("puzzlematte") || name.starts_with("multimatte");
  return is_id || is_matte || name.find("crypto") != std::string::npos || is_among(name, kNoColours);
}

}  // namespace becalm::io
