#pragma once

#include "app/render_arguments.h"
#include "tracer/snapshot/scene.h"

namespace becalm::app {

/// `render --time-budget`: sets adaptive sampling, the number of samples, the preset unless the user named
/// one, and the text that tells them. They are those of the outputs or noisy frames that --resume finds, else
/// those that leave the least error in the time, as measured here: of a pilot of the first frame, and of the
/// presets on it. Filter and tracer are taken to share the processors. Throws Error(usage).
void choose_by_time(RenderCommand& command, tracer::Scene& scene);

}  // namespace becalm::app
