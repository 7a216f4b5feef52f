#pragma once

#include <string>

namespace becalm::app {

/// Sixteen hexadecimal digits that stand for the content of a scene file and of every file that it or its
/// meshes name:
/// equal for copies on other machines, different after any edit. Throws Error(bad_input) if the scene file
/// cannot be read.
std::string scene_hash(const std::string& scene_file);

}  // namespace becalm::app
