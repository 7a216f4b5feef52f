#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/estimate.h"
#include "filter/tiles/tiles.h"
#include "frame/frame.h"

namespace becalm::filter {

/// Conversion between a Frame, or a rectangle of it, and the buffers of a chain. Non-finite input follows one
/// rule: the pixel is counted, takes no part in any decision, and is output unchanged.

/// One entry per pixel: 1 if all channels of the beauty are finite, else 0.
std::vector<std::uint8_t> finite_pixels(const Image& beauty);
/// Number of the frame's pixels that are not finite, without those outside of its cut (Frame::cut).
std::size_t count_non_finite(const std::vector<std::uint8_t>& finite, const Frame& frame);

/// How many of the frame's pixels have a value in one of the guides of `used` (albedo, normal, depth) that is
/// not finite, but for the infinite depth of what hit nothing.
std::size_t count_non_finite_guides(const Frame& frame, const AovSet& used);

/// Packs a rectangle of the beauty as RGBA. A non-finite pixel becomes the mean of its finite neighbours (0
/// if it has none), so that matching finds no hole there.
void pack_color(const Image& beauty, std::span<const std::uint8_t> finite, const Rect& rect,
                std::span<float> rgba);

/// Packs a rectangle of the albedo as RGB and a 0, clamped to [0,1]. A non-finite pixel becomes the mean of
/// its finite neighbours (1 if it has none), since radiance is divided and multiplied by it.
void pack_albedo(const Image& albedo, const Rect& rect, std::span<float> rgba);

/// Packs (variance, valid) pairs of a tile's target rectangle. The variance is the mean over channels of the
/// `variance` AOV, or of ((a-b)/2)^2 for two half-buffers; 0 if neither is in `used`. A variance that is
/// negative or not finite is replaced by the pixel's squared luminance (100 % noise). Returns the number of
/// replaced variances in the tile's core. Only counts if `pairs` is empty.
std::size_t pack_variance(const Frame& frame, const AovSet& used, std::span<const std::uint8_t> finite,
                          const Tile& tile, std::span<float> pairs);

/// The typical depth of a frame, relative to which depths are packed: the geometric mean of the finite,
/// positive depths; 1 if there are none or depth is not in `used`.
float typical_depth(const Frame& frame, const AovSet& used);

/// Packs the features of a rectangle: (albedo, depth) and (normal, 0). The albedo is that of pack_albedo, or
/// 1 if it is not in `used`. The depth z is packed as 2 z / (z + usual_depth), infinity as 2. A depth that is
/// NaN or not positive and a non-finite normal component become 0, as do AOVs that are not in `used`.
void pack_features(const NewFrame& frame, const AovSet& used, const Rect& rect, std::span<float> albedo_depth,
                   std::span<float> normal);

/// Number of guide planes of a frame with these AOVs: one for albedo, two for normal.
int guide_planes(bool albedo, bool normal);

/// Packs the guide planes of a rectangle: the albedo's luminance, then the normal's components along two axes
/// perpendicular to (1,1,1) (a unit vector has two degrees of freedom). An image that is null has no planes.
/// Non-finite values become 0. Albedo is clamped to [0,1].
void pack_guide(const Image* albedo, const Image* normal, const Rect& rect, std::span<float> planes);

/// Packs a rectangle of the motion AOV as offset pairs. A pixel is marked as having no motion
/// (is_known_motion of shaders/lib/motion.glsl) if its motion is not finite, which is how files mask it, or
/// if a component exceeds the limit (motion_limit_px).
void pack_motion(const Image& motion, const Rect& rect, float limit_px, std::span<float> pairs);

/// Number of pixels with a finite motion that has a component beyond the limit.
std::size_t count_far_motions(const Image& motion, float limit_px);

/// The factor that brings a frame into a known range: 1 / geometric mean of the finite luminances of at least
/// a millionth of their arithmetic mean over all pixels, within [1e-15, 1e15]; 1 for a black frame. Fainter
/// luminances, traces of light on black, would dominate the geometric mean. In the arithmetic mean, fireflies
/// are limited to about 2^20 times the largest usual luminance (Exponents::largest_usual).
float exposure(const Image& beauty);

}  // namespace becalm::filter
