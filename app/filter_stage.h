#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/options.h"
#include "app/pipeline.h"
#include "app/profile.h"
#include "app/progress.h"
#include "filter/gpu/device.h"
#include "filter/sequence/frame_filter.h"
#include "filter/settings.h"
#include "filter/stereo/stereo_filter.h"
#include "frame/frame.h"

namespace becalm::app {

/// Whether frames may hold every other pixel alone, and what tells which.
enum class Checkerboards { refused, as_files_tell, as_told };

/// What a FilterStage runs.
struct FilterRecipe {
  std::string settings;  ///< as files record them
  AovSet wanted;         ///< AOVs that it uses if frames have them
  filter::Directions directions;
  bool takes_additive;   ///< whether it can filter additive AOVs and light groups
  bool averages_alpha;   ///< whether alpha is always filtered with the beauty
  bool scales_radiance;  ///< whether it brings radiance of any size into the range of floats itself
  Checkerboards checkerboards = Checkerboards::refused;
  std::function<std::unique_ptr<filter::FrameFilter>(
      gpu::Device& device, int width, int height, AovSet available, const filter::SequenceOptions& options)>
      make;
  /// Filters both eyes of a pair together; empty if the filter knows no pairs.
  std::function<std::unique_ptr<filter::StereoFilter>(
      gpu::Device& device, int width, int height, AovSet available, const filter::SequenceOptions& options)>
      make_pair;
  /// Why the device cannot take frames of this window, for the user to read; empty if it can. No function:
  /// frames of any size are cut into tiles.
  std::function<std::string(const gpu::Device& device, const Imath::Box2i& window)> size_problem;
  /// For the user to read: how frames with these AOVs are matched.
  std::function<std::string(const AovSet& available)> describe_matching;
};

/// A view of the frames to be filtered.
struct FilteredView {
  std::string name;  ///< empty where there is but one
  AovSet available;
  std::vector<std::string> light_groups = {};  ///< their names
};

/// The denoiser, and temporal antialiasing, by a preset and the changes of `options`. Throw Error(usage).
FilterRecipe denoiser(const std::string& preset, const FilterOptions& options);
/// `scale` as AntialiasSettings have it.
FilterRecipe antialiaser(const std::string& preset, const FilterOptions& options, const Scale& scale,
                         Checkerboards checkerboards);

/// The filter in the pipeline of `denoise`, `antialias` and `render --denoise`: opens the device, builds the
/// chain once, and reports what happened to each frame.
class FilterStage {
 public:
  /// Throws Error(usage) for options that do not fit the filter, and a size that is none.
  FilterStage(FilterRecipe recipe, const FilterOptions& options);
  /// The denoiser. Throws Error(usage) for a preset or setting that does not exist, too.
  FilterStage(const std::string& preset, const FilterOptions& options)
      : FilterStage(denoiser(preset, options), options) {}

  AovSet wanted() const { return recipe_.wanted; }
  /// Whether alpha is filtered with the beauty, rather than passed on or denoised where it is noisy.
  bool averages_alpha() const { return recipe_.averages_alpha; }
  /// Whether alpha stays as it came.
  bool keeps_alpha() const { return !recipe_.averages_alpha && alpha_ == filter::Alpha::keep; }
  Checkerboards checkerboards() const { return recipe_.checkerboards; }
  /// Whether light groups and the AOVs of filter::additive_aovs() are denoised, too, where frames have them.
  bool denoises_additive() const { return denoises_additive_; }
  AovSet diagnostics() const { return diagnostics_; }
  /// Whether history is bounded by segments, each of which reads the frames around it again.
  bool has_segments() const { return segment_ > 0; }
  /// The settings as the files record them: equal text means that the filter does the same to a frame. It
  /// names the first frame that is read if there are no segments, since history begins there.
  std::string describe(const std::vector<int>& readable) const;
  /// Those of the existing frames that may be read: the ones asked for and what --context allows besides.
  /// `asked` and `existing` ascend.
  std::vector<int> readable(const std::vector<int>& asked, const std::vector<int>& existing) const;
  /// The frames that --context names; none for `none` and for the default.
  std::vector<int> context_frames() const;
  /// In which order frames pass through `run`. `step` is the usual distance between frame numbers.
  std::vector<filter::Segment> schedule(const std::vector<int>& readable, const std::set<int>& wanted,
                                        int step) const;

  /// Opens the device, if it is not open yet, and returns its name. Throws DeviceError if there is none such.
  const std::string& open_device();
  /// Throws Error(resource) naming the file where the device cannot take frames of this window.
  void require_size(const std::string& path, const Imath::Box2i& window);
  /// Opens the device and builds the chains; called before the first frame. All views share the memory. A
  /// left and a right eye are filtered together, unless the options say otherwise. Throws Error(bad_input)
  /// where they must be and are not a pair. `origin`: as SequenceOptions has it.
  void build(int width, int height, const std::vector<FilteredView>& views,
             const Imath::V2i& origin = Imath::V2i(0));
  /// FinishedFrame::expected_errors are wanted.
  void measure_expected_errors() { measures_errors_ = true; }
  /// What is done with several views, for the user to read; empty for one.
  std::string views_text() const;
  /// How frames are cut into tiles (of a stereo sequence: those of the first view), as files record it in
  /// `becalm:tiles`. Results do not depend on it, so --resume does not compare it.
  std::string tiles() const { return memory_of(0).tile_plan; }
  /// Takes the next step of a segment with all views of its frame; returns the denoised frame if the step
  /// makes one.
  std::optional<FinishedFrame> run(const filter::Step& step, io::LoadedFrame noisy, Progress& progress,
                                   Profile& profile);
  /// Throws DeviceError if the validation layer complained; tells the profile about the device.
  void finish(Profile& profile) const;

 private:
  filter::FilterMemory memory_of(std::size_t view) const;
  /// The filtered frames of all views; none if the step makes none.
  std::vector<Frame> run_views(const filter::Step& step, const std::vector<const Frame*>& frames,
                               std::vector<filter::FrameReport>& reports, Profile& profile);
  /// The same of frames whose radiance may be of any size, whatever the filter takes. Appends to
  /// `expected_errors` if they are wanted.
  std::vector<Frame> run_scaled(const filter::Step& step, const std::vector<const Frame*>& frames,
                                std::vector<filter::FrameReport>& reports,
                                std::vector<double>& expected_errors, Profile& profile);
  void tell(const filter::FrameReport& report, const std::string& name, Progress& progress);

  FilterRecipe recipe_;
  AovSet diagnostics_;
  filter::Alpha alpha_;
  bool denoises_additive_;
  gpu::DeviceOptions device_options_;
  MemoryLimit memory_limit_;
  int segment_ = 0;  ///< 0: none
  int warmup_ = 0;
  std::string context_;
  std::string cuts_;  ///< as typed
  std::set<int> given_cuts_;
  float radiance_scale_ = 1.0f;  ///< of the history
  bool measures_errors_ = false;
  bool has_told_of_shared_noise_ = false;
  std::optional<gpu::Device> device_;
  struct View {
    std::string name;                             ///< with a space before it; empty where there is but one
    std::unique_ptr<filter::FrameFilter> filter;  ///< none if `pair_` filters it
  };
  std::vector<View> views_;
  std::unique_ptr<filter::StereoFilter> pair_;
  std::optional<bool> stereo_;  ///< as FilterOptions::stereo
  std::string matched_;         ///< what frames are matched by; empty once it has been printed
};

/// What to tell of frames that are worked on besides those asked for; `work` is what is done to them.
std::string context_note(std::size_t frames, std::string_view work);

}  // namespace becalm::app
