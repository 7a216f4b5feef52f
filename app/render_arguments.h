#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/asked_aovs.h"
#include "app/frame_size.h"
#include "app/options.h"
#include "tracer/render.h"
#include "tracer/snapshot/scene.h"

namespace becalm::app {

/// What the user typed after `becalm render`.
struct RenderCommand {
  std::string scene;
  OutputOptions output;
  FilterOptions filter;
  RunningOptions running;
  std::optional<int> asked_spp;
  int spp = 8;  ///< with a noise target the most; see set_defaults
  bool adaptive = false;
  std::optional<double> noise_target;
  std::string time_budget;  ///< of a frame; empty: none
  std::string choice;       ///< what was chosen for the time, for the user to read
  std::optional<int> asked_aov_spp;
  int aov_spp = 16;
  std::string size;
  std::uint32_t seed = 0;
  std::string aovs = "none";
  std::string type = "half";  ///< of the colours
  bool checkerboard = false;
  std::string preset;  ///< of --denoise, or kAutoPreset; empty: no filter
  std::string keep_noisy;
  std::string debug_pixel;
  std::string eye = "both";
};

void add_render_options(CLI::App& parser, RenderCommand& command);

/// What --denoise without a value stands for: with --time-budget the preset that gives the least error in the
/// time, else `balanced`.
inline constexpr const char* kAutoPreset = "auto";

/// All of these throw Error(usage) naming the option, the value and what was expected.
Size size_of(const RenderCommand& command, const tracer::SceneDescription& scene);
std::vector<int> frames_of(const RenderCommand& command, const tracer::SceneDescription& scene);
/// The distance of the frames of the shot that is asked for: 2 of 1-100x2, a shot on twos.
int frame_step(const RenderCommand& command);
/// parse_aovs of the command, after set_defaults. A single sample has no halves: `all` leaves them out.
AskedAovs asked_aovs(const RenderCommand& command);
tracer::PixelSample parse_pixel_sample(const std::string& text);
/// The eyes that are rendered: one, or of a camera with two those of --eye.
std::vector<Eye> eyes_of(const RenderCommand& command, const tracer::SceneDescription& scene);
/// Refuses options of the filter without --denoise, options that exclude each other, and a missing -o.
void check_options_fit(const RenderCommand& command);
/// What the samples and the preset are where the user does not say.
void set_defaults(RenderCommand& command, const tracer::SceneDescription& scene);

/// Everything that decides the value of a sample.
tracer::RenderOptions render_options(const RenderCommand& command, const Size& size);

}  // namespace becalm::app
