#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/tiles/tiles.h"
#include "frame/frame.h"

namespace becalm::filter {

/// What lies between a Frame, or a rectangle of it, and the buffers of the GPU chain, all plain loops over
/// pixels. Non-finite input follows one rule: such a pixel is counted, takes no part in any decision, and
/// comes out as it went in.

/// Variances are limited to this, so that sums of them stay within the range of floats; as in
/// shaders/lib/gain.glsl.
constexpr float kLargestVariance = 1e34f;

/// One entry a pixel: 1 where all channels of the beauty are finite, else 0.
std::vector<std::uint8_t> finite_pixels(const Image& beauty);

/// A rectangle of the beauty as RGBA; a pixel that is not finite becomes the mean of its finite neighbours (0
/// without any), so that matching sees no hole there.
void pack_color(const Image& beauty, std::span<const std::uint8_t> finite, const Rect& rect,
                std::span<float> rgba);

/// A rectangle of the albedo as RGB and a 0, clamped to [0,1]. A pixel that is not finite becomes the mean of
/// its finite neighbours, 1 without any: its radiance is divided by what the next frame's is multiplied by.
void pack_albedo(const Image& albedo, const Rect& rect, std::span<float> rgba);

/// (variance, valid) pairs of a tile's target rectangle. The variance is the mean over channels of the
/// `variance` AOV, or of ((a-b)/2)^2 for two half-buffers; 0 where neither is in `used`. A variance that is
/// not finite or negative is replaced by the square of the pixel's luminance: 100 % of noise. Returns how
/// many of the tile's core were.
std::size_t pack_variance(const Frame& frame, const AovSet& used, std::span<const std::uint8_t> finite,
                          const Tile& tile, std::span<float> pairs);

/// The usual depth of a frame, by which depths are made relative: the geometric mean of those that are finite
/// and positive; 1 without any, or if depth is not in `used`.
float typical_depth(const Frame& frame, const AovSet& used);

/// Features of a rectangle: (albedo, depth) with the albedo of pack_albedo, 1 if it is not in `used`, and the
/// depth z as 2 z / (z + usual); and (normal, 0). Another AOV that is not in `used` is 0; so are values of it
/// that are not finite.
void pack_features(const Frame& frame, const AovSet& used, float usual_depth, const Rect& rect,
                   std::span<float> albedo_depth, std::span<float> normal);

/// Number of guide planes that a frame with these AOVs gives: albedo one, normal two.
int guide_planes(bool albedo, bool normal);

/// Guide planes of a rectangle: the albedo's luminance, then the normal's components along two axes of no
/// special direction in the scene (a unit vector has two degrees of freedom). Values that are not finite
/// become 0. Albedo is clamped to [0,1].
void pack_guide(const Frame& frame, bool albedo, bool normal, const Rect& rect, std::span<float> planes);

/// A rectangle of the motion AOV as offset pairs. A pixel has none (shaders/lib/motion.glsl) where its motion
/// is not finite, which is how a file masks it, or where a component exceeds the limit (motion_limit_px).
void pack_motion(const Image& motion, const Rect& rect, float limit_px, std::span<float> pairs);

/// How many pixels have a finite motion of which a component exceeds the limit.
std::size_t count_far_motions(const Image& motion, float limit_px);

/// 1 / geometric mean of the finite luminances above a millionth of their mean (traces of light on black
/// would decide it otherwise); 1 for a black frame. It brings the frame into a known range.
float exposure(const Image& beauty);

}  // namespace becalm::filter
