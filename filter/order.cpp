#include "filter/order.h"

#include <algorithm>
#include <optional>

#include "filter/align.h"
#include "filter/frame_check.h"
#include "filter/guides.h"
#include "filter/host_images.h"
#include "filter/merge.h"

namespace becalm::filter {
namespace {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

}  // namespace

AovSet wanted_aovs(const Settings& settings) {
  AovSet wanted;
  const auto want = [&](Aov aov, bool needed) { wanted.set(static_cast<std::size_t>(aov), needed); };
  want(Aov::albedo, settings.weight_albedo > 0.0f);
  want(Aov::normal, settings.weight_normal > 0.0f);
  for (const Aov aov : {Aov::variance, Aov::half_a, Aov::half_b}) want(aov, true);
  return wanted;
}

struct ForwardFilter::State {
  State(gpu::Device& device, const Settings& settings_, int width, int height, AovSet available,
        AovSet diagnostics_)
      : settings(settings_), full{width, height}, diagnostics(diagnostics_), chain(device, "filter") {
    used = available & wanted_aovs(settings);
    guides = guides_of(settings, used);
    color = chain.input("color.cur", Format::f32x4, full);
    exposure_image = chain.input("exposure", Format::f32, {1, 1});
    variance = chain.input("variance.cur", Format::f32x2, full);
    const gpu::History history_color = chain.history("history.color", Format::f32x4, full);
    const gpu::History history_stats = chain.history("history.stats", Format::f32x2, full);

    FeatureSources target{
        .color = color, .exposure = exposure_image, .guide_features = {}, .guide_planes = 0};
    FeatureSources source{
        .color = history_color.previous, .exposure = exposure_image, .guide_features = {}, .guide_planes = 0};
    if (const int planes = guides.planes(); planes > 0) {
      guide = chain.input("guide.cur", Format::f32, {width, height, planes});
      Extent extent = pyramid_extents(settings, width, height).front();
      extent.planes = planes;
      const gpu::History features = chain.history("guide.features", Format::f32, extent);
      add_guide_passes(chain, settings, full, *guide, guides.weights, features.next);
      target.guide_features = features.next;
      source.guide_features = features.previous;
      target.guide_planes = source.guide_planes = planes;
    }
    const Alignment alignment =
        add_align_passes(chain, settings, full, add_feature_passes(chain, settings, full, "target", target),
                         add_feature_passes(chain, settings, full, "source", source));
    offset = alignment.offset;

    const bool variance_known =
        contains(used, Aov::variance) || (contains(used, Aov::half_a) && contains(used, Aov::half_b));
    decision = add_merge_passes(
        chain, settings, full,
        {.color = color,
         .variance = variance_known ? variance : add_variance_estimate(chain, full, color, variance),
         .exposure = exposure_image,
         .history_color = history_color,
         .history_stats = history_stats},
        alignment);
    merged_color = history_color.next;
    merged_stats = history_stats.next;
    chain.output(merged_color);
    chain.output(merged_stats);
    chain.output(decision);
    if (contains(diagnostics, Aov::flow)) chain.output(offset);
    chain.build();
  }

  Settings settings;
  Extent full;
  AovSet diagnostics;
  AovSet used;
  Guides guides;
  gpu::Chain chain;
  ImageId color;
  ImageId exposure_image;
  ImageId variance;
  std::optional<ImageId> guide;
  ImageId offset;
  ImageId merged_color;
  ImageId merged_stats;
  ImageId decision;
};

ForwardFilter::ForwardFilter(gpu::Device& device, const Settings& settings, int width, int height,
                             AovSet available, AovSet diagnostics)
    : state_(std::make_unique<State>(device, settings, width, height, available, diagnostics)) {}
ForwardFilter::~ForwardFilter() = default;
ForwardFilter::ForwardFilter(ForwardFilter&&) noexcept = default;

Denoised ForwardFilter::denoise(const Frame& frame) {
  State& s = *state_;
  check_frame(frame, s.full.width, s.full.height, s.used, "the frames before it");
  const Image& beauty = frame.image(Aov::beauty);
  const std::vector<std::uint8_t> finite = finite_pixels(beauty);

  Denoised result{Frame(frame.number(), frame.width(), frame.height()), {}};
  FrameReport& report = result.report;
  report.non_finite_pixels = static_cast<std::size_t>(std::ranges::count(finite, 0));
  pack_color(beauty, finite, s.chain.upload<float>(s.color));
  report.replaced_variances = pack_variance(frame, s.used, finite, s.chain.upload<float>(s.variance));
  s.chain.upload<float>(s.exposure_image)[0] = exposure(beauty);
  if (s.guide) pack_guide(frame, s.guides.albedo, s.guides.normal, s.chain.upload<float>(*s.guide));

  s.chain.run();
  report.passes = s.chain.times();

  const auto color = s.chain.download<float>(s.merged_color);
  const auto stats = s.chain.download<float>(s.merged_stats);
  const auto decision = s.chain.download<float>(s.decision);
  Image& out = result.frame.add(Aov::beauty);
  Image& variance = result.frame.add(Aov::variance);
  Image* mask = contains(s.diagnostics, Aov::error_mask) ? &result.frame.add(Aov::error_mask) : nullptr;
  Image* count = contains(s.diagnostics, Aov::sample_count) ? &result.frame.add(Aov::sample_count) : nullptr;
  for (std::size_t i = 0; i < finite.size(); ++i) {
    const auto pixel = finite[i] ? color.subspan(4 * i, 4) : beauty.data().subspan(4 * i, 4);
    std::ranges::copy(pixel, out.data().begin() + 4 * i);
    std::ranges::fill_n(variance.data().begin() + 3 * i, 3, stats[2 * i]);
    if (mask) mask->data()[i] = decision[2 * i];
    if (count) count->data()[i] = decision[2 * i + 1];
    report.mean_rejected += decision[2 * i];
    report.mean_sample_count += decision[2 * i + 1];
  }
  report.mean_rejected /= static_cast<double>(finite.size());
  report.mean_sample_count /= static_cast<double>(finite.size());
  if (contains(s.diagnostics, Aov::flow)) {
    std::ranges::copy(s.chain.download<float>(s.offset), result.frame.add(Aov::flow).data().begin());
  }
  return result;
}

void ForwardFilter::reset() {
  state_->chain.reset_history();
}

std::uint64_t ForwardFilter::device_bytes() const {
  return state_->chain.device_bytes();
}
std::uint64_t ForwardFilter::device_bytes_unaliased() const {
  return state_->chain.device_bytes_unaliased();
}

}  // namespace becalm::filter
