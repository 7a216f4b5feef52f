#pragma once

#include <string>

namespace becalm::tracer::test {

/// How the scene with everything differs from itself.
struct EverythingSettings {
  double unit = 1.0;  ///< length of what is 1 otherwise; light and media change so that the picture does not
  std::string film = "'width': 32, 'height': 24";
  std::string integrator = "'max_depth': 5";
  bool scatters_in_media = true;  ///< or only absorbs
};

/// A scene of 5 frames with every kind of geometry, material, light and medium, textures, opacity, relief,
/// instances, motion blur and depth of field. Writes its image files beside the scene of the running test.
std::string everything_scene(const EverythingSettings& settings = {});

}  // namespace becalm::tracer::test
