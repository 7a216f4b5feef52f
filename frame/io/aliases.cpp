#include "frame/io/aliases.h"

#include <algorithm>

namespace becalm::io {
namespace {

/// Position in the previous frame - position in this one, y counted upwards.
constexpr std::array<float, 2> kBackwardYUp{1.0f, -1.0f};
/// Position in the next frame - position in this one: the opposite, as far as motion is even.
constexpr std::array<float, 2> kForward{-1.0f, -1.0f};
constexpr std::array<float, 2> kForwardYUp{-1.0f, 1.0f};

constexpr Alias kAliases[] = {
    {.aov = Aov::beauty, .layer = ""},
    {.aov = Aov::beauty, .layer = "combined"},
    {.aov = Aov::beauty, .layer = "noisy image"},
    {.aov = Aov::beauty, .layer = "rgba"},
    {.aov = Aov::beauty, .layer = "beauty"},
    {.aov = Aov::beauty, .layer = "beauty_noisy"},
    {.aov = Aov::beauty, .layer = "ci"},
    {.aov = Aov::beauty, .layer = "<root>"},
    {.aov = Aov::beauty, .layer = "rgb_color"},
    {.aov = Aov::beauty, .layer = "rgb"},
    {.aov = Aov::beauty, .layer = "image"},  // of Blender's File Output node
    {.aov = Aov::beauty, .layer = "c"},      // Karma's
    {.aov = Aov::beauty, .layer = "finalimage"},
    {.aov = Aov::variance, .layer = "variance"},
    {.aov = Aov::variance, .layer = "mse"},
    {.aov = Aov::variance, .layer = "noiselevel", .standard_deviation = true},
    {.aov = Aov::albedo, .layer = "denoising albedo"},
    {.aov = Aov::albedo, .layer = "denoise_albedo"},
    {.aov = Aov::albedo, .layer = "rgba_denoise_albedo"},
    {.aov = Aov::albedo, .layer = "denoise_albedo_noisy"},
    {.aov = Aov::albedo, .layer = "albedo"},
    {.aov = Aov::albedo, .layer = "diffuse_albedo"},
    {.aov = Aov::albedo, .layer = "alb"},
    {.aov = Aov::albedo, .layer = "diffusefilter"},
    {.aov = Aov::albedo, .layer = "basecolor"},
    // Elsewhere this is light, such as Arnold's and RenderMan's.
    {.aov = Aov::albedo, .layer = "diffuse", .vray_only = true},
    {.aov = Aov::normal, .layer = "denoising normal"},
    {.aov = Aov::normal, .layer = "n_denoise"},
    {.aov = Aov::normal, .layer = "normal"},
    {.aov = Aov::normal, .layer = "normals"},
    {.aov = Aov::normal, .layer = "bumpnormals"},
    {.aov = Aov::normal, .layer = "bump_normals"},
    {.aov = Aov::normal, .layer = "sh_normal"},
    {.aov = Aov::normal, .layer = "avg_shading_normal"},  // LuxCore's
    {.aov = Aov::normal, .layer = "shading_normal"},
    {.aov = Aov::normal, .layer = "ns"},
    {.aov = Aov::normal, .layer = "n"},
    {.aov = Aov::normal, .layer = "geo_normal"},
    {.aov = Aov::normal, .layer = "nrm"},
    {.aov = Aov::depth, .layer = "depth"},
    {.aov = Aov::depth, .layer = "denoising depth"},
    {.aov = Aov::depth, .layer = "zdepth"},
    {.aov = Aov::depth, .layer = "z"},
    {.aov = Aov::depth, .layer = "zfiltered"},
    {.aov = Aov::depth, .layer = ""},
    {.aov = Aov::motion, .layer = "motion"},
    {.aov = Aov::motion, .layer = "vector", .scale = kBackwardYUp},
    {.aov = Aov::motion, .layer = "motionvector", .scale = kForwardYUp},
    {.aov = Aov::motion, .layer = "velocity", .scale = kForwardYUp},
    {.aov = Aov::motion, .layer = "backward"},
    {.aov = Aov::motion, .layer = "forward", .scale = kForward},
    {.aov = Aov::half_a, .layer = "half_a"},
    {.aov = Aov::half_b, .layer = "half_b"},
    {.aov = Aov::direct, .layer = "direct"},
    {.aov = Aov::indirect, .layer = "indirect"},
    {.aov = Aov::object_id, .layer = "object_id"},
    {.aov = Aov::material_id, .layer = "material_id"},
    {.aov = Aov::flow, .layer = "flow"},
    {.aov = Aov::error_mask, .layer = "error_mask"},
    {.aov = Aov::sample_count, .layer = "sample_count"},
    {.aov = Aov::bias, .layer = "bias"},
    {.aov = Aov::gain, .layer = "gain"},
    {.aov = Aov::stereo_weight, .layer = "stereo_weight"},
    {.aov = Aov::residual, .layer = "residual"},
    {.aov = Aov::remaining_variance, .layer = "remaining_variance"},
    {.aov = Aov::accumulated, .layer = "accumulated"},
    {.aov = Aov::accumulated_variance, .layer = "accumulated_variance"},
    {.aov = Aov::accumulated_albedo, .layer = "accumulated_albedo"},
    {.aov = Aov::accumulated_normal, .layer = "accumulated_normal"},
    {.aov = Aov::accumulated_depth, .layer = "accumulated_depth"},
};

constexpr std::string_view kVrayPrefix = "vray";
constexpr std::string_view kVraysNames[] = {"noiselevel", "bump_normals",  "rawlight",  "rawgi",
                                            "matteid",    "defocusamount", "rawshadow", "reflectionfilter"};
constexpr std::string_view kNamesOfVrayAndOthers[] = {"zdepth", "normals",  "bumpnormals",
                                                      "gi",     "lighting", "selfillum"};

}  // namespace

std::span<const Alias> aliases() {
  return kAliases;
}

std::optional<std::string_view> scope_before(std::string_view layer, std::string_view alias) {
  if (layer == alias) return "";
  if (alias.empty() || !layer.ends_with(alias)) return std::nullopt;
  std::string_view before = layer.substr(0, layer.size() - alias.size());
  if (before.ends_with(kVrayPrefix)) before.remove_suffix(kVrayPrefix.size());
  if (before.empty()) return "";
  if (before.size() < 2 || before.back() != '.') return std::nullopt;
  return before.substr(0, before.size() - 1);
}

bool names_an_aov(std::string_view layer) {
  return std::ranges::any_of(kAliases, [&](const Alias& alias) {
    return alias.aov != Aov::beauty && !alias.layer.empty() && scope_before(layer, alias.layer).has_value();
  });
}

std::string_view without_vray(std::string_view layer) {
  if (layer.starts_with(kVrayPrefix)) layer.remove_prefix(kVrayPrefix.size());
  return layer;
}

int evidence_of_vray(std::string_view layer) {
  const auto is_among = [&](const auto& names) { return std::ranges::find(names, layer) != std::end(names); };
  if (layer.starts_with(kVrayPrefix) || is_among(kVraysNames)) return kVraysEvidence;
  return is_among(kNamesOfVrayAndOthers) ? 1 : 0;
}

}  // namespace becalm::io
