#include "filter/antialias/antialias_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "filter/antialias/antialias_chain.h"
#include "filter/antialias/checkerboard.h"
#include "filter/antialias/radiance_range.h"
#include "filter/antialias/sample_grid.h"
#include "filter/for_rows.h"
#include "filter/input/frame_check.h"
#include "filter/input/host_images.h"
#include "filter/input/motion_to_next.h"
#include "filter/merge/combine.h"
#include "filter/sequence/cuts.h"
#include "filter/sequence/packed_estimate.h"
#include "filter/tiles/build_within.h"
#include "filter/tiles/pixel_view.h"
#include "shaders/shared/limits.h"

namespace becalm::filter {
namespace {

/// The depth of pixels that hit nothing.
constexpr float kFarDepth = 1e30f;

/// Mean over the pixels of one of their `channels` values.
double mean_of(std::span<const float> values, std::size_t channels, std::size_t channel) {
  double sum = 0.0;
  for (std::size_t i = channel; i < values.size(); i += channels) sum += values[i];
  return sum * static_cast<double>(channels) / static_cast<double>(values.size());
}

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

/// Calls `copy(from, to)` for each pixel of the scaled image, with the pixel of `image` that `nearest` names.
template <class Copy>
void scaled(const Image& image, const NearestSample& nearest, gpu::Extent full, std::span<float> to,
            int channels, const Copy& copy) {
  for_rows(full.height, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < full.width; ++x) {
        const Imath::V2i from = nearest.at(x, y);
        const std::size_t at = static_cast<std::size_t>(y) * full.width + x;
        copy(image.pixel(from.x, from.y), to.subspan(at * channels, channels));
      }
    }
  });
}

/// Scales grow from frame to frame, and from a prediction to its frame, by this at most: a dim frame leaves
/// the history, fireflies included, below the limit of scaled colours.
constexpr float kLargestRatio = 0x1p30f;

/// A depth as kernels take it: what is not known is far.
float known_depth(float depth) {
  return depth > 0.0f && depth < kFarDepth ? depth : kFarDepth;
}

}  // namespace

AovSet wanted_aovs(const AntialiasSettings& settings) {
  AovSet wanted;
  const auto want = [&](Aov aov, bool needed) { wanted.set(static_cast<std::size_t>(aov), needed); };
  want(Aov::motion, settings.uses_vectors());
  want(Aov::depth, settings.uses_vectors());
  return wanted;
}

std::string reprojected_text(const AntialiasSettings& settings, const AovSet& available) {
  const bool motion = contains(available, Aov::motion);
  if (!motion || !settings.uses_vectors()) return "frames are reprojected by the search";
  return settings.searches() ? "frames are reprojected by motion vectors where known, else by the search"
                             : "frames are reprojected by motion vectors";
}

std::string size_problem(const gpu::Device& device, const AntialiasSettings& settings,
                         const Imath::Box2i& window) {
  // Kernels write images of four floats in bands of rows, so those of two are the largest storage buffers.
  constexpr std::uint64_t pixel_bytes = 8;
  const std::uint64_t most =
      std::min(device.info().max_storage_buffer_bytes / pixel_bytes, device.info().max_texel_buffer_elements);
  const Imath::V2i size = settings.scale.window(window).size() + Imath::V2i(1);
  if (static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y) <= most) return "";
  return fmt::format(
      "antialias takes whole frames, here of {}x{} px: expected at most {} pixels on device "
      "'{}'; smaller frames, a smaller --scale or another --device do",
      size.x, size.y, most, device.info().name);
}

struct AntialiasFilter::State {
  /// Places an image of the frame, or with `on_grid` one whose values lie in pixel centres, in an image of
  /// the chain by `convert(from, to, is_inside)`.
  template <class Convert>
  void place(const Image& image, std::span<float> to, int channels, const Convert& convert,
             bool on_grid = false) const {
    if (!task.is_sparse()) return shifted(image, on_grid ? Imath::V2i(0) : grid.shift, to, channels, convert);
    NearestSample nearest{.scale = task.settings.scale, .window = window};
    if (!on_grid) nearest.position_px = sparse.position_px;
    scaled(image, nearest, task.full, to, channels,
           [&](std::span<const float> from, std::span<float> at) { convert(from, at, true); });
  }
  void reset_history();
  /// Resets the history where a new shot begins; returns whether one does.
  bool reset_at_cut(const Frame& frame, float exposure);
  void place_samples(const Frame& frame);
  /// Keeps what the frames after this one predict for the forward step.
  void keep_prediction(int frame, float exposure);
  /// Chooses the scale for a frame's colours, finite ones; returns its ratio to the history's.
  float choose_scale(const Image& color);
  /// `color` is the frame's, finite and scaled.
  void upload(const Step& step, const Frame& frame, const Image& color,
              const std::vector<std::uint8_t>& finite);
  void upload_motion(const Step& step, const Frame& frame);
  Frame forward(const Step& step, const Frame& frame, const std::vector<std::uint8_t>& finite, float exposure,
                FrameReport& report);
  void add_diagnostics(std::span<const float> decided, Frame& result);

  AntialiasTask task;
  FilterTask whole;  ///< for the chains that are shared with the denoiser
  std::optional<AntialiasChain> passes;
  std::optional<Combiner> combiner;

  FindCuts find_cuts = FindCuts::no;
  std::optional<ShotSignature> before;  ///< of the last frame in the history
  struct Prediction {
    PackedEstimate estimate;
    float scale;  ///< of its radiance
  };
  std::map<int, Prediction> predictions;
  bool has_history = false;
  float scale = 1.0f;   ///< of the radiance on the device: a power of two, chosen anew for each frame
  Imath::Box2i window;  ///< of the frames, in the image plane
  SampleGrid grid;      ///< of the frame at work
  SparseGrid sparse;    ///< the same, if the task is
  Frame next;           ///< motion and depth of the last frame of a backward pass
};

AntialiasFilter::AntialiasFilter(gpu::Device& device, const AntialiasSettings& settings, int width,
                                 int height, AovSet available, const SequenceOptions& options)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.find_cuts = options.find_cuts;
  s.window = {options.origin, options.origin + Imath::V2i(width - 1, height - 1)};
  const Imath::V2i size = settings.scale.window(s.window).size() + Imath::V2i(1);
  s.task = {.settings = settings,
            .full = {size.x, size.y},
            .sampled = {width, height},
            .origin = options.origin,
            .used = available & wanted_aovs(settings),
            .diagnostics = options.diagnostics};
  s.whole = {.settings = aligner_settings(s.task),
             .full = s.task.full,
             .used = s.task.used,
             .diagnostics = {},
             .guides = {}};
  s.passes.emplace(device, s.task);
  s.passes->chain.plan();
  const std::uint64_t allowed = std::min(options.memory_limit, usable_bytes(device));
  const gpu::DeviceBytes bytes = s.passes->chain.device_bytes();
  if (bytes.total() > allowed) {
    throw gpu::DeviceLimitError(frame_too_large(s.task.full, bytes.total(), allowed));
  }
  s.passes->chain.build();
  build_within(allowed - bytes.own, [&](std::uint64_t limit) {
    s.combiner.reset();  // an attempt before this one must not take the memory
    if (settings.directions == Directions::both) s.combiner.emplace(device, s.whole, limit);
  });
}
AntialiasFilter::~AntialiasFilter() = default;
AntialiasFilter::AntialiasFilter(AntialiasFilter&&) noexcept = default;

std::optional<Frame> AntialiasFilter::run(const Step& step, const Frame& given, FrameReport& report) {
  State& s = *state_;
  const AntialiasTask& task = s.task;
  const gpu::Extent sampled = task.samples();
  check_frame(given, sampled.width, sampled.height, task.used, "the frames before it");
  std::optional<Frame> whole;
  if (task.settings.checkerboard) {
    require_checkerboard(given);
    whole = given;
    fill_holes(*whole, *given.checkerboard());
  }
  const Frame& frame = whole ? *whole : given;
  const Image& beauty = frame.image(Aov::beauty);
  std::vector<std::uint8_t> finite = finite_pixels(beauty);
  std::vector<std::uint8_t> counts = finite;  // what is a sample
  if (whole) {
    leave_holes(*given.checkerboard(), sampled.width, counts);
    // Holes are filled from the samples around, so they never count as non-finite.
    close_holes(*given.checkerboard(), sampled.width, finite);
  }
  report.non_finite_pixels = count_non_finite(finite, frame);
  Image color(sampled.width, sampled.height, 4);
  pack_color(beauty, counts, bounds(sampled), color.data());
  if (step.new_history) s.reset_history();
  if (s.find_cuts == FindCuts::yes) report.new_shot = s.reset_at_cut(frame, exposure(beauty));
  const float ratio = s.choose_scale(color);
  scale_colors(color, s.scale);
  const float exposed = exposure(color);
  s.place_samples(frame);
  s.upload(step, frame, color, counts);
  s.passes->chain.upload<float>(s.passes->exposure)[0] = exposed;
  s.passes->chain.upload<float>(s.passes->history_exposure)[0] = ratio * exposed;
  s.passes->chain.upload<float>(s.passes->ratio)[0] = ratio;
  s.passes->chain.run();
  s.has_history = true;
  add_times(report, s.passes->chain);
  if (step.direction == Direction::forward) {
    if (!step.wanted) return std::nullopt;
    return s.forward(step, frame, finite, exposed, report);
  }
  if (step.wanted) s.keep_prediction(step.frame, exposed);
  return std::nullopt;
}

void AntialiasFilter::State::reset_history() {
  passes->chain.reset_history();
  has_history = false;
  next = {};
  before.reset();
}

bool AntialiasFilter::State::reset_at_cut(const Frame& frame, float exposure) {
  ShotSignature signature = shot_signature(frame, task.used, exposure);
  const bool new_shot = before && is_cut(*before, signature);
  if (new_shot) reset_history();
  if (has_known_cells(signature)) before = std::move(signature);
  return new_shot;
}

void AntialiasFilter::State::place_samples(const Frame& frame) {
  const auto& jitter = task.uses_places() ? frame.jitter() : std::nullopt;
  if (task.is_sparse()) {
    sparse = sparse_grid(jitter, task.settings.scale, window, task.settings.checkerboard);
  } else {
    grid = sample_grid(jitter);
  }
}

void AntialiasFilter::State::keep_prediction(int frame, float exposure) {
  Estimate prediction(task.full, 0);
  prediction.color = download(passes->chain, passes->prediction(), task.full, 4);
  prediction.stats = download(passes->chain, passes->warped.stats, task.full, 2);
  const auto decided = passes->chain.download<float>(passes->decision);
  const std::span<float> stats = prediction.stats.data();
  for (std::size_t i = 0; i < stats.size(); i += 2) {
    // What rejects the history of the frames after rejects the prediction.
    const std::span<const float> here = std::span(decided).subspan(2 * i, 4);
    const auto [rejected, bias, weight, worth] = std::array{here[0], here[1], here[2], here[3]};
    stats[i] = std::min(stats[i] + bias, kLargestVariance);
    stats[i + 1] *= 1.0f - rejected;
    if (task.settings.accumulate == Accumulate::gain)
      stats[i + 1] = std::min(stats[i + 1], worth * (1.0f - weight) / std::max(weight, 1e-6f));
  }
  predictions.insert_or_assign(frame, Prediction{PackedEstimate(std::move(prediction), exposure, 0), scale});
}

float AntialiasFilter::State::choose_scale(const Image& color) {
  const float of_frame = scale_of(color).value_or(scale);
  const float before = has_history ? scale : of_frame;
  scale = std::min(of_frame, kLargestRatio * before);
  return scale / before;
}

void AntialiasFilter::State::upload(const Step& step, const Frame& frame, const Image& color,
                                    const std::vector<std::uint8_t>& finite) {
  gpu::Chain& chain = passes->chain;
  const auto upload_tables = [&](const SparseTables& tables, const SparseGrid& of) {
    std::ranges::copy(of.columns, chain.upload<float>(tables.columns).begin());
    std::ranges::copy(of.rows, chain.upload<float>(tables.rows).begin());
  };
  const gpu::Extent sampled = task.samples();
  Image counts(sampled.width, sampled.height, 1);
  std::ranges::copy(finite, counts.data().begin());
  if (passes->grid) {
    upload_tables(*passes->grid, sparse);
    if (passes->search_grid) {
      upload_tables(*passes->search_grid,
                    sparse_grid(frame.jitter(), {}, window, task.settings.checkerboard));
    }
    std::ranges::copy(color.data(), chain.upload<float>(passes->samples).begin());
    std::ranges::copy(counts.data(), chain.upload<float>(passes->finite).begin());
  } else {
    shifted(
        color, grid.shift, chain.upload<float>(passes->samples), 4,
        [](std::span<const float> from, std::span<float> to, bool) { std::ranges::copy(from, to.begin()); });
    shifted(counts, grid.shift, chain.upload<float>(passes->finite), 1,
            [](std::span<const float> from, std::span<float> to, bool inside) {
              to[0] = inside ? from[0] : 0.0f;
            });
    std::ranges::copy(grid.weights, chain.upload<float>(*passes->weights).begin());
  }
  if (passes->motion) upload_motion(step, frame);
}

void AntialiasFilter::State::upload_motion(const Step& step, const Frame& frame) {
  gpu::Chain& chain = passes->chain;
  const bool forward_in_time = step.direction == Direction::forward;
  const std::span<float> motion = chain.upload<float>(*passes->motion);
  const auto place_motion = [&](const Image& vectors, bool on_grid) {
    Image pairs(vectors.width(), vectors.height(), 2);
    pack_motion(vectors, bounds(task.samples()), kLongestMotion, pairs.data());
    const auto scale = static_cast<float>(task.settings.scale.value());
    place(
        pairs, motion, 2,
        [scale](std::span<const float> from, std::span<float> to, bool) {
          to[0] = scale * from[0];
          to[1] = scale * from[1];
        },
        on_grid);
  };
  if (forward_in_time) {
    place_motion(frame.image(Aov::motion), false);
  } else if (next.has(Aov::motion)) {
    place_motion(motion_to_next(next), true);
  } else {
    std::ranges::fill(motion, 0.0f);  // there is no history yet
  }
  if (passes->depth) {
    place(frame.image(Aov::depth), chain.upload<float>(*passes->depth), 1,
          [](std::span<const float> from, std::span<float> to, bool) { to[0] = known_depth(from[0]); });
  }
  if (forward_in_time) return;
  next = Frame(frame.number(), frame.width(), frame.height());
  next.image(Aov::motion) = frame.image(Aov::motion);
  next.image(Aov::depth) = frame.image(Aov::depth);
  if (task.uses_places()) next.set_jitter(frame.jitter());
}

Frame AntialiasFilter::State::forward(const Step& step, const Frame& frame,
                                      const std::vector<std::uint8_t>& finite, float exposure,
                                      FrameReport& report) {
  const gpu::Extent full = task.full;
  Estimate made(full, 0);
  made.color = download(passes->chain, passes->color.next, full, 4);
  made.stats = download(passes->chain, passes->stats.next, full, 2);
  const Image decided = download(passes->chain, passes->decision, full, 4);
  Frame result(frame.number(), full.width, full.height);
  add_diagnostics(decided.data(), result);
  if (const auto prediction = predictions.find(step.frame); prediction != predictions.end()) {
    const float ratio = scale / prediction->second.scale;
    // Beyond it the frames after this one are so bright that they tell nothing of it.
    if (ratio <= kLargestRatio) {
      Estimate predicted = prediction->second.estimate.estimate();
      rescale(predicted, ratio);
      made = combiner->run(exposure, std::move(made), std::move(predicted), report);
    }
    predictions.erase(prediction);
  }
  const float back = 1.0f / scale;
  const NearestSample nearest{.scale = task.settings.scale, .window = window};
  for (int y = 0; y < full.height; ++y) {
    for (int x = 0; x < full.width; ++x) {
      const Imath::V2i from = nearest.at(x, y);
      const std::span<float> color = made.color.pixel(x, y);
      const bool is_cut_off = frame.cut() && !frame.cut()->window.intersects(from);
      if (is_cut_off || finite[static_cast<std::size_t>(from.y) * frame.width() + from.x] != 0) {
        for (float& value : color.first(3)) value *= back;
      } else {
        std::ranges::copy(frame.image(Aov::beauty).pixel(from.x, from.y), color.begin());
      }
    }
  }
  result.image(Aov::beauty) = std::move(made.color);
  if (contains(task.diagnostics, Aov::sample_count)) {
    const std::span<float> layer = result.add(Aov::sample_count).data();
    for (std::size_t i = 0; i < layer.size(); ++i) layer[i] = made.stats.data()[2 * i + 1];
  }
  report.mean_rejected = mean_of(decided.data(), 4, 0);
  report.mean_sample_count = mean_of(made.stats.data(), 2, 1);
  return result;
}

void AntialiasFilter::State::add_diagnostics(std::span<const float> decided, Frame& result) {
  const auto add = [&](Aov aov, std::size_t value, auto convert) {
    if (!contains(task.diagnostics, aov)) return;
    const std::span<float> layer = result.add(aov).data();
    for (std::size_t i = 0; i < layer.size(); ++i) layer[i] = convert(decided[4 * i + value]);
  };
  add(Aov::error_mask, 0, [](float x) { return x; });
  add(Aov::bias, 1, [&](float x) { return std::sqrt(x) / scale; });
  add(Aov::gain, 2, [](float x) { return x; });
  if (contains(task.diagnostics, Aov::flow)) {
    result.image(Aov::flow) = download(passes->chain, passes->offset, task.full, 2);
  }
}

FilterMemory AntialiasFilter::memory() const {
  FilterMemory memory{.tiles = 1, .tile = state_->task.full, .tile_plan = "1"};
  add_memory(memory, state_->passes->chain);
  if (state_->combiner) memory += state_->combiner->memory();
  return memory;
}

}  // namespace becalm::filter
