#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/end_to_end/harness.h"

namespace becalm::test {

/// The harness's scene in a folder of its own, and the command that renders it.
class Render : public testing::Test {
 protected:
  std::vector<std::string> command(const std::string& pattern,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"render", scene_, "-o", folder_ / pattern, "--quiet"};
    if (!has_option(more, "--spp")) arguments.insert(arguments.end(), {"--spp", "2"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  Outcome render(const std::string& pattern, const std::vector<std::string>& more = {}) const {
    return becalm_done(command(pattern, more));
  }
  /// A scene of one object, of mesh.obj with its own materials.
  void write_mesh_scene(const std::string& object) const {
    write_text(
        scene_,
        fmt::format(
            R"({{"film": {{"width": 16, "height": 16}}, "camera": {{"look_at": {{"eye": [0, 0, 4], "target": [0, 0, 0]}}}},
    "environment": {{"radiance": [1, 1, 1]}}, "frames": {{"first": 1, "last": 2}}, "materials": {{}},
    "meshes": {{"t": {{"obj": "mesh.obj", "materials": "mtl"}}}}, "objects": [{{"name": "{}", "mesh": "t"}}]}})",
            object));
  }

  TempFolder folder_;
  std::string scene_ = write_scene(folder_);
};

}  // namespace becalm::test
