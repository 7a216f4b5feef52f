#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/options.h"
#include "frame/aov.h"
#include "tracer/render.h"
#include "tracer/snapshot/scene.h"

namespace becalm::app {

/// What the user typed after `becalm render`.
struct RenderCommand {
  std::string scene;
  OutputOptions output;
  FilterOptions filter;
  RunningOptions running;
  int spp = 8;
  int aov_spp = 16;
  std::string size;
  std::uint32_t seed = 0;
  std::string aovs = "none";
  bool float_colors = false;
  std::string preset;  ///< of --denoise; empty: no filter
  std::string keep_noisy;
  std::string debug_pixel;
};

struct Size {
  int width = 0;
  int height = 0;
};

/// All of these throw Error(usage) naming the option, the value and what was expected.
Size size_of(const RenderCommand& command, const tracer::SceneDescription& scene);
std::vector<int> frames_of(const RenderCommand& command, const tracer::SceneDescription& scene);
/// What --aovs names: AOVs of the tracer, and whether the radiance of each light group.
struct AskedAovs {
  AovSet aovs;
  bool light_groups = false;
};
AskedAovs parse_aovs(const std::string& text);
tracer::PixelSample parse_pixel_sample(const std::string& text);
/// Refuses options of the filter without --denoise, and a missing -o.
void check_options_fit(const RenderCommand& command);

/// The inverse of parse_aovs.
std::string format_aovs(const AskedAovs& asked);

/// Everything that decides the value of a sample.
tracer::RenderOptions render_options(const RenderCommand& command, const Size& size);

}  // namespace becalm::app
