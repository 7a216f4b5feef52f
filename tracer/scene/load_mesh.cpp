#include "tracer/scene/load_procedural.h"
#include "tracer/scene/load_sections.h"
#include "tracer/scene/obj.h"
#include "tracer/scene/shapes.h"

namespace becalm::tracer {

Geometry read_mesh(const JsonValue& json, const std::string& scene_file) {
  if (json.has("obj")) {
    json.allow_keys({"obj"});
    const std::string path = beside(scene_file, json.at("obj").string());
    expect_file(json.at("obj"), path);
    return load_obj(path);
  }
  if (json.has("procedural")) return read_procedural(json);
  json.allow_keys({"shape", "segments"});
  const int segments = json.has("segments") ? json.at("segments").integer(3, 4096) : 64;
  switch (json.at("shape").choice({"rectangle", "disc", "sphere", "cube", "exact_sphere"})) {
    case 0:
      return make_rectangle();
    case 1:
      return make_disc(segments);
    case 2:
      return make_sphere(segments);
    case 3:
      return make_cube();
    default:
      return UnitSphere{};
  }
}

}  // namespace becalm::tracer
