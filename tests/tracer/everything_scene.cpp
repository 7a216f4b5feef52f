#include "tests/tracer/everything_scene.h"

#include <fmt/format.h>

#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {

namespace {

void write_images() {
  write_image(
      "stripes.png", 4, 4, 3,
      {0.9f, 0.2f, 0.2f, 0.2f, 0.9f, 0.2f, 0.9f, 0.2f, 0.2f, 0.2f, 0.9f, 0.2f, 0.8f, 0.8f, 0.8f, 0.3f,
       0.3f, 0.3f, 0.8f, 0.8f, 0.8f, 0.3f, 0.3f, 0.3f, 0.9f, 0.2f, 0.2f, 0.2f, 0.9f, 0.2f, 0.9f, 0.2f,
       0.2f, 0.2f, 0.9f, 0.2f, 0.8f, 0.8f, 0.8f, 0.3f, 0.3f, 0.3f, 0.8f, 0.8f, 0.8f, 0.3f, 0.3f, 0.3f});
  write_image("leaf.png", 2, 2, 1, {1, 0, 0.5f, 1});
  write_image("sky.exr", 4, 2, 3,
              {0.1f,  0.2f,  0.4f,  0.3f,  0.3f,  0.4f,  1.5f, 1.2f, 0.9f, 0.1f,  0.2f,  0.4f,
               0.05f, 0.05f, 0.04f, 0.05f, 0.05f, 0.04f, 0.1f, 0.1f, 0.1f, 0.05f, 0.05f, 0.04f});
}

/// Replaces each $(x) by x in the scene's unit to the power written after it: $(2.5) lengths, $2(30)
/// intensities, $-1(0.4) extinctions, $0.5(0.3) times of what gravity drives.
std::string in_units(const std::string& text, double unit) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '$') {
      result += text[i];
      continue;
    }
    const std::size_t open = text.find('(', i), close = text.find(')', open);
    const double power = open == i + 1 ? 1.0 : std::stod(text.substr(i + 1, open - i - 1));
    result +=
        fmt::format("{:.9g}", std::stod(text.substr(open + 1, close - open - 1)) * std::pow(unit, power));
    i = close;
  }
  return result;
}

}  // namespace

std::string everything_scene(const EverythingSettings& settings) {
  write_images();
  const std::string albedo = settings.scatters_in_media ? "[0.9,0.8,0.7]" : "0";
  return in_units("{'frames': {'first': 1, 'last': 5}, 'film': {" + settings.film + "}, 'integrator': {" +
                      settings.integrator + R"(},
  'camera': {'fov_y_deg': 45, 'shutter': [0,0.5], 'aperture_radius': $(0.03), 'focus_distance': $(6), 'blades': 6,
    'look_at': {'keys': [{'frame': 1, 'eye': [$(0),$(2.5),$(6)], 'target': [$(0),$(0.8),$(0)]},
                         {'frame': 5, 'eye': [$(0.4),$(2.5),$(5.8)], 'target': [$(0),$(0.8),$(0)]}]}},
  'environment': {'image': 'sky.exr', 'scale': 0.5, 'group': 'sky'},
  'lights': {
    'lamp': {'type': 'point', 'position': {'keys': [{'frame': 1, 'value': [$(-2),$(3),$(2)]}, {'frame': 5, 'value': [$(-1),$(3),$(2)]}]}, 'intensity': $2(6), 'group': 'lamps'},
    'spot': {'type': 'spot', 'position': [$(3),$(4),$(1)], 'target': [$(0.5),$(0),$(0)], 'intensity': $2(30), 'inner_deg': 10, 'outer_deg': 20, 'group': 'lamps'},
    'sun': {'type': 'sun', 'azimuth_deg': 200, 'elevation_deg': 50, 'irradiance': [1.2,1.1,0.9], 'group': 'sun'}},
  'materials': {
    'floor': {'type': 'diffuse', 'reflectance': {'image': 'stripes.png', 'repeat': [4,4]}, 'bump': {'image': 'stripes.png', 'scale': $(0.01)}},
    'paint': {'type': 'principled', 'base_color': [0.7,0.3,0.2], 'roughness': 0.4, 'clearcoat': 0.7, 'anisotropy': 0.5, 'sheen': 0.3},
    'gold': {'type': 'conductor', 'eta': [0.2,0.4,1.4], 'k': [3.9,2.4,1.6], 'roughness': 0.3},
    'mirror': {'type': 'conductor', 'reflectance': 0.9},
    'glass': {'type': 'dielectric', 'ior': 1.5}, 'frosted': {'type': 'dielectric', 'ior': 1.4, 'roughness': 0.4},
    'blend': {'type': 'mix', 'materials': ['paint', 'gold'], 'factor': 0.4},
    'leaf': {'type': 'diffuse', 'reflectance': [0.2,0.6,0.1], 'opacity': {'image': 'leaf.png'}},
    'water': {'type': 'dielectric', 'ior': 1.33, 'roughness': 0.2},
    'air': {'type': 'interface'}},
  'media': {
    'haze': {'type': 'homogeneous', 'extinction': [$-1(0.4),$-1(0.5),$-1(0.6)], 'albedo': )" +
                      albedo + R"(, 'g': 0.5},
    'tint': {'type': 'homogeneous', 'extinction': [$-1(2),$-1(0.3),$-1(0.2)], 'albedo': 0},
    'cloud': {'type': 'cloud', 'extinction': $-1(5), 'albedo': )" +
                      albedo + R"(, 'resolution': [16,12,16], 'frequency': 2, 'coverage': 0.7, 'seed': 4,
              'offset': {'keys': [{'frame': 1, 'value': [0,0,0]}, {'frame': 5, 'value': [0.5,0,0]}]}}},
  'meshes': {
    'plane': {'shape': 'rectangle'}, 'cube': {'shape': 'cube'}, 'ball': {'shape': 'exact_sphere'}, 'disc': {'shape': 'disc'},
    'mesh_ball': {'shape': 'sphere', 'segments': 32}, 'pebble': {'shape': 'sphere', 'segments': 64},
    'hill': {'procedural': 'terrain', 'size': $(3), 'height': $(0.8), 'resolution': 64, 'seed': 3},
    'sea': {'procedural': 'ocean', 'size': $(3), 'wavelength': $(0.8), 'shortest_wavelength': $(0.1), 'wave_height': $(0.08), 'trains': 12, 
            'time_s': {'keys': [{'frame': 1, 'value': 0}, {'frame': 5, 'value': $0.5(0.3)}]}},
    'drops': {'procedural': 'blobs', 'count': 5, 'extent': $(0.4), 'radius': $(0.2), 'blend': $(0.1), 'seed': 2}},
  'objects': [
    {'name': 'floor', 'mesh': 'plane', 'material': 'floor', 'transform': {'scale': [$(4),$(1),$(4)]}},
    {'mesh': 'hill', 'material': 'paint', 'transform': {'translate': [$(-1.5),$(0.05),$(-2.5)], 'rotate_deg': [0,30,0]}},
    {'mesh': 'sea', 'material': 'water', 'transform': {'translate': [$(1.8),$(0.2),$(-1.8)]}},
    {'mesh': 'drops', 'material': 'gold', 'transform': {'translate': [$(0),$(1.8),$(-0.5)]}},
    {'mesh': 'pebble', 'material': 'blend', 'transform': {'scale': $(0.08)},
     'scatter': {'count': 26, 'seed': 3, 'area': [$(-2.5),$(-0.5),$(2.5),$(3)], 'scale': [0.5,1.5], 'tilt_deg': 10, 'on': 'floor'}},
    {'mesh': 'cube', 'material': 'gold', 'transform': {'interpolation': 'smooth', 'keys': [
      {'frame': 1, 'scale': $(0.3), 'rotate_deg': [0,0,0], 'translate': [$(-1.2),$(0.5),$(1)]},
      {'frame': 3, 'scale': $(0.3), 'rotate_deg': [0,90,30], 'translate': [$(-0.8),$(0.9),$(1)]},
      {'frame': 5, 'scale': $(0.3), 'rotate_deg': [0,180,30], 'translate': [$(-0.5),$(0.5),$(1.2)]}]}},
    {'mesh': 'ball', 'material': 'glass', 'interior': 'tint', 'transform': {'scale': [$(0.4),$(0.5),$(0.4)], 'translate': [$(0.8),$(0.51),$(1.2)]}},
    {'mesh': 'mesh_ball', 'material': 'mirror', 'transform': {'scale': $(-0.3), 'translate': [$(1.7),$(0.31),$(0.6)]}},
    {'mesh': 'cube', 'material': 'frosted', 'transform': {'scale': $(0.25), 'rotate_deg': [0,30,0], 'translate': [$(0),$(0.26),$(2)]}},
    {'mesh': 'plane', 'material': 'leaf', 'transform': {'scale': $(0.6), 'rotate_deg': [60,20,0], 'translate': [$(-1.9),$(0.8),$(1.4)]}},
    {'mesh': 'cube', 'material': 'air', 'interior': 'haze', 'transform': {'scale': [$(1.5),$(0.6),$(0.6)], 'translate': [$(0.2),$(0.7),$(-0.4)]}},
    {'mesh': 'cube', 'material': 'air', 'interior': 'cloud', 'transform': {'scale': [$(1),$(0.4),$(0.5)], 'translate': [$(-1.4),$(2.2),$(0.4)]}},
    {'mesh': 'disc', 'material': 'floor', 'emission': [4,3,2], 'group': 'panels', 'transform': {'scale': $(0.5), 'rotate_deg': [150,0,20], 'translate': [$(1.6),$(2.6),$(0)]}},
    {'mesh': 'ball', 'material': 'floor', 'emission': {'keys': [{'frame': 1, 'value': [1,2,6]}, {'frame': 5, 'value': [6,2,1]}]}, 'group': 'panels', 'transform': {'keys': [
      {'frame': 1, 'scale': $(0.15), 'translate': [$(-0.2),$(1.2),$(1.2)]}, {'frame': 5, 'scale': $(0.15), 'translate': [$(0.4),$(1.4),$(1.2)]}]}}]})",
                  settings.unit);
}

}  // namespace becalm::tracer::test
