#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frame/frame.h"

namespace becalm::audit {

/// What in the input would silently spoil the denoised result.
struct Finding {
  std::string check;  ///< a name for scripts, such as `fixed_noise`
  std::string text;   ///< one sentence with a figure and what to do
};

/// A frame and, where there is one, the frame before it.
struct Subject {
  const Frame& frame;
  const Frame* before = nullptr;

  /// Both frames' images of an AOV, if both have it and they are of one size.
  bool has_pair(Aov aov) const {
    return before != nullptr && frame.has(aov) && frame.image(aov).same_shape(before->image(aov));
  }
};

/// Every check below, in its order, on one frame.
std::vector<Finding> audit(const Subject& subject);

// One check a file. Each returns nothing where the frame lacks what it looks at.

/// The beauty is that of the frame before, bit for bit, and not black.
std::optional<Finding> check_duplicate(const Subject& subject);
/// Noise stays where it was: the frames were rendered with one seed.
std::optional<Finding> check_fixed_noise(const Subject& subject);
/// There is next to no noise.
std::optional<Finding> check_denoised(const Subject& subject);
/// Bright samples were cut off at one value.
std::optional<Finding> check_clamped(const Subject& subject);
/// NaN in the beauty or a feature.
std::optional<Finding> check_not_a_number(const Subject& subject);
/// Values at the end of half's range or beyond it.
std::optional<Finding> check_overflow(const Subject& subject);
/// Single pixels hold much of the light.
std::optional<Finding> check_fireflies(const Subject& subject);
/// There is colour where alpha is 0.
std::optional<Finding> check_premultiplied(const Subject& subject);
/// Reflectance above 1.
std::optional<Finding> check_albedo(const Subject& subject);
/// The albedo's edges are the beauty's once it is turned upside down or mirrored.
std::optional<Finding> check_albedo_flipped(const Subject& subject);
/// Normals that are not of unit length.
std::optional<Finding> check_normal_length(const Subject& subject);
/// Normals that all face along Z, as in view space.
std::optional<Finding> check_normal_space(const Subject& subject);
/// The frame before is found better along vectors of another sign, order or scale.
std::optional<Finding> check_motion(const Subject& subject);
/// Both halves have the same noise.
std::optional<Finding> check_same_halves(const Subject& subject);
/// The variance is not what the halves, or else two frames, show.
std::optional<Finding> check_variance(const Subject& subject);

}  // namespace becalm::audit
