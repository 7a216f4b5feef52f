#include "filter/antialias/antialias_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "filter/antialias/antialias_chain.h"
#include "filter/antialias/motion_to_next.h"
#include "filter/antialias/sample_grid.h"
#include "filter/antialias/sharpener.h"
#include "filter/for_rows.h"
#include "filter/input/frame_check.h"
#include "filter/input/host_images.h"
#include "filter/merge/combine.h"
#include "filter/sequence/cuts.h"
#include "filter/sequence/packed_estimate.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {
namespace {

/// The depth of pixels that hit nothing.
constexpr float kFarDepth = 1e30f;
/// Known motion is not limited: it leads out of the frame or to history.
constexpr float kUnlimitedMotion = 1e6f;

/// Copies pixel p + shift of an image, at its border the nearest pixel, to pixel p of `to`, converted by
/// `convert(from, to, is_inside)`.
template <class Convert>
void shifted(const Image& image, const Imath::V2i& shift, std::span<float> to, int channels,
             const Convert& convert) {
  for_rows(image.height(), [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      const int from_y = std::clamp(y + shift.y, 0, image.height() - 1);
      for (int x = 0; x < image.width(); ++x) {
        const int from_x = std::clamp(x + shift.x, 0, image.width() - 1);
        const std::size_t at = static_cast<std::size_t>(y) * image.width() + x;
        convert(image.pixel(from_x, from_y), to.subspan(at * channels, channels),
                from_x == x + shift.x && from_y == y + shift.y);
      }
    }
  });
}

/// The power of two that brings the largest colour of an image (RGBA, finite) to 0.5 to 1, or 1 for a black
/// one: squares of scaled values stay within the range of floats, and scaling back is exact.
float scale_of(const Image& color) {
  float largest = 0.0f;
  for (std::size_t i = 0; i < color.data().size(); ++i) {
    if (i % 4 != 3) largest = std::max(largest, std::abs(color.data()[i]));
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0f, std::clamp(-exponent, -120, 120));
}

}  // namespace

AovSet wanted_aovs(const AntialiasSettings& settings) {
  AovSet wanted;
  const auto want = [&](Aov aov, bool needed) { wanted.set(static_cast<std::size_t>(aov), needed); };
  const bool surface = settings.validate == Validate::surface || settings.validate == Validate::both;
  want(Aov::motion, settings.uses_vectors());
  want(Aov::depth, settings.uses_vectors() || surface);
  want(Aov::normal, surface);
  want(Aov::object_id, surface);
  return wanted;
}

std::string reprojected_text(const AntialiasSettings& settings, const AovSet& available) {
  const bool motion = contains(available, Aov::motion);
  if (!motion || settings.reproject == Reproject::search) return "frames are reprojected by the search";
  switch (settings.reproject) {
    case Reproject::vectors:
      return "frames are reprojected by motion vectors";
    case Reproject::known:
      return "frames are reprojected by motion vectors where known, else by the search";
    default:
      return "frames are reprojected by motion vectors or the search, whichever matches better";
  }
}

struct AntialiasFilter::State {
  /// `color` is the frame's, finite and scaled.
  void upload(const Step& step, const Frame& frame, const Image& color,
              const std::vector<std::uint8_t>& finite);
  void upload_motion(const Step& step, const Frame& frame);
  void upload_surface(const Frame& frame);
  Frame forward(const Frame& frame, const std::vector<std::uint8_t>& finite, float exposure,
                FrameReport& report);
  void add_diagnostics(Frame& result);

  AntialiasTask task;
  FilterTask whole;  ///< for the chains that are shared with the denoiser
  std::optional<AntialiasChain> passes;
  std::optional<Combiner> combiner;
  std::optional<Sharpener> sharpener;

  FindCuts find_cuts = FindCuts::no;
  std::optional<ShotSignature> before;  ///< of the last frame in the history
  std::map<int, PackedEstimate> predictions;
  std::optional<float> scale;  ///< of the radiance on the device: a power of two, the same for all frames
  SampleGrid grid;             ///< of the frame at work
  Frame next;                  ///< motion and depth of the last frame of a backward pass
};

AntialiasFilter::AntialiasFilter(gpu::Device& device, const AntialiasSettings& settings, int width,
                                 int height, AovSet available, const SequenceOptions& options)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.find_cuts = options.find_cuts;
  s.task = {.settings = settings,
            .full = {width, height},
            .used = available & wanted_aovs(settings),
            .diagnostics = options.diagnostics};
  s.whole = {.settings = aligner_settings(s.task),
             .full = s.task.full,
             .used = s.task.used,
             .diagnostics = {},
             .guides = {}};
  s.whole.settings.patch_radius = 1;
  s.passes.emplace(device, s.task);
  s.passes->chain.plan();
  const std::uint64_t allowed = std::min(options.memory_limit, usable_bytes(device));
  const std::uint64_t bytes = s.passes->chain.device_bytes();
  if (bytes > allowed) {
    throw gpu::DeviceLimitError(tiles_too_large(uncut(s.task.full), bytes, allowed));
  }
  s.passes->chain.build();
  if (settings.directions == Directions::both) s.combiner.emplace(device, s.whole, allowed - bytes);
  if (settings.sharpen > 0.0f) s.sharpener.emplace(device, s.whole, settings.sharpen, allowed - bytes);
}
AntialiasFilter::~AntialiasFilter() = default;
AntialiasFilter::AntialiasFilter(AntialiasFilter&&) noexcept = default;

std::optional<Frame> AntialiasFilter::run(const Step& step, const Frame& frame, FrameReport& report) {
  State& s = *state_;
  const AntialiasTask& task = s.task;
  check_frame(frame, task.full.width, task.full.height, task.used, "the frames before it");
  const Image& beauty = frame.image(Aov::beauty);
  const std::vector<std::uint8_t> finite = finite_pixels(beauty);
  report.non_finite_pixels = static_cast<std::size_t>(std::ranges::count(finite, 0));
  Image color(task.full.width, task.full.height, 4);
  pack_color(beauty, finite, bounds(task.full), color.data());
  if (!s.scale) s.scale = scale_of(color);
  for (float& value : color.data()) value *= *s.scale;
  const float exposed = exposure(color);
  const auto reset = [&] {
    s.passes->chain.reset_history();
    s.next = {};
    s.before.reset();
  };
  if (step.new_history) reset();
  if (s.find_cuts == FindCuts::yes) {
    ShotSignature signature = shot_signature(frame, task.used, exposure(beauty));
    report.new_shot = s.before && is_cut(*s.before, signature);
    if (report.new_shot) reset();
    s.before = std::move(signature);
  }
  s.grid = sample_grid(task.settings.reconstruct == Switch::yes ? frame.jitter() : std::nullopt);
  s.upload(step, frame, color, finite);
  s.passes->chain.upload<float>(s.passes->exposure)[0] = exposed;
  s.passes->chain.run();
  add_times(report, s.passes->chain);
  if (step.direction == Direction::forward) {
    if (!step.wanted) return std::nullopt;
    return s.forward(frame, finite, exposed, report);
  }
  if (step.wanted) {
    Estimate prediction(task.full, 0);
    prediction.color = download(s.passes->chain, s.passes->warped.color, task.full, 4);
    prediction.stats = download(s.passes->chain, s.passes->warped.stats, task.full, 2);
    const auto decided = s.passes->chain.download<float>(s.passes->decision);
    const std::span<float> stats = prediction.stats.data();
    for (std::size_t i = 0; i < stats.size(); i += 2) {
      stats[i] = std::min(stats[i] + decided[2 * i + 1], kLargestVariance);
    }
    s.predictions.insert_or_assign(step.frame, PackedEstimate(std::move(prediction), exposed, 0));
  }
  return std::nullopt;
}

void AntialiasFilter::State::upload(const Step& step, const Frame& frame, const Image& color,
                                    const std::vector<std::uint8_t>& finite) {
  gpu::Chain& chain = passes->chain;
  shifted(
      color, grid.shift, chain.upload<float>(passes->samples), 4,
      [](std::span<const float> from, std::span<float> to, bool) { std::ranges::copy(from, to.begin()); });
  Image counts(task.full.width, task.full.height, 1);
  std::ranges::copy(finite, counts.data().begin());
  shifted(
      counts, grid.shift, chain.upload<float>(passes->finite), 1,
      [](std::span<const float> from, std::span<float> to, bool inside) { to[0] = inside ? from[0] : 0.0f; });
  std::ranges::copy(grid.weights, chain.upload<float>(passes->weights).begin());
  if (passes->motion) upload_motion(step, frame);
  if (passes->surface) upload_surface(frame);
}

void AntialiasFilter::State::upload_motion(const Step& step, const Frame& frame) {
  gpu::Chain& chain = passes->chain;
  const bool forward_in_time = step.direction == Direction::forward;
  const std::span<float> motion = chain.upload<float>(*passes->motion);
  if (forward_in_time) {
    Image pairs(task.full.width, task.full.height, 2);
    pack_motion(frame.image(Aov::motion), bounds(task.full), kUnlimitedMotion, pairs.data());
    shifted(pairs, grid.shift, motion, 2, [](std::span<const float> from, std::span<float> to, bool) {
      std::ranges::copy(from, to.begin());
    });
  } else if (next.has(Aov::motion)) {
    pack_motion(motion_to_next(next), bounds(task.full), kUnlimitedMotion, motion);
  } else {
    std::ranges::fill(motion, 0.0f);  // there is no history yet
  }
  if (passes->depth) {
    shifted(frame.image(Aov::depth), grid.shift, chain.upload<float>(*passes->depth), 1,
            [](std::span<const float> from, std::span<float> to, bool) {
              to[0] = from[0] < kFarDepth ? from[0] : kFarDepth;  // NaN is far, too
            });
  }
  if (forward_in_time) return;
  next = Frame(frame.number(), frame.width(), frame.height());
  next.image(Aov::motion) = frame.image(Aov::motion);
  next.image(Aov::depth) = frame.image(Aov::depth);
  if (grid.weights[9] > 0.0f) next.set_jitter(frame.jitter());
}

void AntialiasFilter::State::upload_surface(const Frame& frame) {
  gpu::Chain& chain = passes->chain;
  Image surface(task.full.width, task.full.height, 4);
  const Image& normal = frame.image(Aov::normal);
  const Image& depth = frame.image(Aov::depth);
  const auto finite_or_zero = [](float x) { return std::isfinite(x) ? x : 0.0f; };
  for (std::size_t i = 0; i < surface.pixel_count(); ++i) {
    float* to = surface.data().data() + 4 * i;
    for (std::size_t c = 0; c < 3 && contains(task.used, Aov::normal); ++c) {
      to[c] = finite_or_zero(normal.data()[3 * i + c]);
    }
    if (contains(task.used, Aov::depth)) {
      const float z = depth.data()[i];
      to[3] = z < kFarDepth ? z : std::isnan(z) ? 0.0f : kFarDepth;
    }
  }
  const auto copy = [](std::span<const float> from, std::span<float> to, bool) {
    std::ranges::copy(from, to.begin());
  };
  shifted(surface, grid.shift, chain.upload<float>(*passes->surface), 4, copy);
  const std::span<float> object = chain.upload<float>(*passes->object);
  if (contains(task.used, Aov::object_id)) {
    shifted(frame.image(Aov::object_id), grid.shift, object, 1, copy);
  } else {
    std::ranges::fill(object, 0.0f);
  }
}

Frame AntialiasFilter::State::forward(const Frame& frame, const std::vector<std::uint8_t>& finite,
                                      float exposure, FrameReport& report) {
  const gpu::Extent full = task.full;
  Estimate made(full, 0);
  made.color = download(passes->chain, passes->color.next, full, 4);
  made.stats = download(passes->chain, passes->stats.next, full, 2);
  if (const auto prediction = predictions.find(frame.number()); prediction != predictions.end()) {
    made = combiner->run(exposure, made, prediction->second.estimate(), report);
    predictions.erase(prediction);
  }
  if (sharpener) made.color = sharpener->run(made.color, report);
  Frame result(frame.number(), full.width, full.height);
  const float back = 1.0f / *scale;
  const std::span<const float> beauty = frame.image(Aov::beauty).data();
  const std::span<float> color = made.color.data();
  for (std::size_t i = 0; i < finite.size(); ++i) {
    for (std::size_t c = 4 * i; c < 4 * i + 4; ++c) color[c] = finite[i] ? back * color[c] : beauty[c];
  }
  result.image(Aov::beauty) = std::move(made.color);
  if (contains(task.diagnostics, Aov::sample_count)) {
    const std::span<float> layer = result.add(Aov::sample_count).data();
    for (std::size_t i = 0; i < layer.size(); ++i) layer[i] = made.stats.data()[2 * i + 1];
  }
  add_diagnostics(result);
  return result;
}

void AntialiasFilter::State::add_diagnostics(Frame& result) {
  const auto decided = passes->chain.download<float>(passes->decision);
  const auto add = [&](Aov aov, std::size_t value, auto convert) {
    if (!contains(task.diagnostics, aov)) return;
    const std::span<float> layer = result.add(aov).data();
    for (std::size_t i = 0; i < layer.size(); ++i) layer[i] = convert(decided[4 * i + value]);
  };
  add(Aov::error_mask, 0, [](float x) { return x; });
  add(Aov::bias, 1, [&](float x) { return std::sqrt(x) / *scale; });
  add(Aov::gain, 2, [](float x) { return x; });
  if (contains(task.diagnostics, Aov::flow)) {
    result.image(Aov::flow) = download(passes->chain, passes->offset, task.full, 2);
  }
}

FilterMemory AntialiasFilter::memory() const {
  FilterMemory memory{.tiles = 1, .tile = state_->task.full, .tile_plan = "1"};
  add_memory(memory, state_->passes->chain);
  for (const FilterMemory& part : {state_->combiner ? state_->combiner->memory() : FilterMemory{},
                                   state_->sharpener ? state_->sharpener->memory() : FilterMemory{}}) {
    memory.device_bytes += part.device_bytes;
    memory.device_bytes_unaliased += part.device_bytes_unaliased;
    memory.staging_bytes += part.staging_bytes;
  }
  return memory;
}

}  // namespace becalm::filter
