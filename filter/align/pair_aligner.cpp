#include "filter/align/pair_aligner.h"

#include <optional>
#include <string>

#include "filter/align/align.h"
#include "filter/align/guides.h"
#include "filter/input/frame_check.h"
#include "filter/input/host_images.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

struct PairAligner::State {
  /// The inputs for one of the two frames.
  struct Inputs {
    ImageId color;
    std::optional<ImageId> guide;
  };

  State(gpu::Device& device, const Settings& settings_, int width, int height, const AovSet& available)
      : settings(settings_),
        full{width, height},
        guides(guides_of(settings, available)),
        chain(device, "align pair") {
    required.set(static_cast<std::size_t>(Aov::beauty));
    required.set(static_cast<std::size_t>(Aov::albedo), guides.albedo);
    required.set(static_cast<std::size_t>(Aov::normal), guides.normal);
    extents = pyramid_extents(settings, width, height);
    exposure_image = chain.table("exposure", Format::f32, {1, 1});
    const Features target_features = add_features("target", target);
    const Features source_features = add_features("source", source);
    if (settings.motion != MotionUse::none && contains(available, Aov::motion)) {
      motion = chain.input("motion", Format::f32x2, full);
    }
    alignment = add_align_passes(chain, settings, full, target_features, source_features,
                                 {.name = {}, .motion = motion});
    chain.output(alignment.offset);
    for (const ImageId residual : alignment.residual) chain.output(residual);
    chain.build();
  }

  Features add_features(const std::string& name, Inputs& inputs) {
    inputs.color = chain.input("color." + name, Format::f32x4, full);
    FeatureSources sources{
        .color = inputs.color, .exposure = exposure_image, .guide_features = {}, .guide_planes = 0};
    if (guides.planes() > 0) {
      inputs.guide = chain.input("guide." + name, Format::f32, {full.width, full.height, guides.planes()});
      Extent extent = extents.front();
      extent.planes = guides.planes();
      sources.guide_features = chain.image("guide.features." + name, Format::f32, extent);
      sources.guide_planes = guides.planes();
      add_guide_passes(chain, settings, full, *inputs.guide, guides.weights, *sources.guide_features);
    }
    return add_feature_passes(chain, settings, full, name, sources);
  }

  void upload(const Frame& frame, const Inputs& inputs) {
    const Image& beauty = frame.image(Aov::beauty);
    pack_color(beauty, finite_pixels(beauty), bounds(full), chain.upload<float>(inputs.color));
    if (inputs.guide)
      pack_guide(frame, guides.albedo, guides.normal, bounds(full), chain.upload<float>(*inputs.guide));
  }

  Settings settings;
  Extent full;
  Guides guides;
  AovSet required;
  std::vector<Extent> extents;
  gpu::Chain chain;
  ImageId exposure_image;
  Inputs target;
  Inputs source;
  std::optional<ImageId> motion;
  Alignment alignment;
};

PairAligner::PairAligner(gpu::Device& device, const Settings& settings, int width, int height,
                         const AovSet& available)
    : state_(std::make_unique<State>(device, settings, width, height, available)) {}
PairAligner::~PairAligner() = default;
PairAligner::PairAligner(PairAligner&&) noexcept = default;

PairAlignment PairAligner::align(const Frame& target, const Frame& source) {
  State& s = *state_;
  for (const Frame* frame : {&target, &source}) {
    check_frame(*frame, s.full.width, s.full.height, s.required, "the aligner's frames");
  }
  s.chain.upload<float>(s.exposure_image)[0] = exposure(target.image(Aov::beauty));
  s.upload(target, s.target);
  s.upload(source, s.source);
  if (s.motion) {
    check_frame(target, s.full.width, s.full.height, AovSet().set(static_cast<std::size_t>(Aov::motion)),
                "the aligner's target");
    pack_motion(target.image(Aov::motion), bounds(s.full), motion_limit_px(s.settings, s.full),
                s.chain.upload<float>(*s.motion));
  }
  s.chain.run();

  PairAlignment result{download(s.chain, s.alignment.offset, s.full, 2), {}, s.chain.times()};
  for (std::size_t l = 0; l < s.extents.size(); ++l) {
    result.residual.push_back(download(s.chain, s.alignment.residual[l], s.extents[l], 1));
  }
  return result;
}

std::uint64_t PairAligner::device_bytes() const {
  return state_->chain.device_bytes();
}
std::uint64_t PairAligner::device_bytes_unaliased() const {
  return state_->chain.device_bytes_unaliased();
}

}  // namespace becalm::filter
