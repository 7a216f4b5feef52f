// Wavefront materials, and meshes by material.
#include "tracer/scene/load/mtl.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <thread>

#include "tests/error_of.h"
#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

struct Loaded {
  Textures textures;
  std::vector<MtlMaterial> materials;
  std::vector<std::string> warnings;
};
Loaded load(const std::string& text) {
  Loaded loaded;
  loaded.materials = load_mtl(write_file("m.mtl", text), {}, loaded.textures, loaded.warnings);
  return loaded;
}
Material only(const std::string& text) {
  Loaded loaded = load(text);
  EXPECT_EQ(loaded.materials.size(), 1u);
  return loaded.materials.at(0).material;
}

std::string without_folder(std::string message) {
  const std::string folder = file_path("");
  for (std::size_t at; (at = message.find(folder)) != std::string::npos;) message.erase(at, folder.size());
  return message;
}

template <class Function>
std::string error_of(const Function& function) {
  return without_folder(becalm::error_of(ExitStatus::bad_input, function));
}
std::string mtl_error(const std::string& text) {
  return error_of([&] { load(text); });
}

TEST(Mtl, PhysicallyBasedFields) {
  const Loaded loaded = load(
      "newmtl paint\nKd 0.1 0.2 0.3\nPr 0.25\nPm 0.5\nPs 0.125\nPc 0.75\nPcr 0.0625\naniso 0.5\nanisor 0.25\n"
      "Ni 1.6\nKe 1 2 3\nd 0.5\nillum 5\n");
  const Material& material = loaded.materials.at(0).material;
  EXPECT_EQ(material.name, "paint");
  const auto& m = std::get<PrincipledMaterial>(material.model);
  EXPECT_EQ(m.base_color.value, V3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.roughness.value, 0.25f);
  EXPECT_EQ(m.metallic.value, 0.5f);
  EXPECT_EQ(m.sheen.value, 0.125f);
  EXPECT_EQ(m.clearcoat.value, 0.75f);
  EXPECT_EQ(m.clearcoat_roughness.value, 0.0625f);
  EXPECT_EQ(m.anisotropy.value, 0.5f);
  EXPECT_EQ(m.anisotropy_rotation.value, 0.25f);
  EXPECT_EQ(m.ior, 1.6f);
  EXPECT_EQ(material.opacity, 0.5f);
  EXPECT_EQ(loaded.materials.at(0).emission, V3f(1, 2, 3));
  EXPECT_EQ(std::get<PrincipledBsdf>(material.bsdf).coat, 0.75f) << "ready";
}

TEST(Mtl, IlluminationModels) {
  for (const char* illum : {"4", "6", "7", "9"}) {
    const Material glass =
        only(std::string("newmtl g\nKd 0 0 0\nTf 0.9 0.8 0.7\nNi 1.3\nd 0.1\nillum ") + illum + "\n");
    const auto& m = std::get<DielectricMaterial>(glass.model);
    EXPECT_EQ(m.ior, 1.3f);
    EXPECT_EQ(m.transmittance.value, V3f(0.9f, 0.8f, 0.7f));
    EXPECT_EQ(m.roughness.value, 0.0f);
    EXPECT_FALSE(has_alpha(glass)) << "d of glass is no hole";
  }
  const auto ior = [](const std::string& lines) {
    return std::get<DielectricMaterial>(only("newmtl g\n" + lines).model).ior;
  };
  EXPECT_EQ(ior("illum 4\n"), 1.5f);
  EXPECT_EQ(ior("illum 7\nNi 1\n"), 1.0f);
  EXPECT_EQ(ior("illum 7\nNi 0.5\n"), 1.5f) << "left out";
  for (const char* illum : {"3", "5"}) {
    const Material mirror = only(std::string("newmtl m\nKs 0.9 0.8 0.7\nillum ") + illum + "\n");
    EXPECT_EQ(std::get<ConductorMaterial>(mirror.model).reflectance.value, V3f(0.9f, 0.8f, 0.7f));
    EXPECT_TRUE(is_specular(mirror.bsdf));
  }
  EXPECT_TRUE(std::holds_alternative<PrincipledMaterial>(only("newmtl m\nKs 1 1 1\nPr 0.5\nillum 3\n").model))
      << "the physically based fields decide";
}

TEST(Mtl, PhongBecomesRoughness) {
  const auto roughness = [](const std::string& lines) {
    return std::get<PrincipledMaterial>(only("newmtl m\nKd 1 1 1\nillum 2\n" + lines).model).roughness.value;
  };
  EXPECT_FLOAT_EQ(roughness("Ns 0\n"), 1.0f);
  EXPECT_FLOAT_EQ(roughness("Ns 30\n"), 0.5f) << "alpha = sqrt(2 / 32) = 0.5^2";
  EXPECT_FLOAT_EQ(roughness(""), 1.0f);
  EXPECT_FLOAT_EQ(roughness("Ns 30\nPr 0.7\n"), 0.7f);
  const auto ior = [](const std::string& lines) {
    return std::get<PrincipledMaterial>(only("newmtl m\nillum 2\n" + lines).model).ior;
  };
  EXPECT_NEAR(ior("Ks 0.04 0.04 0.04\n"), 1.5f, 1e-5f);
  EXPECT_EQ(ior("Ks 0 0 0\n"), 1.0f);
  EXPECT_EQ(ior("Ks 0.5 0.5 0.5\nNi 1.45\n"), 1.45f);
  EXPECT_EQ(ior(""), 1.5f);
}

TEST(Mtl, Images) {
  write_image("rgb.exr", 2, 1, 3, {0.25f, 0.5f, 0.75f, 0.25f, 0.5f, 0.75f});
  write_image("mask.exr", 1, 1, 1, {0.25f});
  const Loaded loaded = load(
      "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd -s 3 2 1 rgb.exr\nmap_Pr -imfchan g rgb.exr\nmap_Pm rgb.exr\nmap_d "
      "mask.exr\n"
      "map_Ke rgb.exr\nKe 2 2 2\nnorm rgb.exr\nmap_bump -bm 0.125 mask.exr\n");
  const Material& material = loaded.materials.at(0).material;
  const Textures::Reader reader(loaded.textures);
  const auto bsdf = std::get<PrincipledBsdf>(evaluate_material(material, reader, {{0.3f, 0.3f}}));
  EXPECT_NEAR(bsdf.base_color.y, 0.5f * 0.5f, 1e-3f) << "times Kd";
  EXPECT_NEAR(bsdf.alpha, 0.25f, 1e-6f);
  EXPECT_NEAR(bsdf.metal, 0.25f, 1e-6f);
  EXPECT_NEAR(opacity(material, {0.5f, 0.5f}), 0.25f, 0.5f / 255.0f);
  for (const char* half : {"d 0.5\n", "Tr 0.5\n"}) {
    EXPECT_NEAR(opacity(only("newmtl m\nmap_d mask.exr\n" + std::string(half)), {0.5f, 0.5f}), 0.125f,
                0.25f / 255.0f);
  }
  ASSERT_TRUE(material.bump && material.normal_map);
  EXPECT_EQ(material.bump->scale, 0.125f);
  EXPECT_EQ(reader.data(material.normal_map->texture, {{0.5f, 0.5f}}), V3f(0.25f, 0.5f, 0.75f));
  EXPECT_NEAR(loaded.materials.at(0).emission.z, 2.0f * 0.75f, 2e-3f);
  write_image("bright.exr", 1, 1, 3, {20.0f, 20.0f, 20.0f});
  EXPECT_GT(load("newmtl m\nmap_Ke bright.exr\n").materials.at(0).emission.x, 15.0f);
}

TEST(Mtl, ImagesAreOffset) {
  // Dark on the left, and bright on the right.
  write_image("halves.exr", 2, 1, 3, {0.25f, 0.25f, 0.25f, 0.75f, 0.75f, 0.75f});
  write_image("mask.exr", 2, 1, 1, {0.25f, 0.75f});
  const auto red_at = [](const std::string& options, const V2f& uv) {
    const Loaded loaded = load("newmtl m\nmap_Kd " + options + " halves.exr\n");
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
    const Textures::Reader reader(loaded.textures);
    return std::get<PrincipledBsdf>(evaluate_material(loaded.materials.at(0).material, reader, {uv}))
        .base_color.x;
  };
  const V2f left(0.25f, 0.5f);
  EXPECT_NEAR(red_at("", left), 0.25f, 1e-3f);
  EXPECT_NEAR(red_at("-o 0.5 0 0", left), 0.75f, 1e-3f);
  EXPECT_NEAR(red_at("-o 0.5", left), 0.75f, 1e-3f) << "others are 0";
  EXPECT_NEAR(red_at("-s 2 2 -o 0.25 0.5", left), 0.75f, 1e-3f) << "after the scale";
  EXPECT_NEAR(red_at("-clamp off -s 3", left), 0.75f, 1e-3f);
  const Material masked = only("newmtl m\nmap_d -o 0.5 0 mask.exr\n");
  EXPECT_NEAR(opacity(masked, left), 0.75f, 0.5f / 255.0f);
}

TEST(Mtl, AMaskIsNotReadWithoutUvs) {
  write_image("mask.exr", 2, 1, 1, {0.0f, 0.0f});
  write_file("leaf.mtl", "newmtl leaf\nd 0.5\nmap_d mask.exr\n");
  for (const bool with_uvs : {false, true}) {
    write_file("leaf.obj", std::string("mtllib leaf.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl leaf\n") +
                               (with_uvs ? "f 1/1 2/1 3/1\n" : "f 1 2 3\n"));
    const Scene scene = load_text(R"({'camera': {'look_at': {'eye': [0,2,9], 'target': [0,0,0]}},
      'film': {'width': 4, 'height': 4}, 'materials': {}, 'meshes': {'leaf': {'obj': 'leaf.obj', 'materials': 'mtl'}},
      'objects': [{'mesh': 'leaf'}]})");
    const Material& material = scene.description().materials.back();
    EXPECT_NEAR(opacity(material, {0.5f, 0.5f}), with_uvs ? 0.0f : 0.5f, 0.5f / 255.0f);
  }
}

TEST(Mtl, WarnsOfNumbersOutOfRange) {
  const auto warnings = [](const std::string& line) {
    const std::vector<std::string> found = load("newmtl a\n" + line + "\nnewmtl b\n").warnings;
    return found.size() == 1 ? without_folder(found.front()) : std::to_string(found.size());
  };
  const std::string place = "m.mtl: line 2: material 'a': ";
  EXPECT_EQ(warnings("Kd 0.5 2 3"), place + "Kd 2: expected a number from 0 to 1; taken as 1");
  EXPECT_EQ(warnings("d 2"), place + "d 2: expected a number from 0 to 1; taken as 1");
  EXPECT_EQ(warnings("Ns -5"), place + "Ns -5: expected a number of at least 0; taken as 0");
  EXPECT_EQ(warnings("Ke -1 0 0"), place + "Ke -1: expected a number of at least 0; taken as 0");
  EXPECT_EQ(warnings("Ni 0"), place + "Ni 0: expected a number from 1 to 10; left out");
  EXPECT_EQ(warnings("Ni 20"), place + "Ni 20: expected a number from 1 to 10; taken as 10");
  EXPECT_EQ(warnings("Pr 5"), place + "Pr 5: expected a number from 0 to 1; taken as 1");
  EXPECT_EQ(warnings("map_Kd"), place + "map_Kd: expected an image file, found none; left out");
  EXPECT_EQ(warnings("map_Kd -s 2 2"), place + "map_Kd: expected an image file, found none; left out");
  write_image("grey.exr", 1, 1, 1, {0.5f});
  EXPECT_EQ(warnings("map_Pr -clamp on grey.exr"),
            place + "map_Pr: '-clamp on' is not supported; the image repeats");
  EXPECT_EQ(warnings("Kd 1 1 0\nKe 20 0 0\nNi 1\nNs 900\nillum 2\nd 0"), "0");
}

TEST(Mtl, GreenAndBlueAreAsRedIfLeftOut) {
  const Loaded loaded = load("newmtl m\nKd 0.5\nKe 2 # white\n");
  EXPECT_EQ(std::get<PrincipledMaterial>(loaded.materials.at(0).material.model).base_color.value, V3f(0.5f));
  EXPECT_EQ(loaded.materials[0].emission, V3f(2.0f));
  EXPECT_TRUE(loaded.warnings.empty());
  EXPECT_EQ(mtl_error("newmtl a\nKd 0.1 0.2\n"), "m.mtl: line 2: 'Kd' needs 3 finite numbers, found ''");
  EXPECT_EQ(mtl_error("newmtl a\nKd\n"), "m.mtl: line 2: 'Kd' needs 3 finite numbers, found ''");
}

TEST(Mtl, WarnsOfFormsThatAreNotSupported) {
  const Loaded loaded = load(
      "newmtl a\nd -halo 0.5\nKd spectral file.rfl 0.5\nKs xyz 0.1 0.2 0.3\nPr 0.25\nnewmtl b\nKd xyz "
      "0.5\nKd 1 0 0\n");
  ASSERT_EQ(loaded.warnings.size(), 4u);
  EXPECT_EQ(without_folder(loaded.warnings[0]),
            "m.mtl: line 2: material 'a': d: '-halo' is not supported; left out");
  EXPECT_EQ(without_folder(loaded.warnings[1]),
            "m.mtl: line 3: material 'a': Kd: 'spectral' is not supported; left out");
  EXPECT_EQ(without_folder(loaded.warnings[2]),
            "m.mtl: line 4: material 'a': Ks: 'xyz' is not supported; left out");
  const Material& a = loaded.materials.at(0).material;
  EXPECT_EQ(a.opacity, 1.0f);
  const auto& m = std::get<PrincipledMaterial>(a.model);
  EXPECT_EQ(m.base_color.value, V3f(0.8f)) << "as without";
  EXPECT_EQ(m.ior, 1.5f);
  EXPECT_EQ(m.roughness.value, 0.25f);
  EXPECT_EQ(std::get<PrincipledMaterial>(loaded.materials.at(1).material.model).base_color.value,
            V3f(1, 0, 0));
}

TEST(Mtl, ByteOrderMarksContinuedLinesAndComments) {
  const Loaded loaded = load("\xef\xbb\xbfnewmtl paint\nKd 0.1 \\\n0.2 0.3# grey\nNi 1.6 # C:\\\nPr 0.25\n");
  ASSERT_EQ(loaded.materials.size(), 1u);
  EXPECT_EQ(loaded.materials[0].material.name, "paint");
  const auto& m = std::get<PrincipledMaterial>(loaded.materials[0].material.model);
  EXPECT_EQ(m.base_color.value, V3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.ior, 1.6f);
  EXPECT_EQ(m.roughness.value, 0.25f);
  EXPECT_EQ(mtl_error("newmtl a\nKd 0.1 \\\n0.2 0.3\nPr x\n"),
            "m.mtl: line 4: 'Pr' needs 1 finite numbers, found 'x'");
}

TEST(Mtl, OnlyWantedMaterialsAreRead) {
  const std::string path = write_file("m.mtl", "newmtl a\nmap_Kd nowhere.png\nnewmtl b\nKd 1 0 0\n");
  Loaded loaded;
  const std::set<std::string> wanted{"b"};
  const std::vector<MtlMaterial> materials = load_mtl(path, wanted, loaded.textures, loaded.warnings);
  ASSERT_EQ(materials.size(), 1u) << "and the image that a lacks is no error";
  EXPECT_EQ(materials[0].material.name, "b");
}

TEST(Mtl, NamesThatAreTooLongAreNone) {
  const std::string name(300, 'x');
  EXPECT_EQ(mtl_error("newmtl a\nmap_Kd " + name + "\n"), "m.mtl: material 'a': no file '" + name + "'");
}

TEST(Mtl, Errors) {
  EXPECT_EQ(mtl_error("newmtl a\nKd 0.1 nan 0.3\n"),
            "m.mtl: line 2: 'Kd' needs 3 finite numbers, found 'nan'");
  EXPECT_EQ(mtl_error("newmtl a\nPr x\n"), "m.mtl: line 2: 'Pr' needs 1 finite numbers, found 'x'");
  EXPECT_EQ(mtl_error("newmtl a\nmap_Kd sub\\no.png\n"), "m.mtl: material 'a': no file 'sub/no.png'");
  write_file("text.png", "no picture");
  EXPECT_EQ(mtl_error("newmtl a\nmap_d text.png\n").find("m.mtl: material 'a': cannot read 'text.png': "),
            0u);
  EXPECT_EQ(mtl_error("newmtl a\nmap_Pr text.png\n").find("m.mtl: material 'a': cannot read 'text.png': "),
            0u);
  Loaded loaded;
  EXPECT_EQ(error_of([&] { load_mtl(file_path("nowhere.mtl"), {}, loaded.textures, loaded.warnings); }),
            "nowhere.mtl: cannot read the material file");
  EXPECT_TRUE(load("").materials.empty());
  EXPECT_TRUE(load("Kd 1 1 1\n").materials.empty());
}

const std::string kObj =
    "mtllib one.mtl two.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\n"
    "f 1 2 3\nusemtl red\nf 1/1 2/1 3/1 4/1\no second\nusemtl blue\nf 1 2 4\nusemtl red\nf 1/1 3/1 4/1\n";

TEST(Mtl, PartsByMaterial) {
  const std::string path = write_file("m.obj", kObj);
  write_file("one.mtl", "newmtl red\nKd 1 0 0\n");
  write_file("two.mtl", "newmtl unused\nKd 0 1 0\nnewmtl blue\nKd 0 0 1\n");
  const ObjParts obj = load_obj_parts(path);
  ASSERT_EQ(obj.parts.size(), 3u);
  EXPECT_EQ(obj.parts[0].material, "");
  EXPECT_EQ(obj.parts[1].material, "red");
  EXPECT_EQ(obj.parts[2].material, "blue");
  EXPECT_EQ(obj.parts[0].mesh.triangles.size(), 1u);
  EXPECT_EQ(obj.parts[1].mesh.triangles.size(), 3u) << "from both groups, the polygon cut";
  EXPECT_EQ(obj.parts[1].mesh.positions.size(), 4u);
  EXPECT_EQ(obj.parts[1].mesh.uvs.size(), 4u) << "its own corners have uvs, though others do not";
  EXPECT_EQ(obj.parts[2].mesh.positions.size(), 3u);
  EXPECT_TRUE(obj.parts[2].mesh.uvs.empty());
  EXPECT_EQ(load_obj(path).triangles.size(), 5u);

  Loaded loaded;
  const std::vector<MtlMaterial> materials = load_part_materials(path, obj, loaded.textures, loaded.warnings);
  ASSERT_EQ(materials.size(), 3u);
  EXPECT_EQ(std::get<DiffuseBsdf>(materials[0].material.bsdf).reflectance, V3f(0.8f));
  EXPECT_EQ(std::get<PrincipledBsdf>(materials[1].material.bsdf).base_color, V3f(1, 0, 0));
  EXPECT_EQ(std::get<PrincipledBsdf>(materials[2].material.bsdf).base_color, V3f(0, 0, 1));
}

TEST(Mtl, NamesMayHoldBlanks) {
  Loaded loaded;
  const std::string path = write_file(
      "m.obj",
      "mtllib one.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wood dark \nf 1 2 3\nusemtl  red\nf 2 1 3\n");
  write_file("one.mtl", "newmtl wood\nKd 0 1 0\nnewmtl wood dark\nKd 0 0 1\nnewmtl  red\nKd 1 0 0\n");
  const std::vector<MtlMaterial> materials =
      load_part_materials(path, load_obj_parts(path), loaded.textures, loaded.warnings);
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(std::get<PrincipledBsdf>(materials[0].material.bsdf).base_color, V3f(0, 0, 1));
  EXPECT_EQ(std::get<PrincipledBsdf>(materials[1].material.bsdf).base_color, V3f(1, 0, 0));
}

TEST(Mtl, UnknownMaterialsAreNamed) {
  Loaded loaded;
  const std::string path = write_file("m.obj", kObj);
  write_file("one.mtl", "newmtl red\nKd 1 0 0\n");
  write_file("two.mtl", "newmtl green\nKd 1 0 0\n");
  const auto error = [&](const std::string& obj) {
    return error_of([&] { load_part_materials(obj, load_obj_parts(obj), loaded.textures, loaded.warnings); });
  };
  EXPECT_EQ(error(path), "m.obj: no material 'blue' in 'one.mtl two.mtl'");
  EXPECT_EQ(error(write_file("n.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl x\nf 1 2 3\n")),
            "n.obj: no material 'x' in it, since it names no mtllib");
  EXPECT_EQ(error(write_file("o.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl x\nf 1 2 3\n")),
            "gone.mtl: cannot read the material file");
  EXPECT_EQ(error_of([&] { load_obj_parts(write_file("p.obj", "v 0 0 0\nusemtl x\n")); }),
            "p.obj: has no faces");
}

TEST(Mtl, FoldersAreNoLibraries) {
  Loaded loaded;
  const std::string obj = write_file("f.obj", "mtllib .\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
  EXPECT_THROW(load_part_materials(obj, load_obj_parts(obj), loaded.textures, loaded.warnings), Error);
  EXPECT_THROW(load_obj(file_path("")), Error);
}

TEST(Mtl, PipesAreNoLibraries) {
  Loaded loaded;
  const std::string pipe = file_path("pipe.mtl");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error_of([&] { load_mtl(pipe, {}, loaded.textures, loaded.warnings); }),
            "pipe.mtl: not a file, expected an OBJ or MTL file");
}

TEST(Mtl, FilesLoadInParallel) {
  const std::string path = write_file("m.obj", kObj);
  std::vector<std::thread> threads;
  std::vector<std::size_t> counts(4);
  for (std::size_t& count : counts) {
    threads.emplace_back([&path, &count] {
      for (int i = 0; i < 50; ++i) count += load_obj_parts(path).parts.size();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::size_t count : counts) EXPECT_EQ(count, 150u);
}

}  // namespace
}  // namespace becalm::tracer::test
