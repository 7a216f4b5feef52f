#include "tracer/describe_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "frame/mebibytes.h"
#include "tracer/path_trace.h"
#include "tracer/snapshot/snapshot.h"

namespace becalm::tracer {

namespace {

std::size_t mesh_bytes(const SceneDescription& description) {
  std::size_t sum = 0;
  for (const Geometry& geometry : description.meshes) {
    if (const Mesh* mesh = std::get_if<Mesh>(&geometry)) sum += mesh->bytes();
  }
  return sum;
}

std::string size_text(std::size_t bytes) {
  return fmt::format("{:.1f} MiB", mebibytes(bytes));
}

/// What was built and chosen for the scene.
void describe_consequences(Scene& scene, std::vector<std::string>& lines) {
  const SceneNeeds& needs = scene.needs();
  const Snapshot& snapshot = scene.at_frame(scene.description().frames.first);
  const GeometrySize size = snapshot.intersector().size();
  lines.push_back(fmt::format("variant:   '{}' of the path integrator, '{}' with AOVs of surfaces",
                              select_path_variant(needs, false).name, select_path_variant(needs, true).name));
  lines.push_back(fmt::format(
      "hierarchy: {} objects baked into one, {} instances{}{}; {} triangles stored, {} visible",
      size.baked_objects, size.instances,
      size.motion_instances > 0 ? fmt::format(", {} of them with motion steps", size.motion_instances) : "",
      needs.alpha ? ", filter functions on what has opacity" : "", size.stored_triangles,
      size.visible_triangles));
  std::string memory =
      fmt::format("memory:    {} by Embree's count", size_text(static_cast<std::size_t>(size.embree_bytes)));
  if (size.stored_triangles > 0) {
    const double per_triangle =
        static_cast<double>(size.embree_bytes) / static_cast<double>(size.stored_triangles);
    memory += fmt::format(" ({:.0f} bytes a stored triangle)", per_triangle);
    memory += fmt::format(", {} of meshes", size_text(mesh_bytes(scene.description())));
  }
  if (needs.textures)
    memory += fmt::format(", {} of textures", size_text(scene.description().textures.resident_bytes()));
  if (needs.procedurals)
    memory += fmt::format(", {} of procedural surfaces", size_text(snapshot.procedural_bytes()));
  if (needs.media) memory += fmt::format(", {} of media", size_text(snapshot.media_bytes()));
  lines.push_back(memory);
}

}  // namespace

std::vector<std::string> describe_scene(Scene& scene) {
  const SceneDescription& description = scene.description();
  const SceneNeeds& needs = scene.needs();
  std::vector<std::string> required, left_out;
  const auto sort = [&](bool needed, const char* name) { (needed ? required : left_out).emplace_back(name); };
  sort(needs.area_lights, "area lights");
  sort(needs.punctual_lights, "points and spots");
  sort(needs.suns, "suns");
  sort(needs.environment, "environment");
  sort(needs.environment_image, "environment image");
  sort(needs.specular, "perfect mirrors or glass");
  sort(needs.rough_specular, "microfacets");
  sort(needs.transmission, "transmission");
  sort(needs.textures, "textures");
  sort(needs.relief, "bump and normal maps");
  sort(needs.mix, "mixed materials");
  sort(needs.tangents, "tangent frames");
  sort(needs.alpha, "opacity");
  sort(needs.procedurals, "procedural surfaces");
  sort(needs.media, "media");
  sort(needs.moving_camera, "moving camera");
  sort(needs.moving_objects, "instances that move");
  sort(needs.motion_blur, "motion blur");
  sort(needs.depth_of_field, "depth of field");
  sort(needs.changing_emission, "changing lights");
  sort(description.camera.has_two_eyes(), "two eyes");
  const auto list = [](const std::vector<std::string>& names) {
    return names.empty() ? std::string("nothing") : fmt::format("{}", fmt::join(names, ", "));
  };

  std::vector<std::string> lines;
  lines.push_back(fmt::format("frames:    {}-{} at {} per second", description.frames.first,
                              description.frames.last, description.frames.rate));
  lines.push_back(fmt::format("film:      {}x{}", description.film.width, description.film.height));
  lines.push_back(fmt::format("geometry:  {} static and {} moving objects, {} triangles",
                              needs.static_objects, needs.moving_object_count, needs.triangles));
  lines.push_back("requires:  " + list(required));
  lines.push_back("left out:  " + list(left_out));
  describe_consequences(scene, lines);
  if (description.environment && description.environment->replaced_values() > 0) {
    lines.push_back(
        fmt::format("note:      {} values of the environment image were NaN, infinite or negative and were "
                    "replaced",
                    description.environment->replaced_values()));
  }
  return lines;
}

}  // namespace becalm::tracer
