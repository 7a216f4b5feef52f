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

Object read_object(const JsonValue& json, const Names& meshes, const Names& materials);

}  // namespace becalm::tracer
