#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <optional>
#include <string_view>

namespace becalm {

/// Every image that a Frame may carry. The table below gives its channels and meaning.
enum class Aov {
  beauty,
  variance,
  albedo,
  normal,
  depth,
  motion,
  half_a,
  half_b,
  direct,
  indirect,
  object_id,
  material_id,
  flow,
  error_mask,
  sample_count,
  bias,
  gain,
  stereo_weight,
  residual,
  remaining_variance,
  accumulated,
  accumulated_variance,
  accumulated_albedo,
  accumulated_normal,
  accumulated_depth,
};
inline constexpr std::size_t kAovCount = static_cast<std::size_t>(Aov::accumulated_depth) + 1;

using AovSet = std::bitset<kAovCount>;

struct AovInfo {
  Aov aov;
  std::string_view name;         ///< layer name in files and on the command line; empty for the bare beauty
  std::string_view channels;     ///< one letter a channel, in memory order
  bool diagnostic;               ///< written by the filter, not by the tracer
  std::string_view description;  ///< meaning and unit
};

/// The AOV table: the contract between the tracer, the filter and the files.
inline constexpr std::array<AovInfo, kAovCount> kAovTable{{
    {Aov::beauty, "", "RGBA", false,
     "radiance; A is coverage, 0 where nothing is hit and there is no environment"},
    {Aov::variance, "variance", "RGB", false,
     "variance of the pixel's mean, with the beauty's filter weights"},
    {Aov::albedo, "albedo", "RGB", false,
     "reflectance of the first non-specular hit, in [0,1]; 1 where nothing is hit"},
    {Aov::normal, "normal", "XYZ", false, "world-space normal of the albedo's hit; 0 where nothing is hit"},
    {Aov::depth, "depth", "Z", false,
     "distance along the primary ray in scene units; +inf where nothing is hit"},
    {Aov::motion, "motion", "XY", false,
     "offset_cur_to_prev_px: add to a pixel's position to find the point in the previous frame"},
    {Aov::half_a, "half_a", "RGB", false, "beauty of the first of two disjoint halves of the samples"},
    {Aov::half_b, "half_b", "RGB", false, "beauty of the second half of the samples"},
    {Aov::direct, "direct", "RGB", false,
     "radiance of light that scattered at most once on its way to the eye, mirrors and glass not counted"},
    {Aov::indirect, "indirect", "RGB", false, "the rest of the beauty"},
    {Aov::object_id, "object_id", "Y", false,
     "number of the scene's object that most samples hit, from 1; 0 where nothing is hit"},
    {Aov::material_id, "material_id", "Y", false, "the same of the material"},
    {Aov::flow, "flow", "XY", true,
     "offset into the history that the aligner found, in pixels; +x right, +y down"},
    {Aov::error_mask, "error_mask", "Y", true, "share of the history that the merge rejected, in [0,1]"},
    {Aov::sample_count, "sample_count", "Y", true, "effective number of frames merged into the pixel"},
    {Aov::bias, "bias", "Y", true,
     "root of the squared bias that the merge ascribed to the history, in units of radiance"},
    {Aov::gain, "gain", "Y", true, "weight of the new sample in the pixel, in [0,1]"},
    {Aov::stereo_weight, "stereo_weight", "Y", true, "weight of the other eye in the pixel, in [0,1]"},
    {Aov::residual, "residual", "Y", true,
     "patch distance at the offset, less that of equal pixels, of the finest level that was matched"},
    {Aov::remaining_variance, "remaining_variance", "Y", true,
     "squared error that the filter expects of the result, averaged over channels"},
    {Aov::accumulated, "accumulated", "RGB", true,
     "noisy frames merged, as the last smoothing sees them, if there is one"},
    {Aov::accumulated_variance, "accumulated_variance", "Y", true, "variance of that"},
    {Aov::accumulated_albedo, "accumulated_albedo", "RGB", true, "albedo merged alike"},
    {Aov::accumulated_normal, "accumulated_normal", "XYZ", true, "normal merged alike"},
    {Aov::accumulated_depth, "accumulated_depth", "Y", true,
     "depth merged alike, as 2 z / (z + the frame's typical depth)"},
}};

constexpr const AovInfo& info(Aov aov) {
  return kAovTable[static_cast<std::size_t>(aov)];
}
constexpr int channel_count(Aov aov) {
  return static_cast<int>(info(aov).channels.size());
}

constexpr bool contains(const AovSet& set, Aov aov) {
  return set[static_cast<std::size_t>(aov)];
}

/// The AOV of that table name ("beauty" for the bare one), or nothing.
constexpr std::optional<Aov> find_aov(std::string_view name) {
  if (name == "beauty") return Aov::beauty;
  for (const AovInfo& entry : kAovTable) {
    if (entry.name == name && !entry.name.empty()) return entry.aov;
  }
  return std::nullopt;
}

}  // namespace becalm
