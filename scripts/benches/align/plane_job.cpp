#include <fmt/format.h>

#include <algorithm>

#include "filter/align/align.h"
#include "filter/gpu/chain.h"
#include "filter/tiles/pixel_view.h"
#include "frame/error.h"
#include "scripts/benches/align/job.h"

namespace becalm::bench {
namespace {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

class PlaneJob : public AlignJob {
 public:
  PlaneJob(gpu::Device& device, const filter::Settings& settings, Extent full, bool alias_memory)
      : full_(full),
        matching_(filter::pyramid_extents(settings, full.width, full.height).front()),
        chain_(device, "align planes", {.alias_memory = alias_memory}) {
    const filter::Features target = add_feature(settings, "target", target_);
    const filter::Features source = add_feature(settings, "source", source_);
    const filter::Alignment alignment = add_align_passes(chain_, settings, full, target, source);
    offset_ = alignment.offset;
    residual_ = alignment.residual;
    chain_.output(offset_);
    chain_.output(residual_);
    chain_.build();
  }

  void load(const Layers& target, const Layers& source) override {
    target_plane_ = plane_of(target);
    source_plane_ = plane_of(source);
  }
  void prepare() override {
    std::ranges::copy(target_plane_.data(), chain_.upload<float>(target_).begin());
    std::ranges::copy(source_plane_.data(), chain_.upload<float>(source_).begin());
  }
  void run() override { chain_.run(); }

  std::vector<gpu::PassTime> passes() const override { return chain_.times(); }
  Image offset() const override { return filter::download(chain_, offset_, full_, 2); }
  Image residual() const override { return filter::download(chain_, residual_, matching_, 1); }
  std::uint64_t device_bytes() const override { return chain_.device_bytes().total(); }
  std::uint64_t device_bytes_unaliased() const override { return chain_.device_bytes_unaliased(); }

 private:
  filter::Features add_feature(const filter::Settings& settings, const char* name, ImageId& plane) {
    plane = chain_.input(fmt::format("plane.{}", name), Format::f32, full_);
    const ImageId features = chain_.image(fmt::format("features.{}.L0", name), Format::f32, matching_);
    filter::add_guide_passes(chain_, settings, full_, plane, {1.0f}, features);
    return {features, 1};
  }

  static Image plane_of(const Layers& layers) {
    const auto layer = layers.find("plane");
    if (layer == layers.end() || layer->second.channels() != 1) {
      throw Error(ExitStatus::bad_input, "expected a layer 'plane' of one channel");
    }
    return layer->second;
  }

  Extent full_;
  Extent matching_;
  gpu::Chain chain_;
  Image target_plane_;
  Image source_plane_;
  ImageId target_;
  ImageId source_;
  ImageId offset_;
  ImageId residual_;
};

}  // namespace

std::unique_ptr<AlignJob> make_plane_job(gpu::Device& device, const filter::Settings& settings, Extent full,
                                         bool alias_memory) {
  return std::make_unique<PlaneJob>(device, settings, full, alias_memory);
}

}  // namespace becalm::bench
