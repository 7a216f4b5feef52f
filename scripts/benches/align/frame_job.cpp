#include <fmt/format.h>

#include "filter/align/pair_aligner.h"
#include "frame/error.h"
#include "scripts/benches/align/job.h"

namespace becalm::bench {
namespace {

AovSet aov_set(const std::vector<std::string>& names) {
  AovSet set;
  for (const std::string& name : names) {
    const std::optional<Aov> aov = find_aov(name);
    if (!aov) throw Error(ExitStatus::usage, fmt::format("no AOV '{}'", name));
    set.set(static_cast<std::size_t>(*aov));
  }
  return set;
}

class FrameJob : public AlignJob {
 public:
  FrameJob(gpu::Device& device, const filter::Settings& settings, gpu::Extent full, const AovSet& aovs)
      : full_(full), aligner_(device, settings, full.width, full.height, aovs) {}

  void load(const Layers& target, const Layers& source) override {
    target_ = frame_of(target, 1);
    source_ = frame_of(source, 2);
  }
  void run() override {
    report_ = {};
    found_ = aligner_.align(target_, source_, report_);
  }

  std::vector<gpu::PassTime> passes() const override { return report_.passes; }
  Image offset() const override { return found_.offset; }
  Image residual() const override { return found_.residual; }
  std::uint64_t device_bytes() const override { return aligner_.memory().device.total(); }
  std::uint64_t device_bytes_unaliased() const override { return aligner_.memory().device_bytes_unaliased; }

 private:
  /// Channels of an AOV that its layer lacks become 1: an RGB beauty is opaque.
  Frame frame_of(const Layers& layers, int number) const {
    Frame frame(number, full_.width, full_.height);
    for (const auto& [name, layer] : layers) {
      const std::optional<Aov> aov = find_aov(name);
      if (!aov) throw Error(ExitStatus::bad_input, fmt::format("no AOV '{}'", name));
      Image& image = frame.add(*aov, 1.0f);
      if (layer.channels() > image.channels()) {
        throw Error(ExitStatus::bad_input, fmt::format("layer '{}': {} channels, expected {}", name,
                                                       layer.channels(), image.channels()));
      }
      for (int y = 0; y < full_.height; ++y) {
        for (int x = 0; x < full_.width; ++x) {
          std::ranges::copy(layer.pixel(x, y), image.pixel(x, y).begin());
        }
      }
    }
    return frame;
  }

  gpu::Extent full_;
  filter::PairAligner aligner_;
  Frame target_;
  Frame source_;
  filter::PairAlignment found_;
  filter::FrameReport report_;
};

}  // namespace

std::unique_ptr<AlignJob> make_frame_job(gpu::Device& device, const filter::Settings& settings,
                                         gpu::Extent full, const std::vector<std::string>& aovs) {
  return std::make_unique<FrameJob>(device, settings, full, aov_set(aovs));
}

}  // namespace becalm::bench
