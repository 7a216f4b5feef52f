#include "tracer/scene/scene_needs.h"

#include "tracer/scene/scene_description.h"

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
  for (const LightDescription& light : description.lights) {
    const bool sun = std::holds_alternative<SunDescription>(light);
    needs.suns = needs.suns || sun;
    needs.punctual_lights = needs.punctual_lights || !sun;
    needs.changing_emission = needs.changing_emission || animated(light);
    needs.moving_lights = needs.moving_lights || moves(light);
  }
  needs.environment = description.environment && description.environment->total() > 0.0;
  needs.environment_image = needs.environment && description.environment_is_image;
  const CameraSettings& camera = description.camera;
  needs.moving_camera = camera.look_at.animated();
  needs.motion_blur =
      camera.shutter.blurs() && (needs.moving_objects || needs.moving_lights || camera.moves());
  needs.depth_of_field = camera.has_lens();
  return needs;
}

}  // namespace becalm::tracer
