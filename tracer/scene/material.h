#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <variant>

#include "tracer/materials/bsdf.h"
#include "tracer/materials/conductor_ior.h"
#include "tracer/materials/principled.h"
#include "tracer/scene/alpha_mask.h"
#include "tracer/scene/texture.h"

namespace becalm::tracer {

inline constexpr std::uint32_t kNoTexture = ~0u;

/// A parameter of a material: one value everywhere, or a texture's.
template <class T>
struct MaterialInput {
  T value;
  std::uint32_t texture = kNoTexture;
};
using ColorInput = MaterialInput<V3f>;     ///< [0,1]
using ScalarInput = MaterialInput<float>;  ///< [0,1]

struct DiffuseMaterial {
  ColorInput reflectance{V3f(0.5f)};
};

struct ConductorMaterial {
  /// Used if `ior` is not given: reflectance at normal incidence.
  ColorInput reflectance{V3f(1.0f)};
  std::optional<ConductorIor> ior;
  ScalarInput roughness{0.0f};
};

struct DielectricMaterial {
  float ior = 1.5f;  ///< of the inside over the outside
  ScalarInput roughness{0.0f};
  ColorInput transmittance{V3f(1.0f)};
};

/// See PrincipledParameters.
struct PrincipledMaterial {
  ColorInput base_color{V3f(0.8f)};
  float ior = 1.5f;
  ScalarInput metallic{0.0f};
  ScalarInput roughness{0.5f};
  ScalarInput anisotropy{0.0f};
  ScalarInput anisotropy_rotation{0.0f};
  ScalarInput sheen{0.0f};
  ScalarInput sheen_tint{0.0f};
  ScalarInput clearcoat{0.0f};
  ScalarInput clearcoat_roughness{0.0f};
  ScalarInput transmission{0.0f};
};

/// Two materials of the same list, by the share of the second.
struct MixMaterial {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  ScalarInput factor{0.5f};
};

using MaterialModel =
    std::variant<DiffuseMaterial, ConductorMaterial, DielectricMaterial, PrincipledMaterial, MixMaterial>;

/// Height over the surface, of a texture of one channel.
struct BumpMap {
  std::uint32_t texture = kNoTexture;
  float scale = 1.0f;  ///< scene units of a height of 1; negative turns hills into pits
};

/// Normals in the frame of (dpdu, dpdv, normal), of a texture of data: n = 2 rgb - 1, +y along dpdv (OpenGL).
struct NormalMap {
  std::uint32_t texture = kNoTexture;
  float strength = 1.0f;  ///< factor of the slope
};

struct Material {
  std::string name;
  MaterialModel model;
  Bsdf bsdf;                  ///< of the constants; what evaluate_material gives if nothing is textured
  bool textured = false;      ///< whether the BSDF varies over the surface
  bool is_interface = false;  ///< no BSDF at all: light crosses it unbent, only the medium changes
  float opacity = 1.0f;       ///< [0,1], share of the surface that is there
  std::optional<AlphaMask> opacity_mask;  ///< times `opacity`
  std::optional<BumpMap> bump;
  std::optional<NormalMap> normal_map;
};

/// Sets `bsdf` and `textured` from the model.
void finish_material(Material& material);

/// Whether the shading normal is perturbed.
inline bool has_relief(const Material& material) {
  return material.bump.has_value() || material.normal_map.has_value();
}
/// Whether rays may pass the surface as if it were not there: the geometry needs a filter function.
inline bool has_alpha(const Material& material) {
  return material.opacity_mask.has_value() || material.opacity < 1.0f;
}
/// Probability in [0,1] that a ray meets the surface.
inline float opacity(const Material& material, const V2f& uv) {
  return material.opacity_mask ? material.opacity * material.opacity_mask->opacity(uv) : material.opacity;
}

/// The BSDF at that place: for materials without textures a copy of the ready one. Not of a mix.
Bsdf evaluate_material(const Material& material, const Textures::Reader& textures, const TexturePoint& point);

/// The material that a mix stands for in this sample, drawn by u in [0,1) so that each is found with its
/// share; the material itself if it is none. `materials` is the scene's list.
const Material& resolve_mix(std::span<const Material> materials, const Material& material,
                            const Textures::Reader& textures, const TexturePoint& point, float u);

/// What a material may require anywhere on a surface, the parts of a mix included.
struct MaterialNeeds {
  bool specular = false;        ///< BSDFs of delta lobes alone
  bool delta_lobes = false;     ///< delta lobes, alone or beside others
  bool rough_specular = false;  ///< microfacet lobes
  bool transmission = false;    ///< light crosses the surface; interfaces included
  bool textures = false;        ///< image lookups: uv and differentials
  bool relief = false;          ///< bump or normal maps
  bool mix = false;             ///< resolve_mix does anything
  bool alpha = false;           ///< has_alpha; of the material itself alone, since parts of a mix have none
  bool tangents = false;        ///< anisotropy or relief: the shading frame must follow dpdu
  bool interface = false;
};
MaterialNeeds material_needs(std::span<const Material> materials, const Material& material);

/// The textures of the `used` ones of a list of materials, and of those that they are mixed of.
std::set<std::uint32_t> textures_of(std::span<const Material> materials, std::set<std::uint32_t> used);

}  // namespace becalm::tracer
