// Feeds bytes to the OBJ loader, with and without the materials that they name. Whatever they are, the loader
// returns sound meshes or throws Error.
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "frame/error.h"
#include "tests/scratch_folder.h"
#include "tracer/scene/load/mtl.h"
#include "tracer/scene/load/obj.h"

namespace {

using becalm::tracer::Mesh;

void check(const Mesh& mesh) {
  const auto require = [](bool holds) {
    if (!holds) std::abort();
  };
  require(!mesh.triangles.empty());
  require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
  require(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size());
  for (const auto& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) require(corner < mesh.positions.size());
  }
  for (const auto& position : mesh.positions) {
    for (int i = 0; i < 3; ++i) require(std::isfinite(position[i]));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const becalm::ScratchFolder folder;
  // The same bytes as a mesh and as the library that it may name.
  const std::string path = folder.write("mesh.obj", data, size);
  folder.write("a.mtl", data, size);
  try {
    check(becalm::tracer::load_obj(path));
  } catch (const becalm::Error&) {
  }
  try {
    const becalm::tracer::ObjParts parts = becalm::tracer::load_obj_parts(path);
    for (const auto& part : parts.parts) check(part.mesh);
    becalm::tracer::Textures textures;
    std::vector<std::string> warnings;
    becalm::tracer::load_part_materials(path, parts, textures, warnings);
  } catch (const becalm::Error&) {
  }
  return 0;
}
