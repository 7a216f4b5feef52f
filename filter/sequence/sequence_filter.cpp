#include "filter/sequence/sequence_filter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "filter/align/pyramid.h"
#include "filter/for_rows.h"
#include "filter/input/frame_check.h"
#include "filter/input/host_images.h"
#include "filter/input/motion_to_next.h"
#include "filter/input/noise_ratio.h"
#include "filter/merge/additive.h"
#include "filter/merge/combine.h"
#include "filter/merge/frame_merger.h"
#include "filter/sequence/alpha.h"
#include "filter/sequence/cuts.h"
#include "filter/sequence/packed_estimate.h"
#include "filter/sequence/spilled_light.h"
#include "filter/smooth/albedo_smoother.h"
#include "filter/smooth/energy.h"
#include "filter/smooth/frame_mixer.h"
#include "filter/smooth/frame_smoother.h"
#include "filter/smooth/merged_smoother.h"
#include "filter/tiles/build_within.h"
#include "frame/error.h"

namespace becalm::filter {
namespace {

/// What becomes of the alpha of a denoised image, and of the light that follows from it.
struct Matte {
  /// 1 for each pixel that is output unchanged: non-finite pixels, and empty ones, into which smoothing would
  /// spread light without alpha.
  std::vector<std::uint8_t> as_they_came;
  /// Of the radiance of the denoised pixels, from spilled_light; empty if all are 1.
  std::vector<float> factors;
};

/// Replaces the alpha of `denoised` by what is output of it: its own in the `noisy` pixels, else the frame's.
Matte restore_matte(const NewFrame& frame, std::span<const std::uint8_t> noisy, Image& denoised) {
  const Image& beauty = frame.frame.image(Aov::beauty);
  std::vector<std::uint8_t> empty = empty_pixels(beauty, noisy);
  std::vector<float> factors = spilled_light(beauty, empty, denoised);
  pass_on_alpha(beauty, noisy, denoised);
  std::ranges::transform(empty, frame.finite, empty.begin(), [](std::uint8_t is_empty, std::uint8_t finite) {
    return static_cast<std::uint8_t>(is_empty | (finite ^ 1));
  });
  return {.as_they_came = std::move(empty), .factors = std::move(factors)};
}

/// Multiplies the denoised pixels by the matte's factors.
void return_spilled_light(const Matte& matte, const FilterTask& task, Frame& frame) {
  if (matte.factors.empty()) return;
  std::vector<Image*> images = additive_images(frame, task.used);
  images.insert(images.end(), {&frame.image(Aov::beauty), &frame.image(Aov::variance)});
  for_rows(frame.height(), [&](int begin, int end) {
    const auto width = static_cast<std::size_t>(frame.width());
    for (std::size_t i = begin * width; i < end * width; ++i) {
      const float factor = matte.as_they_came[i] ? 1.0f : matte.factors[i];
      for (Image* image : images) {
        const bool is_variance = image == images.back();
        for (std::size_t c = 0; c < 3; ++c)
          image->data()[i * image->channels() + c] *= is_variance ? factor * factor : factor;
      }
    }
  });
}

/// Converts the estimate to a frame, with its additive AOVs and the diagnostics that are wanted.
/// `noisy_edges`: the pixels whose alpha is denoised.
Frame output_frame(const NewFrame& frame, const FilterTask& task, MergedFrame made, Accumulated accumulated,
                   std::span<const std::uint8_t> noisy_edges, FrameReport& report) {
  const AovSet& diagnostics = task.diagnostics;
  Frame result(frame.frame.number(), frame.frame.width(), frame.frame.height());
  const std::span<const float> stats = made.merged.stats.data();
  const Image& noisy = frame.frame.image(Aov::beauty);
  const std::span<const float> beauty = noisy.data();
  const std::span<float> color = made.merged.color.data();
  const std::span<float> variance = result.add(Aov::variance).data();
  const Matte matte = restore_matte(frame, noisy_edges, made.merged.color);
  std::span<float> count;
  if (contains(diagnostics, Aov::sample_count)) count = result.add(Aov::sample_count).data();
  const auto width = static_cast<std::size_t>(noisy.width());
  const double frames = sum_of_rows<double>(noisy.height(), [&](int y) {
    double of_row = 0.0;
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      if (matte.as_they_came[i]) std::copy_n(beauty.begin() + 4 * i, 4, color.begin() + 4 * i);
      std::fill_n(variance.begin() + 3 * i, 3, stats[2 * i]);
      if (!count.empty()) count[i] = stats[2 * i + 1];
      of_row += stats[2 * i + 1];
    }
    return of_row;
  });
  report.mean_sample_count = frames / static_cast<double>(frame.finite.size());
  result.image(Aov::beauty) = std::move(made.merged.color);
  const auto add_decision = [&](Aov aov, std::size_t value) {
    if (!contains(diagnostics, aov)) return;
    const std::span<float> layer = result.add(aov).data();
    for (std::size_t i = 0; i < layer.size(); ++i) layer[i] = made.decision.data()[4 * i + value];
  };
  add_decision(Aov::error_mask, 0);
  add_decision(Aov::bias, 1);
  for (float& bias : result.image(Aov::bias).data()) bias = std::sqrt(bias);
  add_decision(Aov::gain, 2);
  if (contains(diagnostics, Aov::residual)) result.image(Aov::residual) = std::move(made.residual);
  if (contains(diagnostics, Aov::flow)) result.image(Aov::flow) = std::move(made.flow);
  if (contains(diagnostics, Aov::accumulated)) {
    result.image(Aov::accumulated) = std::move(accumulated.color);
    result.image(Aov::accumulated_variance) = std::move(accumulated.variance);
    result.image(Aov::accumulated_albedo) = std::move(accumulated.albedo);
    result.image(Aov::accumulated_normal) = std::move(accumulated.normal);
    result.image(Aov::accumulated_depth) = std::move(accumulated.depth);
  }
  unpack_additive(frame, task, made.merged.carried, matte.as_they_came, result);
  return_spilled_light(matte, task, result);
  if (contains(diagnostics, Aov::remaining_variance)) {
    const std::span<float> layer = result.add(Aov::remaining_variance).data();
    const std::span<const float> of_channels = result.image(Aov::variance).data();
    for (std::size_t i = 0; i < layer.size(); ++i) layer[i] = of_channels[3 * i];
  }
  return result;
}

}  // namespace

AovSet wanted_aovs(const Settings& settings) {
  AovSet wanted;
  const auto want = [&](Aov aov, bool needed) { wanted.set(static_cast<std::size_t>(aov), needed); };
  const bool smooths = settings.smooth != Smooth::none;
  want(Aov::albedo, smooths || settings.guides || settings.merge == MergeMode::variance);
  want(Aov::normal, smooths || settings.guides);
  want(Aov::depth, true);  // without smoothing it serves pairs of eyes alone
  want(Aov::motion, settings.motion != MotionUse::none);
  for (const Aov aov : {Aov::variance, Aov::half_a, Aov::half_b}) want(aov, true);
  return wanted;
}

/// What is measured of a frame alone.
struct FrameMeasures {
  float exposure = 1.0f;
  float usual_depth = 1.0f;
  float noise_ratio = 1.0f;
};

struct SequenceFilter::State {
  /// Builds all chains within `memory_limit` bytes. Throws DeviceLimitError.
  void build(gpu::Device& device, std::uint64_t memory_limit);
  /// The same with a merger that takes at most `of_merger` of them.
  void build_with(gpu::Device& device, std::uint64_t memory_limit, std::uint64_t of_merger);
  /// The frame's measures, smoothed albedo and smoothed frame: kept from an earlier step, or computed now.
  FrameMeasures measures(const Step& step, const Frame& frame);
  Image smoothed_albedo(const Step& step, const NewFrame& frame, FrameReport& report);
  Estimate smoothed(const Step& step, const NewFrame& frame, FrameReport& report);
  /// Throws Error(bad_input) if the light groups are not those of the frames before.
  void check_light_groups(const Frame& frame);
  /// The offset into the history; none is known backward without a history.
  Image motion(const Step& step, const Frame& frame);
  /// Merges a frame with the history before it and the prediction kept for it.
  void forward(const Step& step, Merged& made, FrameReport& report);
  /// Drops the history: the next frame starts a new one, as after a cut or a missing frame.
  void reset();

  FilterTask task;
  std::optional<AlbedoSmoother> albedo_smoother;
  std::optional<FrameSmoother> smoother;
  std::optional<FrameMixer> mixer;
  std::optional<MergedSmoother> merged_smoother;
  std::optional<FrameMerger> merger;
  std::optional<Combiner> combiner;

  std::map<int, FrameMeasures> kept_measures;   ///< by frame number
  std::map<int, PackedEstimate> kept_smoothed;  ///< likewise
  std::map<int, HalfImage> kept_albedo;         ///< likewise
  std::map<int, PackedEstimate> predictions;
  FindCuts find_cuts = FindCuts::no;
  std::optional<ShotSignature> before;                   ///< of the last frame in the history
  std::optional<std::vector<std::string>> light_groups;  ///< their names, sorted; of the first frame
  std::optional<Frame> next;  ///< motion and depth of the last frame of a backward pass
};

SequenceFilter::SequenceFilter(gpu::Device& device, const Settings& settings, int width, int height,
                               AovSet available, const SequenceOptions& options)
    : state_(std::make_unique<State>()) {
  const AovSet used = available & (wanted_aovs(settings) | additive_aovs());
  state_->find_cuts = options.find_cuts;
  FilterTask& task = state_->task;
  task = {.settings = settings,
          .full = {width, height},
          .used = used,
          .diagnostics = options.diagnostics,
          .guides = guides_of(settings, used),
          .additive = (used & additive_aovs()).count() + options.light_groups,
          .denoises_alpha = options.alpha == Alpha::denoise};
  build_within(std::min(options.memory_limit, usable_bytes(device)),
               [&](std::uint64_t limit) { state_->build(device, limit); });
}
SequenceFilter::~SequenceFilter() = default;
SequenceFilter::SequenceFilter(SequenceFilter&&) noexcept = default;

void SequenceFilter::State::build(gpu::Device& device, std::uint64_t memory_limit) {
  try {
    build_with(device, memory_limit, memory_limit);
  } catch (const gpu::DeviceLimitError&) {
    // A history that the merger keeps on the device may leave the others too little; a merger that is cut
    // keeps it on the host.
    const std::uint64_t whole = merger ? merger->memory().device.total() : 0;
    if (!merger || merger->memory().tiles > 1) throw;
    build_with(device, memory_limit, whole - 1);
  }
}

void SequenceFilter::State::build_with(gpu::Device& device, std::uint64_t memory_limit,
                                       std::uint64_t of_merger) {
  // What an attempt before this one built must not take the memory.
  albedo_smoother.reset();
  smoother.reset();
  mixer.reset();
  merged_smoother.reset();
  combiner.reset();
  merger.emplace(device, task, of_merger);
  const std::uint64_t left =
      memory_limit - merger->memory().device.own;  // the others keep nothing between runs
  if (task.smooths_albedo() || task.smooths_alpha()) albedo_smoother.emplace(device, task, left);
  if (task.smooths()) {
    FilterTask task_of_frame = task;
    if (task.smooths_merged()) task_of_frame.additive = 0;
    smoother.emplace(device, task_of_frame, left);
    if (!task.variance_known()) mixer.emplace(device, task_of_frame, left);
  }
  if (task.smooths_merged()) merged_smoother.emplace(device, task, left);
  if (task.settings.directions == Directions::both) combiner.emplace(device, task, left);
}

std::optional<Frame> SequenceFilter::run(const Step& step, const Frame& frame, FrameReport& report) {
  std::optional<Merged> merged = begin(step, frame, report);
  if (!merged) return std::nullopt;
  return finish(*merged, report);
}

std::optional<SequenceFilter::Merged> SequenceFilter::begin(const Step& step, const Frame& frame,
                                                            FrameReport& report) {
  const FilterTask& task = state_->task;
  check_frame(frame, task.full.width, task.full.height, task.used, "the frames before it");
  const Image& beauty = frame.image(Aov::beauty);
  const FrameMeasures measures = state_->measures(step, frame);
  NewFrame new_frame{.frame = frame,
                     .finite = finite_pixels(beauty),
                     .exposure = measures.exposure,
                     .usual_depth = measures.usual_depth,
                     .noise_ratio = measures.noise_ratio,
                     .additive = {}};
  new_frame.additive = pack_additive(frame, task, new_frame.finite, report);
  if (task.additive > 0) state_->check_light_groups(frame);
  if (task.smooths()) report.noise_ratio = new_frame.noise_ratio;
  report.non_finite_pixels = count_non_finite(new_frame.finite, frame);
  if (step.wanted && step.direction == Direction::forward)
    report.non_finite_guides = count_non_finite_guides(frame, task.used);
  if (contains(task.used, Aov::motion)) {
    report.far_motions =
        count_far_motions(frame.image(Aov::motion), motion_limit_px(task.settings, task.full));
  }
  if (step.new_history) state_->reset();
  if (state_->find_cuts == FindCuts::yes) {
    ShotSignature signature = shot_signature(frame, task.used, new_frame.exposure);
    report.new_shot = state_->before && is_cut(*state_->before, signature);
    if (report.new_shot) state_->reset();
    if (has_known_cells(signature)) state_->before = std::move(signature);
  }
  if (contains(task.used, Aov::motion)) new_frame.motion = state_->motion(step, frame);
  if (task.smooths_albedo()) new_frame.smoothed_albedo = state_->smoothed_albedo(step, new_frame, report);
  if (state_->smoother) new_frame.smoothed = state_->smoothed(step, new_frame, report);
  if (step.wanted && step.direction == Direction::forward) {
    std::optional<Merged> made(std::in_place, Merged{std::move(new_frame), {}});
    state_->forward(step, *made, report);
    return made;
  }
  MergedFrame merged;
  if (step.wanted) merged.prediction = Estimate(task.full, task.carried());
  state_->merger->merge(new_frame, merged, report);
  if (step.wanted) {
    state_->predictions.insert_or_assign(
        step.frame, PackedEstimate(std::move(merged.prediction), new_frame.exposure,
                                   task.smooths_merged() ? FilterTask::kNoisyLayers : 0));
  }
  return std::nullopt;
}

const FilterTask& SequenceFilter::task() const {
  return state_->task;
}

void SequenceFilter::State::check_light_groups(const Frame& frame) {
  std::vector<std::string> names;
  for (const LightGroup& group : frame.light_groups()) names.push_back(group.name);
  std::ranges::sort(names);
  if (!light_groups) light_groups = names;
  if (names == *light_groups) return;
  throw Error(ExitStatus::bad_input,
              fmt::format("frame {}: has the light groups {}: expected {} as the frames before it",
                          frame.number(), fmt::join(names, ","), fmt::join(*light_groups, ",")));
}

Image SequenceFilter::State::motion(const Step& step, const Frame& frame) {
  if (step.direction == Direction::forward) return frame.image(Aov::motion);
  Image result = next ? motion_to_next(*next)
                      : Image(frame.width(), frame.height(), 2, std::numeric_limits<float>::quiet_NaN());
  next.emplace(frame.number(), frame.width(), frame.height());
  // Without jitter: here and in the merge, AOVs count as those of pixels' centres.
  for (const Aov aov : {Aov::motion, Aov::depth}) next->image(aov) = frame.image(aov);
  return result;
}

FrameMeasures SequenceFilter::State::measures(const Step& step, const Frame& frame) {
  const auto kept = kept_measures.extract(step.frame);
  const FrameMeasures found = kept ? kept.mapped()
                                   : FrameMeasures{.exposure = exposure(frame.image(Aov::beauty)),
                                                   .usual_depth = typical_depth(frame, task.used),
                                                   .noise_ratio = noise_ratio(frame, task.used)};
  if (step.again) kept_measures.insert_or_assign(step.frame, found);
  return found;
}

Image SequenceFilter::State::smoothed_albedo(const Step& step, const NewFrame& frame, FrameReport& report) {
  auto kept = kept_albedo.extract(step.frame);
  // Packed even if no later step needs it, so that the output does not depend on which frames a job has
  // filtered before.
  HalfImage packed =
      kept ? std::move(kept.mapped()) : HalfImage(albedo_smoother->smooth(frame, report), {1.0f, 1.0f, 1.0f});
  Image result = packed.image();
  if (step.again) kept_albedo.insert_or_assign(step.frame, std::move(packed));
  return result;
}

Estimate SequenceFilter::State::smoothed(const Step& step, const NewFrame& frame, FrameReport& report) {
  auto kept = kept_smoothed.extract(step.frame);
  const auto smooth = [&] {
    Estimate made = smoother->smooth(frame, report);
    if (mixer) mixer->mix(frame, made, report);
    return made;
  };
  PackedEstimate packed = kept ? std::move(kept.mapped()) : PackedEstimate(smooth(), frame.exposure, 0);
  Estimate result = packed.estimate();
  if (step.again) kept_smoothed.insert_or_assign(step.frame, std::move(packed));
  return result;
}

void SequenceFilter::State::forward(const Step& step, Merged& made, FrameReport& report) {
  const gpu::Extent full = task.full;
  const NewFrame& frame = made.frame;
  MergedFrame& merged = made.made;
  merged.merged = Estimate(full, task.carried());
  const AovSet& diagnostics = task.diagnostics;
  if (contains(diagnostics, Aov::error_mask) || contains(diagnostics, Aov::bias) ||
      contains(diagnostics, Aov::gain)) {
    merged.decision = Image(full.width, full.height, 4);
  }
  if (contains(diagnostics, Aov::residual)) merged.residual = Image(full.width, full.height, 1);
  if (contains(diagnostics, Aov::flow)) merged.flow = Image(full.width, full.height, 2);
  merger->merge(frame, merged, report);
  report.mean_rejected = merged.rejected / static_cast<double>(full.elements());

  if (const auto prediction = predictions.find(step.frame); prediction != predictions.end()) {
    merged.merged =
        combiner->run(frame.exposure, std::move(merged.merged), prediction->second.estimate(), report);
    predictions.erase(prediction);
  }
}

Frame SequenceFilter::finish(Merged& made, FrameReport& report) {
  const FilterTask& task = state_->task;
  const NewFrame& frame = made.frame;
  MergedFrame& merged = made.made;
  Accumulated noisy;
  if (state_->merged_smoother) {
    if (contains(task.diagnostics, Aov::accumulated)) noisy = accumulated(merged.merged);
    merged.merged = state_->merged_smoother->smooth(frame, std::move(merged.merged), report);
  }
  // MergedSmoother has mixed what it made.
  if (state_->mixer && !task.smooths_merged()) state_->mixer->mix(frame, merged.merged, report);
  if (task.smooths()) restore_energy(frame, task, merged.merged);
  // Clean hair may look noisy: without a request alpha is passed on.
  std::vector<std::uint8_t> noisy_edges(frame.finite.size());
  if (task.denoises_alpha) {
    noisy_edges = noisy_alpha(frame.frame.image(Aov::beauty));
    if (task.smooths_alpha() && std::ranges::find(noisy_edges, 1) != noisy_edges.end())
      state_->albedo_smoother->smooth_alpha(frame, merged.merged.color, report);
  }
  return output_frame(frame, task, std::move(merged), std::move(noisy), noisy_edges, report);
}

void SequenceFilter::State::reset() {
  merger->reset();
  before.reset();
  next.reset();
}

FilterMemory SequenceFilter::memory() const {
  const FilterMemory merge = state_->merger->memory();
  FilterMemory memory{.tiles = merge.tiles, .tile = merge.tile, .tile_plan = "1"};
  if (state_->albedo_smoother) add_memory(memory, state_->albedo_smoother->memory(), "smooth albedo");
  if (state_->smoother) add_memory(memory, state_->smoother->memory(), "smooth");
  add_memory(memory, merge, "merge");
  if (state_->combiner) add_memory(memory, state_->combiner->memory(), "combine");
  if (state_->mixer) add_memory(memory, state_->mixer->memory(), "mix");
  if (state_->merged_smoother) add_memory(memory, state_->merged_smoother->memory(), "smooth merged");
  return memory;
}

}  // namespace becalm::filter
