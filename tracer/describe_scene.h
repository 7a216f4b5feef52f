#pragma once

#include <string>
#include <vector>

#include "tracer/snapshot/scene.h"

namespace becalm::tracer {

/// Lines of text for `becalm info`: the scene's size, what it requires, what was left out because of that,
/// and what follows: the integrator's variant, and hierarchies and memory at the first frame, which it
/// builds. Throws as Scene::at_frame does.
std::vector<std::string> describe_scene(Scene& scene);

}  // namespace becalm::tracer
