#pragma once

#include "tracer/scene/load/load_values.h"
#include "tracer/scene/scene_description.h"

// One reader for each section of the scene file. All throw Error(bad_input) at the JSON value that is wrong.

namespace becalm::tracer {

FrameRange read_frames(const JsonValue& json);
Film read_film(const JsonValue& json);
Integrator read_integrator(const JsonValue& json);
CameraSettings read_camera(const JsonValue& json);

/// Adds the lights that are no objects: {"name": {"type": "point", ...}, ...} or a list of them.
void read_lights(const JsonValue& json, SceneDescription& scene);

/// Sets the scene's environment.
void read_environment(const JsonValue& json, SceneDescription& scene);

/// Adds the materials, and the images that they name, to the scene. Returns their numbers.
Names read_materials(const JsonValue& json, SceneDescription& scene);

/// A part of a mesh whose file brings its own materials.
struct MeshPart {
  std::uint32_t mesh;
  std::uint32_t material;
  V3f emission;
};

/// Numbers of what objects refer to.
struct SceneNames {
  Names materials, media, meshes;
  std::map<std::uint32_t, std::vector<MeshPart>> parts;  ///< by the mesh's number
};

/// Adds the section's meshes, and the materials that they bring.
void read_meshes(const JsonValue& json, SceneNames& names, SceneDescription& scene);

/// Adds the object with the light group that it names: an object for each part of its mesh, and the copies
/// that "scatter" asks for.
void read_object(const JsonValue& json, const SceneNames& names, SceneDescription& scene);

}  // namespace becalm::tracer
