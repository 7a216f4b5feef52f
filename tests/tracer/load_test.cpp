#include "tracer/scene/load/load.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "frame/error.h"
#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/describe_scene.h"

namespace becalm::tracer::test {
namespace {

/// A whole scene with the given text in place of one part.
std::string scene_with(const std::string& camera, const std::string& materials, const std::string& meshes,
                       const std::string& objects, const std::string& more = "") {
  return "{'camera': " + camera + ", 'materials': " + materials + ", 'meshes': " + meshes +
         ", 'objects': " + objects + more + "}";
}

const std::string kCamera = "{'look_at': {'eye': [0,0,5], 'target': [0,0,0]}}";
const std::string kMaterials = "{'white': {'type': 'diffuse', 'reflectance': 0.5}}";
const std::string kMeshes = "{'box': {'shape': 'cube'}}";
const std::string kObjects = "[{'name': 'a', 'mesh': 'box', 'material': 'white'}]";

std::string with_more(const std::string& more) {
  return scene_with(kCamera, kMaterials, kMeshes, kObjects, ", " + more);
}
std::string with_camera(const std::string& camera) {
  return scene_with(camera, kMaterials, kMeshes, kObjects);
}
std::string with_materials(const std::string& materials) {
  return scene_with(kCamera, materials, kMeshes, kObjects);
}
std::string with_meshes(const std::string& meshes) {
  return scene_with(kCamera, kMaterials, meshes, kObjects);
}
std::string with_objects(const std::string& objects) {
  return scene_with(kCamera, kMaterials, kMeshes, objects);
}

TEST(Load, ReadsEveryPart) {
  write_file("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Scene scene = load_text(R"({
    'frames': {'first': -3, 'last': 8, 'rate': 25},
    'film': {'width': 20, 'height': 10, 'filter': {'type': 'tent', 'radius_px': 2}},
    'integrator': {'max_depth': 3, 'roulette_depth': 1, 'direct': 'light', 'heuristic': 'balance'},
    'camera': {'fov_y_deg': 30, 'look_at': {'interpolation': 'smooth', 'keys': [
        {'frame': 0, 'eye': [0,0,5], 'target': [0,0,0]}, {'frame': 8, 'eye': [1,0,5], 'target': [0,0,0], 'up': [0,0,1]}]}},
    'environment': {'radiance': [1,2,3]},
    'materials': {
      'paint': {'type': 'diffuse', 'reflectance': [0.1,0.2,0.3]},
      'gold': {'type': 'conductor', 'eta': [0.2,0.4,1.3], 'k': [3,2,1], 'roughness': 0.5},
      'glass': {'type': 'dielectric', 'ior': 1.33, 'transmittance': 0.9}},
    'meshes': {'tri': {'obj': 'tri.obj'}, 'ball': {'shape': 'sphere', 'segments': 8}},
    'objects': [
      {'name': 'one', 'mesh': 'tri', 'material': 'gold', 'two_sided': true, 'emission': [1,0,2]},
      {'mesh': 'ball', 'material': 'glass', 'transform': {'interpolation': 'linear', 'keys': [
          {'frame': 1, 'translate': [1,2,3]}, {'frame': 5, 'rotate_deg': [0,90,0], 'scale': 2}]},
       'emission': {'keys': [{'frame': 1, 'value': 0}, {'frame': 2, 'value': 1}]}}]})");
  const SceneDescription& d = scene.description();
  EXPECT_EQ(d.frames.first, -3);
  EXPECT_EQ(d.frames.last, 8);
  EXPECT_EQ(d.frames.rate, 25);
  EXPECT_EQ(d.film.width, 20);
  EXPECT_EQ(d.film.filter.type, FilterShape::tent);
  EXPECT_EQ(d.film.filter.radius_px, 2.0f);
  EXPECT_EQ(d.integrator.max_depth, 3);
  EXPECT_EQ(d.integrator.direct, Direct::light);
  EXPECT_EQ(d.integrator.heuristic, Heuristic::balance);
  EXPECT_EQ(d.environment->radiance(V3f(0, 1, 0)), V3f(1, 2, 3));
  ASSERT_EQ(d.objects.size(), 2u);
  const auto& gold = std::get<ConductorBsdf>(d.materials[d.objects[0].material].bsdf);
  EXPECT_EQ(gold.k, V3f(3, 2, 1));
  EXPECT_EQ(gold.alpha, roughness_to_alpha(0.5f));
  EXPECT_EQ(triangle_count(d.meshes[d.objects[0].mesh]), 1u);
  EXPECT_TRUE(d.objects[0].two_sided);
  EXPECT_EQ(std::get<DielectricBsdf>(d.materials[d.objects[1].material].bsdf).eta, 1.33f);
  EXPECT_TRUE(d.objects[1].emissive);
  const SceneNeeds& needs = scene.needs();
  EXPECT_TRUE(needs.moving_camera && needs.moving_objects && needs.changing_emission && needs.specular &&
              needs.rough_specular && needs.transmission && needs.area_lights && needs.environment);
  EXPECT_FALSE(needs.textures || needs.environment_image);
  EXPECT_EQ(needs.moving_object_count, 1u);
  EXPECT_EQ(needs.static_objects, 1u);
}

TEST(Load, DescribesWhatIsRequiredAndWhatIsLeftOut) {
  Scene scene = load_text(with_more("'environment': {'radiance': 1}"));
  const std::vector<std::string> lines = describe_scene(scene);
  ASSERT_EQ(lines.size(), 8u);
  EXPECT_EQ(lines[0], "frames:    1-1 at 24 per second");
  EXPECT_EQ(lines[1], "film:      640x360");
  EXPECT_EQ(lines[2], "geometry:  1 static and 0 moving objects, 12 triangles");
  EXPECT_EQ(lines[3], "requires:  environment");
  EXPECT_EQ(
      lines[4],
      "left out:  area lights, points and spots, suns, environment image, perfect mirrors or glass, "
      "microfacets, transmission, textures, bump and normal maps, mixed materials, tangent frames, opacity, "
      "procedural surfaces, media, moving camera, instances that move, motion blur, depth of field, "
      "changing lights, two eyes");
  EXPECT_EQ(lines[5], "variant:   'diffuse' of the path integrator, 'diffuse' with AOVs of surfaces");
  EXPECT_EQ(lines[6], "hierarchy: 1 objects baked into one, 0 instances; 12 triangles stored, 12 visible");
  EXPECT_EQ(lines[7].rfind("memory:    ", 0), 0u) << lines[7];
}

TEST(Load, NamesUnknownKeys) {
  EXPECT_EQ(
      load_error(with_more("'envronment': {}")),
      "scene.json: /envronment: unknown key; expected one of frames, film, integrator, camera, environment, "
      "lights, materials, media, meshes, objects");
  EXPECT_EQ(load_error(with_objects("[{'mesh': 'box', 'material': 'white', 'a/b~': 1}]")),
            "scene.json: /objects/0/a~1b~0: unknown key; expected one of name, mesh, material, interior, "
            "emission, group, two_sided, transform, scatter");
}

TEST(Load, LimitsWhatHostileFilesNest) {
  const std::string deep = std::string(50'000, '[') + std::string(50'000, ']');
  EXPECT_EQ(load_error("{'camera': " + deep + "}"), "scene.json: values are nested more than 100 deep");
  // Each the mix of the next one twice: to look at every part of every part would take 2^60 steps.
  std::string mixes;
  for (int i = 0; i < 60; ++i)
    mixes += fmt::format("'m{0:02}': {{'type': 'mix', 'materials': ['m{1:02}', 'm{1:02}']}}, ", i, i + 1);
  const auto scene = [&](const std::string& more) {
    return "{'camera': {'look_at': {'eye': [0,2,1], 'target': [0,0,0]}}, 'materials': {" + more +
           "'m60': {'type': 'diffuse', 'reflectance': 0.5}}, 'meshes': {'b': {'shape': 'cube'}}, "
           "'objects': [{'mesh': 'b', 'material': 'm00'}]}";
  };
  EXPECT_TRUE(load_text(scene(mixes)).needs().mix);
  std::string procedural = scene(mixes);
  procedural.replace(procedural.find("'shape': 'cube'"), 15, "'procedural': 'terrain'");
  EXPECT_TRUE(load_text(procedural).needs().mix);
  for (const int step : {1, -1}) {  // the deepest first, and last
    std::string chain;
    for (int i = 0; i < 70; ++i) {
      const int next = i + step;
      chain += fmt::format("'a{0:02}': {{'type': 'mix', 'materials': ['{1}', 'm60']}}, ", i,
                           next < 0 || next == 70 ? std::string("m60") : fmt::format("a{:02}", next));
    }
    EXPECT_NE(load_error(scene(chain)).find("mixes are nested more than 64 deep"), std::string::npos) << step;
  }
}

TEST(Load, LightGroupsHaveNamesThatFilesCanHold) {
  for (const std::string& name : {std::string(300, 'g'), std::string("a.b"), std::string("a\\u0007b")}) {
    EXPECT_NE(load_error(with_more("'environment': {'radiance': 1, 'group': '" + name + "'}"))
                  .find("scene.json: /environment/group: expected a name of 1 to 200 bytes"),
              std::string::npos)
        << name;
  }
}

TEST(Load, LightsThatMoveWhileTheShutterIsOpenNeedMotionBlur) {
  const auto needs = [](const char* position) {
    return load_text(std::string(
                         "{'camera': {'shutter': [0, 0.5], 'look_at': {'eye': [0,2,1], 'target': [0,0,0]}}, "
                         "'lights': [{'type': 'point', 'intensity': 1, 'position': ") +
                     position + "}], 'materials': {}, 'meshes': {}, 'objects': []}")
        .needs();
  };
  EXPECT_FALSE(needs("[0, 1, 0]").motion_blur);
  EXPECT_TRUE(
      needs("{'keys': [{'frame': 1, 'value': [0, 1, 0]}, {'frame': 2, 'value': [1, 1, 0]}]}").motion_blur);
}

TEST(Load, NamesMissingThings) {
  EXPECT_EQ(load_error("{}"), "scene.json: /: 'camera' is missing");
  EXPECT_EQ(
      load_error(with_objects("[{'mesh': 'box', 'material': 'white'}, {'mesh': 'box', 'material': 'foo'}]")),
      "scene.json: /objects/1/material: no material 'foo'");
  EXPECT_EQ(load_error(with_objects("[{'mesh': 'bax', 'material': 'white'}]")),
            "scene.json: /objects/0/mesh: no mesh 'bax'");
  EXPECT_EQ(load_error(with_objects("[{'mesh': 'box'}]")), "scene.json: /objects/0: 'material' is missing");
  EXPECT_EQ(load_error(with_meshes("{'box': {'obj': 'nowhere.obj'}}")),
            "scene.json: /meshes/box/obj: no file 'nowhere.obj'");
  EXPECT_EQ(load_error(with_materials("{'white': {'type': 'diffuse', 'reflectance': {'image': 'no.png'}}}")),
            "scene.json: /materials/white/reflectance/image: no file 'no.png'");
  EXPECT_EQ(load_error(with_more("'environment': {'image': 'sky.exr'}")),
            "scene.json: /environment/image: no file 'sky.exr'");
  try {
    load_scene("nowhere/x.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "nowhere/x.json: cannot read it");
  }
}

TEST(Load, NeedsNoMaterialsBesideThoseOfMeshes) {
  write_file("own.obj", "mtllib own.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
  write_file("own.mtl", "newmtl red\nKd 1 0 0\n");
  const Scene scene = load_text("{'camera': " + kCamera +
                                ", 'meshes': {'own': {'obj': 'own.obj', 'materials': 'mtl'}}, 'objects': "
                                "[{'mesh': 'own'}]}");
  EXPECT_EQ(scene.description().materials.size(), 1u);
  EXPECT_EQ(load_error("{'camera': " + kCamera + ", 'meshes': " + kMeshes + ", 'objects': " + kObjects + "}"),
            "scene.json: /objects/0/material: no material 'white'");
}

TEST(Load, RefusesWhatIsNoFile) {
  const std::string path = file_path("pipe.json");
  const auto error = [&] {
    try {
      load_scene(path);
    } catch (const Error& refused) {
      EXPECT_EQ(refused.status(), ExitStatus::bad_input);
      return std::string(refused.what());
    }
    return std::string();
  };
  std::filesystem::create_directory(path);
  EXPECT_EQ(error(), path + ": not a file, expected a JSON file");
  std::filesystem::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(error(), path + ": not a file, expected a JSON file");
}

TEST(Load, NamesBadValues) {
  EXPECT_EQ(load_error(with_materials("{'white': {'type': 'diffuse', 'reflectance': 1.5}}")),
            "scene.json: /materials/white/reflectance: expected a number from 0 to 1, found 1.5");
  EXPECT_EQ(load_error(with_materials("{'white': {'type': 'diffuse', 'reflectance': [0.5, 'x', 1]}}")),
            "scene.json: /materials/white/reflectance/1: expected a number from 0 to 1, found \"x\"");
  EXPECT_EQ(
      load_error(with_materials("{'white': {'type': 'shiny'}}")),
      "scene.json: /materials/white/type: expected one of diffuse, conductor, dielectric, principled, mix, "
      "interface, found \"shiny\"");
  EXPECT_EQ(load_error(with_materials("{'white': {'type': 'conductor', 'reflectance': 1, 'k': 3}}")),
            "scene.json: /materials/white: expected either reflectance, or eta and k");
  EXPECT_EQ(load_error(with_objects("[{'mesh': 'box', 'material': 'white', 'emission': -1}]")),
            "scene.json: /objects/0/emission: expected a number of at least 0, found -1");
  EXPECT_EQ(load_error(with_objects("[{'mesh': 'box', 'material': 'white', 'two_sided': 1}]")),
            "scene.json: /objects/0/two_sided: expected true or false, found 1");
  EXPECT_EQ(
      load_error(with_objects("[{'mesh': 'box', 'material': 'white', 'transform': {'translate': [1, 2]}}]")),
      "scene.json: /objects/0/transform/translate: expected a list of 3 numbers, found [1,2]");
  EXPECT_EQ(load_error(with_objects("{}")), "scene.json: /objects: expected a list, found {}");
  EXPECT_EQ(load_error(with_more("'frames': {'first': 9, 'last': 1}")),
            "scene.json: /frames/last: expected a whole number from 9 to 1000000000, found 1");
  EXPECT_EQ(load_error(with_more("'film': {'width': 0, 'height': 4}")),
            "scene.json: /film/width: expected a whole number from 1 to 65536, found 0");
  EXPECT_EQ(load_error(with_meshes("{'box': {'shape': 'sphere', 'segments': 2.5}}")),
            "scene.json: /meshes/box/segments: expected a whole number from 3 to 4096, found 2.5");
  EXPECT_EQ(
      load_error(with_more("'lights': {'far': {'type': 'point', 'position': [0, 1e19, 0], 'intensity': 1}}")),
      "scene.json: /lights/far/position/1: expected a number from -1e+17 to 1e+17, found 1e+19");
  EXPECT_EQ(load_error(with_objects(
                "[{'name': 'a', 'mesh': 'box', 'material': 'white'}, {'mesh': 'box', 'material': "
                "'white', 'scatter': {'count': 5, 'area': [-2, -2, 1e19, 2], 'on': 'a'}}]")),
            "scene.json: /objects/1/scatter/area/2: expected a number from -1e+17 to 1e+17, found 1e+19");
  EXPECT_EQ(load_error(with_meshes("{'box': {'shape': 'cube', 'segments': 4}}")),
            "scene.json: /meshes/box/segments: only a disc and a sphere have segments");
}

TEST(Load, NamesMaterialsThatAShapeCannotHave) {
  const auto loaded = [](const std::string& mesh, const std::string& material, const std::string& more = "") {
    write_image("relief.exr", 1, 1, 1, {0.5f});
    return load_error(
        "{'camera': {'look_at': {'eye': [0,0,4], 'target': [0,0,0]}}, 'media': {'fog': {'type': "
        "'homogeneous', 'extinction': 1, 'albedo': 0.5}}, 'materials': {'m': {'type': 'diffuse', "
        "'reflectance': 1, " +
        material + "}}, 'meshes': {'shape': {" + mesh + "}}, 'objects': [{'mesh': 'shape', 'material': 'm'" +
        more + "}]}");
  };
  EXPECT_EQ(loaded("'shape': 'exact_sphere'", "'opacity': 0.5"),
            "scene.json: /objects/0/material: only triangles can have an opacity");
  EXPECT_EQ(loaded("'procedural': 'terrain'", "'bump': {'image': 'relief.exr'}"),
            "scene.json: /objects/0/material: a procedural surface has no uvs for bump and normal maps");
  write_file("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(loaded("'obj': 'bare.obj'", "'bump': {'image': 'relief.exr'}"),
            "scene.json: /objects/0/material: the mesh has no uvs for bump and normal maps");
  EXPECT_EQ(loaded("'obj': 'bare.obj'", "'opacity': {'image': 'relief.exr'}"),
            "scene.json: /objects/0/material: the mesh has no uvs for an opacity image");
  EXPECT_EQ(load_error(R"({'camera': {'look_at': {'eye': [0,0,4], 'target': [0,0,0]}},
              'materials': {'m': {'type': 'mix', 'materials': ['a', 'b']}, 'b': {'type': 'diffuse', 'reflectance': 1},
                            'a': {'type': 'diffuse', 'reflectance': {'image': 'relief.exr'}}},
              'meshes': {'bare': {'obj': 'bare.obj'}}, 'objects': [{'mesh': 'bare', 'material': 'm'}]})"),
            "scene.json: /objects/0/material: the mesh has no uvs for images");
  EXPECT_EQ(
      loaded("'shape': 'cube'", "'opacity': 0.5", ", 'interior': 'fog'"),
      "scene.json: /objects/0/interior: a material with an opacity bounds no medium: it would leak through "
      "the holes");
}

TEST(Load, NamesImpossibleMotion) {
  EXPECT_EQ(load_error(with_camera("{'look_at': {'eye': [1,1,1], 'target': [1,1,1]}}")),
            "scene.json: /camera/look_at: eye and target must differ, and up must not point along the view");
  EXPECT_EQ(load_error(with_camera("{'look_at': {'eye': [0,5,0], 'target': [0,0,0]}}")),
            "scene.json: /camera/look_at: eye and target must differ, and up must not point along the view");
  const auto transform = [](const std::string& text) {
    return load_error(with_objects("[{'mesh': 'box', 'material': 'white', 'transform': " + text + "}]"));
  };
  EXPECT_EQ(
      transform("{'scale': [1, 0, 1]}"),
      "scene.json: /objects/0/transform/scale: a scale must not be 0, nor less than floats hold (1.4e-45)");
  EXPECT_EQ(
      transform("{'keys': [{'frame': 1, 'scale': 1}, {'frame': 2, 'scale': -1}]}"),
      "scene.json: /objects/0/transform/keys: a scale must not change its sign between keys: it would pass "
      "through 0");
  EXPECT_EQ(
      transform("{'keys': [{'frame': 2}, {'frame': 2}]}"),
      "scene.json: /objects/0/transform/keys/1/frame: expected a frame after the key before, 2, found 2");
  EXPECT_EQ(transform("{'keys': []}"), "scene.json: /objects/0/transform/keys: expected at least one key");
  EXPECT_EQ(
      transform("{'keys': [{'frame': 2}], 'interpolation': 'cubic'}"),
      "scene.json: /objects/0/transform/interpolation: expected one of linear, smooth, found \"cubic\"");
}

TEST(Load, NamesLineAndColumnOfBadSyntax) {
  const std::string message = load_error("{\n  'film': {'width' 3}\n}");
  EXPECT_EQ(message.substr(0, message.find(" - ")),
            "scene.json:2:20: syntax error while parsing object separator");
  EXPECT_EQ(load_error("").substr(0, 15), "scene.json:1:1:");
  EXPECT_EQ(load_error(with_more("'film': 1, 'film': 2")), "scene.json: /: the key \"film\" is given twice");
}

TEST(Load, NamesThePlaceOfAKeyGivenTwice) {
  EXPECT_EQ(load_error("{'objects': [{'a': [1, {}], 'b': {'b': 0}}, 2, {'x/y': {'name': 1, 'name': 2}}]}"),
            "scene.json: /objects/2/x~1y: the key \"name\" is given twice");
}

TEST(Load, NamesThePlaceOfANumberBeyondDouble) {
  const std::string expected = ": expected a number of at most 1.8e308 in size, found ";
  EXPECT_EQ(load_error(with_more("'film': {'width': 3, 'height': 1e400}")),
            "scene.json: /film/height" + expected + "1e400");
  EXPECT_EQ(load_error("{'a': [[0, 'x', true, null], {}, [-1e999]]}"),
            "scene.json: /a/2/0" + expected + "-1e999");
  EXPECT_EQ(load_error("1" + std::string(400, '0') + ".0"),
            "scene.json: /" + expected + "1" + std::string(39, '0') + "...");
}

TEST(Load, RefusesGeometryBeyondFloats) {
  Scene scene =
      load_text(with_objects("[{'mesh': 'box', 'material': 'white', 'transform': {'scale': 1e18}}]"));
  try {
    scene.at_frame(1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), ExitStatus::bad_input);
    EXPECT_NE(std::string(error.what()).find("/objects: coordinates reach 1e+18"), std::string::npos)
        << error.what();
  }
}

TEST(Load, RefusesACameraThatMeetsItsTargetOnTheWay) {
  Scene scene =
      load_text(with_camera("{'look_at': {'keys': [{'frame': 1, 'eye': [0,0,5], 'target': [0,0,0]}, "
                            "{'frame': 3, 'eye': [0,0,-5], 'target': "
                            "[0,0,0]}]}}"));
  scene.at_frame(1);
  EXPECT_THROW(scene.at_frame(2), Error);
  EXPECT_THROW(scene.at_frame(3), Error) << "its motion vectors need frame 2";
  scene.at_frame(4);
}

}  // namespace
}  // namespace becalm::tracer::test
