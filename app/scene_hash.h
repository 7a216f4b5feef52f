#pragma once

#include <string>
#include <vector>

namespace becalm::app {

/// A scene file and every file that it or its meshes name.
std::vector<std::string> files_of_scene(const std::string& scene_file);

/// Sixteen hexadecimal digits that stand for the content of these files: equal for copies on other machines,
/// different after any edit. Throws Error(bad_input) if one cannot be read.
std::string scene_hash(const std::vector<std::string>& files);

}  // namespace becalm::app
