#include "filter/smooth/detail_share.h"

#include <optional>
#include <string>

#include "filter/merge/patch_sums.h"

namespace becalm::filter {

using gpu::Format;
using gpu::ImageId;

namespace {

/// Radius of the patches over which the difference of a frame and its result is averaged.
constexpr int kLostRadius = 7;

}  // namespace

DetailShare add_detail_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame, ImageId color,
                             ImageId stats) {
  const SurfaceImages& features = *frame.own_features;
  const bool separate = frame.has_depth || frame.has_normal;
  const auto image = [&](const std::string& name) { return chain.image(name, Format::f32x4, full); };
  const auto sums = [&](ImageId statistics, const std::string& name) {
    return add_box_sums(chain, kLostRadius, full, statistics, name);
  };

  const ImageId lost = image("detail.lost");
  const std::optional<ImageId> background =
      separate ? std::optional(image("detail.lost_background")) : std::nullopt;
  chain.pass("smooth/lost")
      .read("color", frame.color)
      .read("variance", frame.variance)
      .read("smoothed", color)
      .read("exposure", frame.exposure)
      .read("albedo_depth", features.albedo_depth)
      .read("normal", features.normal)
      .write("lost", lost)
      .write("lost_background", background)
      .specialize("separate", separate ? 1 : 0)
      .specialize("has_normal", frame.has_normal ? 1 : 0)
      .dispatch(full);

  const ImageId lost_sums = sums(lost, "detail.lost");
  std::optional<ImageId> background_sums;
  if (background) background_sums = sums(*background, "detail.lost_background");
  const DetailShare detail{.share = chain.image("detail.share", Format::f32x2, full),
                           .stats = chain.image("detail.stats", Format::f32x2, full)};
  chain.pass("smooth/share")
      .read("lost", lost)
      .read("lost_sums", lost_sums)
      .read("lost_background", background)
      .read("lost_background_sums", background_sums)
      .read("variance", frame.variance)
      .read("expected", stats)
      .read("albedo_depth", features.albedo_depth)
      .read("normal", features.normal)
      .write("share", detail.share)
      .write("stats", detail.stats)
      .specialize("separate", separate ? 1 : 0)
      .specialize("has_normal", frame.has_normal ? 1 : 0)
      .dispatch(full);
  return detail;
}

}  // namespace becalm::filter
