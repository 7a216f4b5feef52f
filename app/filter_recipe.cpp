// What the filter stage can run: the denoiser, and temporal antialiasing.

#include "app/filter_stage.h"
#include "filter/align/guides.h"
#include "filter/antialias/antialias_filter.h"
#include "filter/sequence/sequence_filter.h"

namespace becalm::app {

FilterRecipe denoiser(const std::string& preset, const FilterOptions& options) {
  const filter::Settings settings = resolve_settings(preset, options);
  return {.settings = filter::to_string(settings),
          .wanted = filter::wanted_aovs(settings),
          .directions = settings.directions,
          .takes_additive = true,
          .averages_alpha = false,
          .scales_radiance = false,
          .make =
              [settings](gpu::Device& device, int width, int height, AovSet available,
                         const filter::SequenceOptions& sequence) {
                return std::make_unique<filter::SequenceFilter>(device, settings, width, height, available,
                                                                sequence);
              },
          .make_pair =
              [settings](gpu::Device& device, int width, int height, AovSet available,
                         const filter::SequenceOptions& sequence) {
                return std::make_unique<filter::StereoFilter>(device, settings, width, height, available,
                                                              sequence);
              },
          .size_problem = {},
          .describe_matching =
              [settings](const AovSet& available) { return filter::matched_text(settings, available); }};
}

FilterRecipe antialiaser(const std::string& preset, const FilterOptions& options, const Scale& scale,
                         Checkerboards checkerboards) {
  filter::AntialiasSettings settings = filter::antialias_preset(preset);
  for (const std::string& assignment : options.assignments) filter::set(settings, assignment);
  settings.scale = scale;
  settings.checkerboard = checkerboards != Checkerboards::refused;
  return {.settings = filter::to_string(settings),
          .wanted = filter::wanted_aovs(settings),
          .directions = settings.directions,
          .takes_additive = false,
          .averages_alpha = true,
          .scales_radiance = true,
          .checkerboards = checkerboards,
          .make =
              [settings](gpu::Device& device, int width, int height, AovSet available,
                         const filter::SequenceOptions& sequence) {
                return std::make_unique<filter::AntialiasFilter>(device, settings, width, height, available,
                                                                 sequence);
              },
          .make_pair = {},
          .size_problem =
              [settings](const gpu::Device& device, const Imath::Box2i& window) {
                return filter::size_problem(device, settings, window);
              },
          .describe_matching =
              [settings](const AovSet& available) { return filter::reprojected_text(settings, available); }};
}

}  // namespace becalm::app
