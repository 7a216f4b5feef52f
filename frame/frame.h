#pragma once

#include <Imath/ImathBox.h>

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "frame/aov.h"
#include "frame/image.h"
#include "frame/jitter.h"
#include "frame/scale.h"
#include "frame/stereo.h"

namespace becalm {

/// Radiance that one group of lights sends to the eye; all groups of a frame add up to the beauty.
struct LightGroup {
  std::string name;
  Image radiance;  ///< RGB
};

/// A data window that cuts through opaque content. Radiance outside of it is unknown beside opaque pixels:
/// `unknown_pixels` pixels are NaN there, and do not count as faulty.
struct Cut {
  Imath::Box2i window;  ///< in the frame's pixels
  std::size_t unknown_pixels = 0;
};

/// One frame of an animation: the beauty and whichever AOVs were asked for or found, all of one size. This,
/// or an EXR file of it, is all that passes between the tracer and the filter.
class Frame {
 public:
  Frame() = default;
  Frame(int number, int width, int height) : number_(number), width_(width), height_(height) {}

  int number() const { return number_; }
  int width() const { return width_; }
  int height() const { return height_; }

  bool has(Aov aov) const { return !image(aov).empty(); }
  AovSet aovs() const {
    AovSet present;
    for (const AovInfo& entry : kAovTable) present.set(static_cast<std::size_t>(entry.aov), has(entry.aov));
    return present;
  }

  /// Adds (or clears) an image of the frame's size with the AOV's channels, every value `fill`.
  Image& add(Aov aov, float fill = 0.0f) {
    return image(aov) = Image(width_, height_, channel_count(aov), fill);
  }
  /// The same, for pixels that are all written next.
  Image& add(Aov aov, Unfilled) {
    return image(aov) = Image(width_, height_, channel_count(aov), Unfilled{});
  }
  void remove(Aov aov) { image(aov) = Image(); }

  /// The AOV's image; empty if the frame does not have it.
  Image& image(Aov aov) { return images_[static_cast<std::size_t>(aov)]; }
  const Image& image(Aov aov) const { return images_[static_cast<std::size_t>(aov)]; }

  /// Set if all pixels have their samples at the same positions.
  const std::optional<FrameJitter>& jitter() const { return jitter_; }
  void set_jitter(std::optional<FrameJitter> jitter) { jitter_ = std::move(jitter); }

  /// Set if the frame is of one eye of a pair whose cameras are known.
  const std::optional<StereoView>& stereo() const { return stereo_; }
  void set_stereo(const std::optional<StereoView>& stereo) { stereo_ = stereo; }

  /// Set if only these pixels hold samples; the others are as AOVs are where nothing is hit.
  const std::optional<Parity>& checkerboard() const { return checkerboard_; }
  void set_checkerboard(std::optional<Parity> parity) { checkerboard_ = parity; }

  const std::optional<Cut>& cut() const { return cut_; }
  void set_cut(const std::optional<Cut>& cut) { cut_ = cut; }

  /// Empty unless asked for.
  std::vector<LightGroup>& light_groups() { return light_groups_; }
  const std::vector<LightGroup>& light_groups() const { return light_groups_; }

 private:
  int number_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::array<Image, kAovCount> images_;
  std::vector<LightGroup> light_groups_;
  std::optional<FrameJitter> jitter_;
  std::optional<StereoView> stereo_;
  std::optional<Parity> checkerboard_;
  std::optional<Cut> cut_;
};

}  // namespace becalm
