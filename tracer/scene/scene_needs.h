#pragma once

#include <cstddef>

namespace becalm::tracer {

struct SceneDescription;

/// What a scene requires of the tracer; what it does not require is neither built nor executed. Computed
/// once, when the scene is loaded.
struct SceneNeeds {
  bool area_lights = false;        ///< an emissive object in some frame
  bool punctual_lights = false;    ///< points and spots: light that paths cannot run into
  bool suns = false;               ///< discs at infinity
  bool environment = false;        ///< light from infinity that is not black
  bool environment_image = false;  ///< ... from an image, which is importance-sampled
  bool specular = false;           ///< perfect mirrors or glass: albedo and normal are followed through them
  bool rough_specular = false;     ///< microfacet lobes
  bool transmission = false;       ///< paths that cross surfaces
  bool textures = false;           ///< image lookups, and the ray differentials that choose their MIP level
  bool relief = false;             ///< bump and normal maps
  bool mix = false;                ///< materials mixed of others
  bool tangents = false;           ///< anisotropic lobes: shading frames follow uv
  bool alpha = false;              ///< filter functions for rays that pass through cut-out surfaces
  bool procedurals = false;        ///< marched surfaces: user geometry, normals averaged over footprints
  bool media = false;              ///< scattering and absorption inside objects
  bool moving_camera = false;
  bool moving_objects = false;     ///< instances whose transforms are set for each frame
  bool motion_blur = false;        ///< the camera or an object moves while the shutter is open
  bool depth_of_field = false;     ///< a lens with a width
  bool moving_lights = false;      ///< points and spots whose place changes
  bool changing_emission = false;  ///< lights whose light or place changes: light lists built for each frame
  std::size_t static_objects = 0;
  std::size_t moving_object_count = 0;
  std::size_t triangles = 0;  ///< of all objects, each counted by itself
};

SceneNeeds compute_needs(const SceneDescription& description);

}  // namespace becalm::tracer
