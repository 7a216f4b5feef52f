#include "filter/input/noisy_inputs.h"

#include "filter/input/estimate_variance.h"
#include "filter/input/host_images.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

using gpu::Format;

NoisyInputs::NoisyInputs(gpu::Chain& chain, const FilterTask& task, gpu::Extent extent, NoisyUse use)
    : has_albedo(contains(task.used, Aov::albedo)),
      has_depth(contains(task.used, Aov::depth)),
      has_normal(contains(task.used, Aov::normal)) {
  exposure = chain.table("exposure", Format::f32, {1, 1});
  if (use == NoisyUse::merge && task.smooths() && !task.smooths_merged()) return;
  given_variance_ = chain.input("variance.cur", Format::f32x2, extent);
  own_color = color = chain.input("color.cur", Format::f32x4, extent);
  takes_noise_ = use == NoisyUse::merge && task.hands_noise_on();
  // The albedo network is given no noise: of its variance only the valid flag is read.
  const bool estimates = !task.variance_known() && !task.of_albedo && !takes_noise_;
  if (use == NoisyUse::smooth || (estimates && has_albedo) || task.smooths_merged()) {
    features = {.albedo_depth = chain.input("albedo_depth", Format::f32x4, extent),
                .normal = chain.input("normal", Format::f32x4, extent)};
    own_features = features;
  }
  if (task.merged) {
    own_color = chain.input("own.color", Format::f32x4, extent);
    own_features = {.albedo_depth = chain.input("own.albedo_depth", Format::f32x4, extent),
                    .normal = chain.input("own.normal", Format::f32x4, extent)};
  }
  if (!estimates) {
    variance = given_variance_;
  } else {
    noise_ratio_ = chain.table("noise_ratio", Format::f32, {1, 1});
    FrameWithoutVariance frame{.color = color,
                               .valid = given_variance_,
                               .exposure = exposure,
                               .noise_ratio = *noise_ratio_,
                               .features = {}};
    if (has_albedo) frame.features = features;
    variance = add_variance_estimate(chain, extent, frame);
  }
}

void NoisyInputs::upload(gpu::Chain& chain, const FilterTask& task, const NewFrame& frame, const Tile& tile,
                         FrameReport& report) const {
  const bool reads_exposure_alone = color == gpu::ImageId();
  const std::span<float> pairs =
      reads_exposure_alone ? std::span<float>() : chain.upload<float>(given_variance_);
  if (takes_noise_) {
    filter::upload(chain, given_variance_, view(frame.smoothed.noise), tile.target);
  } else {
    report.replaced_variances += pack_variance(frame.frame, task.used, frame.finite, tile, pairs);
  }
  chain.upload<float>(exposure)[0] = frame.exposure;
  if (noise_ratio_) chain.upload<float>(*noise_ratio_)[0] = frame.noise_ratio;
  if (reads_exposure_alone) return;
  pack_color(frame.frame.image(Aov::beauty), frame.finite, tile.target, chain.upload<float>(color));
  const auto upload_features = [&](const NewFrame& source, const SurfaceImages& target) {
    pack_features(source, task.used, tile.target, chain.upload<float>(target.albedo_depth),
                  chain.upload<float>(target.normal));
  };
  if (features) upload_features(frame, *features);
  if (task.merged) {
    pack_color(frame.own->frame.image(Aov::beauty), frame.finite, tile.target,
               chain.upload<float>(own_color));
    upload_features(*frame.own, *own_features);
  }
}

}  // namespace becalm::filter
