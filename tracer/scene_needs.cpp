#include "tracer/scene_needs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tracer/scene/scene.h"

namespace becalm::tracer {

SceneNeeds compute_needs(const SceneDescription& description) {
  SceneNeeds needs;
  for (const Object& object : description.objects) {
    const Material& material = description.materials[object.material];
    const bool delta = is_specular(material.bsdf);
    needs.specular = needs.specular || delta;
    needs.rough_specular =
        needs.rough_specular || (!delta && !std::holds_alternative<DiffuseBsdf>(material.bsdf));
    needs.transmission = needs.transmission || std::holds_alternative<DielectricBsdf>(material.bsdf);
    needs.textures = needs.textures || has_textures(material);
    needs.area_lights = needs.area_lights || object.emissive;
    needs.changing_emission = needs.changing_emission || (object.emissive && object.emission.animated());
    const bool moving = object.transform.animated();
    needs.moving_objects = needs.moving_objects || moving;
    ++(moving ? needs.instances : needs.static_objects);
    needs.triangles += description.meshes[object.mesh].triangles.size();
  }
  needs.environment = description.environment && description.environment->total() > 0.0;
  needs.environment_image = needs.environment && description.environment_is_image;
  needs.moving_camera = description.camera.look_at.animated();
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
  sort(needs.moving_camera, "moving camera");
  sort(needs.moving_objects, "instances that move");
  sort(needs.changing_emission, "changing emission");
  const auto list = [](const std::vector<std::string>& names) {
    return names.empty() ? std::string("nothing") : fmt::format("{}", fmt::join(names, ", "));
  };

  std::vector<std::string> lines;
  lines.push_back(fmt::format("frames:    {}-{} at {} per second", description.frames.first,
                              description.frames.last, description.frames.rate));
  lines.push_back(fmt::format("film:      {}x{}", description.film.width, description.film.height));
  lines.push_back(fmt::format("geometry:  {} static and {} moving objects, {} triangles",
                              needs.static_objects, needs.instances, needs.triangles));
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
