#pragma once

#include <string>

#include "tracer/snapshot/scene.h"

namespace becalm::tracer {

/// Reads a JSON scene file with the meshes and images that it names; paths in it are relative to the file.
/// Whatever is wrong throws Error(bad_input) with one line: `FILE: /json/pointer: message` for a value,
/// `FILE:LINE:COLUMN: message` for the syntax, the mesh's file for a mesh. Keys that are not known are
/// errors.
Scene load_scene(const std::string& file);

}  // namespace becalm::tracer
