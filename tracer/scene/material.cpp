#include "tracer/scene/material.h"

#include <algorithm>
#include <set>

namespace becalm::tracer {

namespace {

/// Reads an input's constant.
struct Constants {
  template <class T>
  T operator()(const MaterialInput<T>& input) const {
    return input.value;
  }
};

/// Reads an input's value at a place.
struct Lookup {
  const Textures::Reader& textures;
  const TexturePoint& point;

  V3f operator()(const ColorInput& input) const {
    return input.texture == kNoTexture ? input.value : textures.color(input.texture, point);
  }
  float operator()(const ScalarInput& input) const {
    return input.texture == kNoTexture ? input.value
                                       : std::clamp(textures.scalar(input.texture, point), 0.0f, 1.0f);
  }
};

template <class Values>
Bsdf make_bsdf(const DiffuseMaterial& m, const Values& at) {
  return DiffuseBsdf{at(m.reflectance)};
}

template <class Values>
Bsdf make_bsdf(const ConductorMaterial& m, const Values& at) {
  const ConductorIor ior = m.ior ? *m.ior : conductor_from_reflectance(at(m.reflectance));
  return ConductorBsdf{ior.eta, ior.k, roughness_to_alpha(at(m.roughness))};
}

template <class Values>
Bsdf make_bsdf(const DielectricMaterial& m, const Values& at) {
  return DielectricBsdf{m.ior, roughness_to_alpha(at(m.roughness)), at(m.transmittance)};
}

template <class Values>
Bsdf make_bsdf(const PrincipledMaterial& m, const Values& at) {
  return make_principled({.base_color = at(m.base_color),
                          .metallic = at(m.metallic),
                          .roughness = at(m.roughness),
                          .ior = m.ior,
                          .anisotropy = at(m.anisotropy),
                          .anisotropy_rotation = at(m.anisotropy_rotation),
                          .sheen = at(m.sheen),
                          .sheen_tint = at(m.sheen_tint),
                          .clearcoat = at(m.clearcoat),
                          .clearcoat_roughness = at(m.clearcoat_roughness),
                          .transmission = at(m.transmission)});
}

/// A mix has no BSDF of its own; it is resolved first.
template <class Values>
Bsdf make_bsdf(const MixMaterial&, const Values&) {
  return DiffuseBsdf{V3f(0.0f)};
}

template <class T>
bool is_textured(const MaterialInput<T>& input) {
  return input.texture != kNoTexture;
}

/// Calls `use` with each input of a model that may be textured.
template <class Use>
void for_each_input(const DiffuseMaterial& m, const Use& use) {
  use(m.reflectance);
}
template <class Use>
void for_each_input(const ConductorMaterial& m, const Use& use) {
  use(m.reflectance), use(m.roughness);
}
template <class Use>
void for_each_input(const DielectricMaterial& m, const Use& use) {
  use(m.roughness), use(m.transmittance);
}
template <class Use>
void for_each_input(const PrincipledMaterial& m, const Use& use) {
  use(m.base_color);
  for (const ScalarInput* input : {&m.metallic, &m.roughness, &m.anisotropy, &m.anisotropy_rotation, &m.sheen,
                                   &m.sheen_tint, &m.clearcoat, &m.clearcoat_roughness, &m.transmission})
    use(*input);
}
template <class Use>
void for_each_input(const MixMaterial& m, const Use& use) {
  use(m.factor);
}

/// The textures of its BSDF.
std::set<std::uint32_t> textures_of(const MaterialModel& model) {
  std::set<std::uint32_t> textures;
  const auto add = [&](const auto& input) {
    if (is_textured(input)) textures.insert(input.texture);
  };
  std::visit([&](const auto& m) { for_each_input(m, add); }, model);
  return textures;
}

// Where a parameter is textured, it may take any value.
bool may_be_smooth(const ScalarInput& roughness) {
  return is_textured(roughness) || roughness_to_alpha(roughness.value) < kSmoothAlpha;
}
bool may_be_rough(const ScalarInput& roughness) {
  return is_textured(roughness) || roughness_to_alpha(roughness.value) >= kSmoothAlpha;
}
bool may_be_positive(const ScalarInput& weight) {
  return is_textured(weight) || weight.value > 0.0f;
}

void add_lobes(MaterialNeeds&, const DiffuseMaterial&) {}

void add_lobes(MaterialNeeds& needs, const ConductorMaterial& m) {
  needs.delta_lobes |= may_be_smooth(m.roughness);
  needs.rough_specular |= may_be_rough(m.roughness);
}

void add_lobes(MaterialNeeds& needs, const DielectricMaterial& m) {
  // Narrow refraction is smooth as well: ask the BSDF.
  const auto smooth_at = [&](float roughness) {
    return is_specular(DielectricBsdf{m.ior, roughness_to_alpha(roughness), V3f(1.0f)});
  };
  const bool varies = is_textured(m.roughness);
  needs.delta_lobes |= varies || smooth_at(m.roughness.value);
  needs.rough_specular |= !smooth_at(varies ? 1.0f : m.roughness.value);
  needs.transmission = true;
}

void add_lobes(MaterialNeeds& needs, const PrincipledMaterial& m) {
  const bool coated = may_be_positive(m.clearcoat);
  needs.delta_lobes |= may_be_smooth(m.roughness) || (coated && may_be_smooth(m.clearcoat_roughness));
  needs.rough_specular |= may_be_rough(m.roughness) || (coated && may_be_rough(m.clearcoat_roughness));
  needs.transmission |=
      may_be_positive(m.transmission) && (is_textured(m.metallic) || m.metallic.value < 1.0f);
  needs.tangents |= may_be_positive(m.anisotropy);
}

void add_lobes(MaterialNeeds& needs, const MixMaterial&) {
  needs.mix = true;
}

/// Visits each material once: mixes that name one part twice on every level would otherwise take exponential
/// time.
void add_needs(MaterialNeeds& needs, std::span<const Material> materials, const Material& material,
               std::set<const Material*>& seen) {
  if (!seen.insert(&material).second) return;
  needs.textures |= material.textured || has_relief(material);
  needs.relief |= has_relief(material);
  needs.tangents |= has_relief(material);
  if (material.is_interface) {
    needs.interface = needs.transmission = true;
    return;
  }
  MaterialNeeds own;
  std::visit([&](const auto& model) { add_lobes(own, model); }, material.model);
  needs.delta_lobes |= own.delta_lobes;
  needs.rough_specular |= own.rough_specular;
  needs.transmission |= own.transmission;
  needs.tangents |= own.tangents;
  needs.mix |= own.mix;
  needs.specular |= material.textured ? own.delta_lobes : is_specular(material.bsdf);
  if (const auto* mix = std::get_if<MixMaterial>(&material.model)) {
    add_needs(needs, materials, materials[mix->first], seen);
    add_needs(needs, materials, materials[mix->second], seen);
  }
}

}  // namespace

std::set<std::uint32_t> textures_of(std::span<const Material> materials, std::set<std::uint32_t> used) {
  std::set<std::uint32_t> textures;
  std::set<std::uint32_t> seen;
  while (!used.empty()) {
    const std::uint32_t number = *used.begin();
    used.erase(used.begin());
    if (!seen.insert(number).second) continue;
    const Material& material = materials[number];
    textures.merge(textures_of(material.model));
    if (material.bump) textures.insert(material.bump->texture);
    if (material.normal_map) textures.insert(material.normal_map->texture);
    if (const auto* mix = std::get_if<MixMaterial>(&material.model)) used.insert({mix->first, mix->second});
  }
  return textures;
}

void finish_material(Material& material) {
  // The tables of anisotropic lobes are made now and not when the first path needs them.
  if (const auto* m = std::get_if<PrincipledMaterial>(&material.model); m && is_textured(m->anisotropy))
    make_principled({.anisotropy = 1.0f});
  material.textured = !textures_of(material.model).empty();
  material.bsdf = std::visit([](const auto& model) { return make_bsdf(model, Constants{}); }, material.model);
}

Bsdf evaluate_material(const Material& material, const Textures::Reader& textures,
                       const TexturePoint& point) {
  if (!material.textured) return material.bsdf;
  return std::visit(
      [&](const auto& model) {
        return make_bsdf(model, Lookup{textures, point});
      },
      material.model);
}

const Material& resolve_mix(std::span<const Material> materials, const Material& material,
                            const Textures::Reader& textures, const TexturePoint& point, float u) {
  constexpr float last_below_one = 0x1.fffffep-1f;
  const Material* chosen = &material;
  while (const auto* mix = std::get_if<MixMaterial>(&chosen->model)) {
    const float first_share = 1.0f - Lookup{textures, point}(mix->factor);
    const bool first = u < first_share;
    // Uniform again, whatever was chosen.
    u = std::min(last_below_one, first ? u / first_share : (u - first_share) / (1.0f - first_share));
    chosen = &materials[first ? mix->first : mix->second];
  }
  return *chosen;
}

MaterialNeeds material_needs(std::span<const Material> materials, const Material& material) {
  MaterialNeeds needs;
  std::set<const Material*> seen;
  add_needs(needs, materials, material, seen);
  needs.alpha = has_alpha(material);
  return needs;
}

}  // namespace becalm::tracer
