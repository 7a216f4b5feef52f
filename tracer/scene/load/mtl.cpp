#include "tracer/scene/load/mtl.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>

#include "frame/error.h"
#include "tracer/scene/load/fail_in_file.h"
#include "tracer/scene/load/mtl_text.h"
#include "tracer/scene/load/text_words.h"

namespace becalm::tracer {

namespace {

float unit(float v) {
  return std::clamp(v, 0.0f, 1.0f);
}
V3f unit_color(const float* v) {
  return {unit(v[0]), unit(v[1]), unit(v[2])};
}

/// Index of refraction of a dielectric that reflects f0 at normal incidence.
float ior_of_reflectance(float f0) {
  const float root = std::sqrt(std::min(f0, 0.9f));
  return (1.0f + root) / (1.0f - root);
}

/// Turns one parsed material into ours.
class Translator {
 public:
  Translator(const std::string& path, const tinyobj::material_t& mtl, const MtlStatements& statements,
             Textures& textures)
      : path_(path), mtl_(mtl), statements_(statements), textures_(textures) {}

  MtlMaterial translate() const {
    MtlMaterial result;
    Material& material = result.material;
    material.name = trimmed(mtl_.name);
    const V3f specular = unit_color(mtl_.specular);
    bool clear = false;
    const bool has_illum = !is_physically_based();
    if (has_illum && (mtl_.illum == 4 || mtl_.illum == 6 || mtl_.illum == 7 || mtl_.illum == 9)) {
      clear = true;
      material.model =
          DielectricMaterial{.ior = has("Ni") && mtl_.ior >= 1.0f ? std::min(mtl_.ior, 10.0f) : 1.5f,
                             .roughness = {roughness(0.0f)},
                             .transmittance = {has("Tf") ? unit_color(mtl_.transmittance) : V3f(1.0f)}};
    } else if (has_illum && (mtl_.illum == 3 || mtl_.illum == 5) && !is_black(specular)) {
      material.model =
          ConductorMaterial{.reflectance = {specular}, .ior = {}, .roughness = {roughness(0.0f)}};
    } else {
      material.model = principled();
    }
    if (!clear) set_opacity(material);
    if (!mtl_.bump_texname.empty()) {
      material.bump = BumpMap{scalar_texture(mtl_.bump_texname, mtl_.bump_texopt, 1.0f),
                              mtl_.bump_texopt.bump_multiplier};
    }
    if (!mtl_.normal_texname.empty()) {
      material.normal_map =
          NormalMap{add(mtl_.normal_texname, mtl_.normal_texopt, TextureContent::data, V3f(1.0f))};
    }
    set_emission(result);
    finish_material(material);
    return result;
  }

 private:
  bool has(std::string_view keyword) const { return statements_.contains(keyword); }

  bool is_physically_based() const {
    for (const char* keyword :
         {"Pr", "map_Pr", "Pm", "map_Pm", "Ps", "map_Ps", "Pc", "Pcr", "aniso", "anisor"}) {
      if (has(keyword)) return true;
    }
    return false;
  }

  /// `otherwise` if the file gives none.
  float roughness(float otherwise) const {
    if (has("Pr")) return unit(mtl_.roughness);
    return has("Ns") ? std::sqrt(std::sqrt(2.0f / (std::max(0.0f, mtl_.shininess) + 2.0f))) : otherwise;
  }

  PrincipledMaterial principled() const {
    PrincipledMaterial m;
    const V3f diffuse = has("Kd") ? unit_color(mtl_.diffuse) : V3f(0.8f);
    m.base_color.value = diffuse;
    if (!mtl_.diffuse_texname.empty()) {
      const V3f scale = has("Kd") && !is_black(diffuse) ? diffuse : V3f(1.0f);
      m.base_color.texture = add(mtl_.diffuse_texname, mtl_.diffuse_texopt, TextureContent::color, scale);
    }
    m.roughness = scalar(roughness(1.0f), mtl_.roughness_texname, mtl_.roughness_texopt, has("Pr"));
    m.metallic = scalar(mtl_.metallic, mtl_.metallic_texname, mtl_.metallic_texopt, has("Pm"));
    m.sheen = scalar(mtl_.sheen, mtl_.sheen_texname, mtl_.sheen_texopt, has("Ps"));
    m.clearcoat.value = unit(mtl_.clearcoat_thickness);
    m.clearcoat_roughness.value = unit(mtl_.clearcoat_roughness);
    m.anisotropy.value = unit(mtl_.anisotropy);
    m.anisotropy_rotation.value = unit(mtl_.anisotropy_rotation);
    const float reflectance = max_component(unit_color(mtl_.specular));
    if (mtl_.ior > 1.0f) {
      m.ior = std::min(mtl_.ior, 10.0f);
    } else if (has("Ks")) {
      m.ior = ior_of_reflectance(reflectance);
    }
    return m;
  }

  ScalarInput scalar(float value, const std::string& image, const tinyobj::texture_option_t& options,
                     bool scaled) const {
    ScalarInput input{unit(value)};
    if (!image.empty())
      input.texture = scalar_texture(image, options, scaled && value > 0.0f ? unit(value) : 1.0f);
    return input;
  }

  void set_opacity(Material& material) const {
    material.opacity = unit(mtl_.dissolve);
    if (mtl_.alpha_texname.empty()) return;
    const std::string file = image_path(mtl_.alpha_texname);
    try {
      material.opacity_mask = AlphaMask::read(file, channel(mtl_.alpha_texopt, TextureContent::color),
                                              placement(mtl_.alpha_texopt));
    } catch (const std::runtime_error& error) {
      fail_unreadable(mtl_.alpha_texname, error);
    }
  }

  void set_emission(MtlMaterial& result) const {
    result.emission = {std::max(0.0f, mtl_.emission[0]), std::max(0.0f, mtl_.emission[1]),
                       std::max(0.0f, mtl_.emission[2])};
    if (mtl_.emissive_texname.empty()) return;
    const std::uint32_t texture =
        add(mtl_.emissive_texname, mtl_.emissive_texopt, TextureContent::color, V3f(1.0f));
    constexpr float whole = 1.0f;
    // Not limited to 1, as a reflectance is.
    const V3f mean = Textures::Reader(textures_).data(texture, {V2f(0.5f), {whole, 0.0f}, {0.0f, whole}});
    textures_.check();
    result.emission = is_black(result.emission) ? mean : result.emission * mean;
  }

  static PicturePlacement placement(const tinyobj::texture_option_t& options) {
    return {.repeat = {options.scale[0], options.scale[1]},
            .offset = {options.origin_offset[0], options.origin_offset[1]}};
  }

  static TextureContent channel(const tinyobj::texture_option_t& options, TextureContent otherwise) {
    switch (options.imfchan) {
      case 'r':
        return TextureContent::r;
      case 'g':
        return TextureContent::g;
      case 'b':
        return TextureContent::b;
      default:
        return otherwise;
    }
  }

  std::string image_path(std::string name) const {
    std::replace(name.begin(), name.end(), '\\', '/');
    std::string file = (std::filesystem::path(path_).parent_path() / name).string();
    std::error_code ignored;  // a name that is too long is none
    if (!std::filesystem::is_regular_file(file, ignored))
      fail_in_file(path_, fmt::format("material '{}': no file '{}'", mtl_.name, name));
    return file;
  }

  [[noreturn]] void fail_unreadable(const std::string& name, const std::runtime_error& error) const {
    rethrow_if_of_system(error);
    fail_in_file(path_, fmt::format("material '{}': cannot read '{}': {}", mtl_.name, name, error.what()));
  }

  std::uint32_t scalar_texture(const std::string& name, const tinyobj::texture_option_t& options,
                               float scale) const {
    return add(name, options, channel(options, TextureContent::r), V3f(scale));
  }

  std::uint32_t add(const std::string& name, const tinyobj::texture_option_t& options, TextureContent content,
                    const V3f& scale) const {
    const TextureSettings settings{
        .path = image_path(name), .placement = placement(options), .scale = scale, .content = content};
    try {
      return textures_.add(settings);
    } catch (const std::runtime_error& error) {
      fail_unreadable(name, error);
    }
  }

  const std::string& path_;
  const tinyobj::material_t& mtl_;
  const MtlStatements& statements_;
  Textures& textures_;
};

/// Of images that are left out or used otherwise than the file says.
void warn_of_images(const std::string& path, const tinyobj::material_t& mtl, const MtlStatements& statements,
                    std::vector<std::string>& warnings) {
  const struct {
    const char* keyword;
    const std::string& name;
    const tinyobj::texture_option_t& options;
  } images[] = {
      {"map_Kd", mtl.diffuse_texname, mtl.diffuse_texopt},
      {"map_Pr", mtl.roughness_texname, mtl.roughness_texopt},
      {"map_Pm", mtl.metallic_texname, mtl.metallic_texopt},
      {"map_Ps", mtl.sheen_texname, mtl.sheen_texopt},
      {"map_Ke", mtl.emissive_texname, mtl.emissive_texopt},
      {"map_d", mtl.alpha_texname, mtl.alpha_texopt},
      {"map_bump", mtl.bump_texname, mtl.bump_texopt},
      {"map_Bump", mtl.bump_texname, mtl.bump_texopt},
      {"bump", mtl.bump_texname, mtl.bump_texopt},
      {"norm", mtl.normal_texname, mtl.normal_texopt},
  };
  for (const auto& image : images) {
    const auto statement = statements.find(image.keyword);
    if (statement == statements.end()) continue;
    const char* problem = image.name.empty()    ? "expected an image file, found none; left out"
                          : image.options.clamp ? "'-clamp on' is not supported; the image repeats"
                                                : nullptr;
    if (problem == nullptr) continue;
    warnings.push_back(
        mtl_warning(path, statement->second, trimmed(mtl.name), std::string(image.keyword) + ": " + problem));
  }
}

}  // namespace

std::vector<MtlMaterial> load_mtl(const std::string& path, const std::optional<std::set<std::string>>& wanted,
                                  Textures& textures, std::vector<std::string>& warnings) {
  MtlText mtl_text = read_mtl(path);
  std::ranges::move(mtl_text.warnings, std::back_inserter(warnings));
  std::map<std::string, int> numbers;
  std::vector<tinyobj::material_t> parsed;
  std::istringstream stream(mtl_text.text);
  std::string ignored_warning, ignored_error;
  tinyobj::LoadMtl(&numbers, &parsed, &stream, &ignored_warning, &ignored_error);
  std::vector<MtlMaterial> materials;
  for (const tinyobj::material_t& mtl : parsed) {
    if (mtl.name.empty()) continue;  // what tinyobjloader makes of a file without any
    if (wanted && !wanted->contains(std::string(trimmed(mtl.name)))) continue;
    const MtlStatements& statements = mtl_text.materials[std::string(trimmed(mtl.name))];
    warn_of_images(path, mtl, statements, warnings);
    materials.push_back(Translator(path, mtl, statements, textures).translate());
  }
  return materials;
}

std::vector<MtlMaterial> load_part_materials(const std::string& obj_path, const ObjParts& obj,
                                             Textures& textures, std::vector<std::string>& warnings) {
  const std::filesystem::path folder = std::filesystem::path(obj_path).parent_path();
  std::set<std::string> wanted;
  for (const ObjPart& part : obj.parts) wanted.insert(part.material);
  std::vector<MtlMaterial> library;
  const auto read = [&](std::string_view name) {
    std::vector<MtlMaterial> more = load_mtl((folder / name).string(), wanted, textures, warnings);
    std::move(more.begin(), more.end(), std::back_inserter(library));
  };
  for (const std::string& names : obj.material_libraries) {
    // One name with blanks in it, or several.
    std::string_view rest = names;
    std::error_code ignored;  // a name that is too long is none
    if (std::filesystem::is_regular_file(folder / names, ignored)) {
      read(names);
    } else {
      while (!trimmed(rest).empty()) read(take_word(rest));
    }
  }
  std::vector<MtlMaterial> materials;
  for (const ObjPart& part : obj.parts) {
    const auto found = std::find_if(library.begin(), library.end(), [&](const MtlMaterial& candidate) {
      return candidate.material.name == part.material;
    });
    if (found != library.end()) {
      materials.push_back(*found);
    } else if (part.material.empty()) {
      MtlMaterial white;
      white.material.model = DiffuseMaterial{V3f(0.8f)};
      finish_material(white.material);
      materials.push_back(std::move(white));
    } else {
      fail_in_file(obj_path,
                   fmt::format("no material '{}' in {}", part.material,
                               obj.material_libraries.empty() ? "it, since it names no mtllib"
                                                              : "'" + obj.material_libraries.front() + "'"));
    }
  }
  return materials;
}

}  // namespace becalm::tracer
