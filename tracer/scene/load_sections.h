#pragma once

#include "tracer/scene/load_values.h"
#include "tracer/scene/scene.h"

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

Geometry read_mesh(const JsonValue& json, const std::string& scene_file);

/// Numbers of what objects refer to.
struct SceneNames {
  Names materials, media, meshes;
};

/// Adds the light group that the object names.
Object read_object(const JsonValue& json, const SceneNames& names, SceneDescription& scene);

/// Adds the object, or the copies of it that "scatter" asks for. `objects` are those read so far, by name.
void read_objects(const JsonValue& json, const SceneNames& names, SceneDescription& scene);

}  // namespace becalm::tracer
