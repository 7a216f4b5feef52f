#include "tracer/scene_needs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tracer/scene/scene.h"

namespace becalm::tracer {

SceneNeeds compute_needs(const SceneDescription& description) {
  SceneNeeds needs;
  for (const Object& object : description.objects) {
    const MaterialNeeds material =
        material_needs(description.materials, description.materials[object.material]);
    needs.specular = needs.specular || material.specular;
    needs.rough_specular = needs.rough_specular || material.rough_specular;
    needs.transmission = needs.transmission || material.transmission;
    needs.textures = needs.textures || material.textures;
    needs.relief = needs.relief || material.relief;
    needs.mix = needs.mix || material.mix;
    needs.tangents = needs.tangents || material.tangents;
    needs.alpha = needs.alpha || material.alpha;
    needs.procedurals =
        needs.procedurals || std::holds_alternative<ProceduralDescription>(description.meshes[object.mesh]);
    needs.media = needs.media || object.interior.has_value() || material.interface;
    needs.area_lights = needs.area_lights || object.emissive;
    needs.changing_emission = needs.changing_emission || (object.emissive && object.emission.animated());
    const bool moving = object.transform.animated();
    needs.moving_objects = needs.moving_objects || moving;
    ++(moving ? needs.moving_object_count : needs.static_objects);
    needs.triangles += triangle_count(description.meshes[object.mesh]);
  }
  needs.environment = description.environment && description.environment->total() > 0.0;
  needs.environment_image = needs.environment && description.environment_is_image;
  const CameraSettings& camera = description.camera;
  needs.moving_camera = camera.look_at.animated();
  needs.motion_blur = camera.shutter.blurs() && (needs.moving_objects || camera.moves());
  needs.depth_of_field = camera.has_lens();
  return needs;
}

std::vector<std::string> describe_scene(const Scene& scene) {
  const SceneDescription& description = scene.description();
  const SceneNeeds& needs = scene.needs();
  std::vector<std::string> required, left_out;
  const auto sort = [&](bool needed, const char* name) { (needed ? required : left_out).emplace_back(name); };
  sort(needs.area_lights, "area lights");
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
  sort(needs.changing_emission, "changing emission");
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
  if (description.environment && description.environment->replaced_values() > 0) {
    lines.push_back(
        fmt::format("note:      {} values of the environment image were NaN, infinite or negative and were "
                    "replaced",
                    description.environment->replaced_values()));
  }
  return lines;
}

}  // namespace becalm::tracer
