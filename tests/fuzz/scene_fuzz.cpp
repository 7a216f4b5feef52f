// Feeds bytes to the scene loader and renders a few paths of what loads. Bad input must only ever throw
// Error, and no path may be anything but finite or counted.
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "frame/error.h"
#include "tests/scratch_folder.h"
#include "tracer/render.h"
#include "tracer/scene/load/load.h"

namespace {

using nlohmann::json;

/// Sizes that the loader allows and that only cost time here: larger ones become these.
struct Limit {
  const char* key;
  double most;
};
constexpr Limit kLimits[] = {{"count", 40},     {"segments", 32}, {"resolution", 64},
                             {"width", 8},      {"trains", 8},    {"octaves", 4},
                             {"max_depth", 20}, {"blades", 64},   {"roulette_depth", 10}};

void limit_sizes(json& value) {
  if (value.is_array()) {
    for (json& element : value) limit_sizes(element);
  }
  if (!value.is_object()) return;
  for (auto& [key, member] : value.items()) {
    for (const Limit& limit : kLimits) {
      if (key != limit.key) continue;
      for (json* number : {&member, member.is_array() && !member.empty() ? &member.front() : &member}) {
        if (number->is_number() && number->get<double>() > limit.most) *number = static_cast<int>(limit.most);
      }
      if (key == "resolution" && member.is_array()) {
        for (json& axis : member) {
          if (axis.is_number() && axis.get<double>() > 16.0) axis = 16;
        }
      }
    }
    limit_sizes(member);
  }
}

/// The text with such sizes cut down; the text itself where it is no JSON, which is the loader's to say.
std::string limited(const std::uint8_t* data, std::size_t size) {
  std::string text(reinterpret_cast<const char*>(data), size);
  json document = json::parse(text, nullptr, false);
  if (document.is_discarded()) return text;
  limit_sizes(document);
  return document.dump(-1, ' ', false, json::error_handler_t::replace);
}

void render(becalm::tracer::Scene& scene) {
  using becalm::Aov;
  becalm::tracer::RenderOptions options;
  options.width = options.height = 4;
  options.spp = 1;
  options.light_groups = true;
  for (const Aov aov : {Aov::variance, Aov::albedo, Aov::normal, Aov::depth, Aov::motion, Aov::direct,
                        Aov::indirect, Aov::object_id, Aov::material_id})
    options.aovs.set(static_cast<std::size_t>(aov));
  const auto& frames = scene.description().frames;
  for (const int frame : {frames.first, frames.last}) {
    const auto result = becalm::tracer::render_frame(scene, frame, options);
    for (const float v : result->image(Aov::beauty).data()) {
      if (!std::isfinite(v) || v < 0.0f) std::abort();
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const becalm::ScratchFolder folder;
  static const std::string mesh =
      folder.write("mesh.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  static const std::string library = folder.write("a.mtl", "newmtl m\nKd 0.5 0.5 0.5\nKe 1 1 1\nd 0.5\n");
  static const std::string image = folder.write("a.ppm", "P3 2 2 255 255 0 0 0 255 0 0 0 255 90 90 90\n");
  // One thread: runs repeat, and the fuzzer uses a process a core.
  static const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
  try {
    becalm::tracer::Scene scene = becalm::tracer::load_scene(folder.write("scene.json", limited(data, size)));
    render(scene);
  } catch (const becalm::Error&) {
  }
  return 0;
}
