#include "tracer/scene/texture.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "frame/error.h"
#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/scene/mip_texture.h"

namespace becalm::tracer::test {
namespace {

/// Rows from the top: red green / blue grey.
const std::vector<float> kFour = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5f, 0.5f, 0.5f};

V3f lookup(const TextureSettings& settings, const V2f& uv, float footprint = 0.0f) {
  Textures textures;
  const std::uint32_t texture = textures.add(settings);
  const V3f color = Textures::Reader(textures).color(texture, {uv, {footprint, 0.0f}, {0.0f, footprint}});
  textures.check();
  return color;
}

void expect_near(const V3f& value, const V3f& truth, float tolerance = 2e-3f) {
  EXPECT_NEAR((value - truth).length(), 0.0f, tolerance) << value << " instead of " << truth;
}

TEST(Texture, VPointsUpAndSrgbIsDecoded) {
  const TextureSettings settings{write_image("four.png", 2, 2, 3, kFour), ColorSpace::srgb, {{1, 1}}, V3f(1)};
  expect_near(lookup(settings, {0.25f, 0.75f}), V3f(1, 0, 0));
  expect_near(lookup(settings, {0.75f, 0.75f}), V3f(0, 1, 0));
  expect_near(lookup(settings, {0.25f, 0.25f}), V3f(0, 0, 1));
  const float coded = std::round(0.5f * 255.0f) / 255.0f;
  expect_near(lookup(settings, {0.75f, 0.25f}), V3f(std::pow((coded + 0.055f) / 1.055f, 2.4f)));
}

TEST(Texture, LinearFilesAreTakenAsTheyAre) {
  const TextureSettings settings{
      write_image("four.exr", 2, 2, 3, kFour), ColorSpace::linear, {{1, 1}}, V3f(1, 0.5f, 4)};
  expect_near(lookup(settings, {0.75f, 0.25f}), V3f(0.5f, 0.25f, 1.0f));
}

TEST(Texture, FloatSamplesAreLinearUnlessToldOtherwise) {
  const std::vector<float> half_grey(3, 0.5f);
  const float decoded = std::pow((0.5f + 0.055f) / 1.055f, 2.4f);
  const auto value = [](const std::string& path, std::optional<ColorSpace> space = std::nullopt) {
    return lookup({.path = path, .space = space}, {0.5f, 0.5f}).x;
  };
  for (const char* name : {"float.exr", "float.hdr", "float.tif"}) {
    const std::string path = write_image(name, 1, 1, 3, half_grey);
    EXPECT_NEAR(value(path), 0.5f, 2e-3f) << name;
    EXPECT_NEAR(value(path, ColorSpace::srgb), decoded, 2e-3f) << name;
  }
  const std::string half = write_image("half.exr", 1, 1, 3, half_grey, OIIO::TypeHalf);
  EXPECT_NEAR(value(half), 0.5f, 2e-3f);
  for (const auto& [name, type] :
       {std::pair("bytes.tif", OIIO::TypeUInt8), {"words.png", OIIO::TypeUInt16}}) {
    const std::string path = write_image(name, 1, 1, 3, half_grey, type);
    EXPECT_NEAR(value(path), decoded, 3e-3f) << name;
    EXPECT_NEAR(value(path, ColorSpace::linear), 0.5f, 3e-3f) << name;
  }
}

TEST(Texture, FloatImagesOfScenesAreLinear) {
  write_image("grey.exr", 1, 1, 3, {0.5f, 0.5f, 0.5f});
  const auto reflectance = [](const std::string& more) {
    const Scene scene = load_text(R"({'camera': {'look_at': {'eye': [0,2,1], 'target': [0,0,0]}},
      'materials': {'m': {'type': 'diffuse', 'reflectance': {'image': 'grey.exr')" +
                                  more + "}}}, 'meshes': {}, 'objects': []}");
    const Textures& textures = scene.description().textures;
    return Textures::Reader(textures).color(0, {V2f(0.5f)}).x;
  };
  EXPECT_NEAR(reflectance(""), 0.5f, 1e-3f);
  EXPECT_NEAR(reflectance(", 'space': 'srgb'"), 0.214f, 1e-3f);
}

TEST(Texture, Repeats) {
  const TextureSettings settings{write_image("four.png", 2, 2, 3, kFour), ColorSpace::srgb, {{2, 3}}, V3f(1)};
  expect_near(lookup(settings, {0.125f, 1.0f - 0.25f / 3.0f}), V3f(1, 0, 0));
  expect_near(lookup(settings, {0.625f, 1.0f - 1.25f / 3.0f}), V3f(1, 0, 0));
  expect_near(lookup(settings, {-0.875f, 3.0f - 2.25f / 3.0f}), V3f(1, 0, 0));
}

TEST(Texture, GreyAndAlphaFiles) {
  expect_near(
      lookup({write_image("grey.png", 1, 1, 1, {1.0f}), ColorSpace::srgb, {{1, 1}}, V3f(1)}, {0.5f, 0.5f}),
      V3f(1));
  expect_near(lookup({write_image("alpha.png", 1, 1, 4, {1, 1, 0, 1}), ColorSpace::srgb, {{1, 1}}, V3f(1)},
                     {0.5f, 0.5f}),
              V3f(1, 1, 0));
}

TEST(Texture, DistantDetailAveragesLightAndNotCodes) {
  // A checkerboard of black and white, 64x64, from far away: half the light, where sRGB codes would give
  // 0.21.
  std::vector<float> pixels(64 * 64 * 3);
  for (int i = 0; i < 64 * 64; ++i) {
    for (int c = 0; c < 3; ++c) pixels[3 * i + c] = static_cast<float>((i + i / 64) % 2);
  }
  const TextureSettings settings{
      write_image("checks.png", 64, 64, 3, pixels), ColorSpace::srgb, {{1, 1}}, V3f(1)};
  expect_near(lookup(settings, {0.51f, 0.52f}, 0.5f), V3f(0.5f), 5e-3f);
  const V3f sharp = lookup(settings, {0.5f / 64, 0.5f / 64}, 0.0f);
  EXPECT_TRUE(sharp.x < 0.01f || sharp.x > 0.99f);
}

TEST(Texture, TiledFilesReadAsScanlineOnes) {
  std::vector<float> pixels(40 * 50 * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i % 97) / 97.0f;
  const std::string path = file_path("tiled.exr");
  OIIO::ImageSpec spec(40, 50, 3, OIIO::TypeFloat);
  spec.tile_width = spec.tile_height = 16;
  auto file = OIIO::ImageOutput::create(path);
  file->open(path, spec);
  file->write_image(OIIO::TypeFloat, pixels.data());
  file->close();
  const std::string scanlines = write_image("scanlines.exr", 40, 50, 3, pixels);
  for (const V2f& uv : {V2f(0.0125f, 0.99f), V2f(0.9875f, 0.01f), V2f(0.5f, 0.35f)}) {
    const TextureSettings a{path, ColorSpace::linear, {{1, 1}}, V3f(1)},
        b{scanlines, ColorSpace::linear, {{1, 1}}, V3f(1)};
    EXPECT_EQ(lookup(a, uv), lookup(b, uv));
    const int x = static_cast<int>(uv.x * 40), y = static_cast<int>((1 - uv.y) * 50);
    if (uv.x != 0.5f) {  // a texel's centre
      EXPECT_NEAR(lookup(a, uv).y, pixels[(y * 40 + x) * 3 + 1], 1e-3f);
    }
  }
}

TEST(Texture, ChannelsAreTakenAsTheyAre) {
  const std::string path = write_image("channels.exr", 1, 1, 4, {0.125f, 2.5f, -3.0f, 0.75f});
  const auto channel = [&](TextureContent content) {
    Textures textures;
    const std::uint32_t texture = textures.add({.path = path, .scale = V3f(2.0f), .content = content});
    return Textures::Reader(textures).scalar(texture, {{0.5f, 0.5f}});
  };
  EXPECT_EQ(channel(TextureContent::r), 0.25f);
  EXPECT_EQ(channel(TextureContent::g), 5.0f);
  EXPECT_EQ(channel(TextureContent::b), -6.0f);
  EXPECT_EQ(channel(TextureContent::a), 1.5f);
  Textures textures;
  EXPECT_THROW(textures.add({.path = write_image("grey.exr", 1, 1, 1, {1.0f}), .content = TextureContent::a}),
               std::runtime_error);
  const std::uint32_t grey = textures.add({.path = file_path("grey.exr"), .content = TextureContent::b});
  EXPECT_EQ(Textures::Reader(textures).scalar(grey, {{0.5f, 0.5f}}), 1.0f) << "grey serves as b";
}

TEST(Texture, FootprintsAreAnisotropic) {
  // Columns of black and white: blurred across by a footprint along u, sharp under one along v.
  std::vector<float> pixels(64 * 64 * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i / 3 % 2);
  const std::string path = write_image("columns.exr", 64, 64, 3, pixels);
  Textures textures;
  const std::uint32_t texture = textures.add({.path = path, .space = ColorSpace::linear});
  const Textures::Reader reader(textures);
  const V2f white(1.5f / 64, 0.5f);
  EXPECT_GT(reader.color(texture, {white, {0.0f, 4.0f / 64}, {1.0f / 64, 0.0f}}).x, 0.8f);
  EXPECT_NEAR(reader.color(texture, {white, {4.0f / 64, 0.0f}, {0.0f, 1.0f / 64}}).x, 0.5f, 0.1f);
}

TEST(Texture, AnyNumberIsAPlace) {
  Textures textures;
  const std::uint32_t texture =
      textures.add({.path = write_image("four.exr", 2, 2, 3, kFour), .space = ColorSpace::linear});
  const Textures::Reader reader(textures);
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                  infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, infinity, -infinity, 1e30f, -1e30f, 1e-30f}) {
    EXPECT_TRUE(is_finite(reader.color(texture, {V2f(bad), {0.1f, 0.0f}, {0.0f, 0.1f}}))) << bad;
    EXPECT_TRUE(is_finite(reader.color(texture, {V2f(0.3f), V2f(bad), V2f(bad)}))) << bad;
  }
  expect_near(reader.color(texture, {V2f(0.3f), V2f(infinity), V2f(nan)}), V3f(0.375f), 0.01f);
  const std::uint32_t broken = textures.add(
      {.path = write_image("broken.exr", 1, 1, 3, {nan, infinity, 1e30f}), .space = ColorSpace::linear});
  EXPECT_EQ(reader.color(broken, {V2f(0.5f)}), V3f(0, 0, 1)) << "what is not finite counts as 0";
}

TEST(Texture, FootprintsShrinkWithTheSampleCount) {
  // The area of n lookups is that of one with all of the pixel: a bias of -log2(n) / 2 levels.
  EXPECT_EQ(footprint_scale(1), 1.0f);
  EXPECT_EQ(footprint_scale(4), 0.5f);
  for (const int n : {2, 3, 9, 100, 1024}) {
    EXPECT_NEAR(std::log2(footprint_scale(n)), -0.5 * std::log2(n), 1e-6) << n;
  }
  EXPECT_EQ(footprint_scale(4096), kLeastFootprintScale);
  EXPECT_EQ(footprint_scale(0), 1.0f);
}

TEST(Texture, ResidentOnesReadAsThoseOnDemand) {
  // Odd sizes, so that levels are not of two by two.
  const int width = 37, height = 21;
  std::vector<float> pixels(width * height * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i * 7919 % 101) / 101.0f;
  const TextureSettings settings{.path = write_image("odd.exr", width, height, 3, pixels),
                                 .space = ColorSpace::linear};
  Textures on_demand, resident;
  const std::uint32_t texture = on_demand.add(settings);
  resident.make_resident({resident.add(settings)}, 1 << 20);
  EXPECT_EQ(resident.resident_bytes(), MipTexture::bytes(width, height, 3));
  EXPECT_EQ(on_demand.resident_bytes(), 0u);
  const Textures::Reader a(on_demand), b(resident);
  for (const float u : {0.0f, 0.013f, 0.4f, 0.77f, 0.999f, -3.3f}) {
    for (const float v : {0.0f, 0.021f, 0.5f, 0.93f, 1.0f, 12.6f})
      expect_near(b.color(texture, {V2f(u, v)}), a.color(texture, {V2f(u, v)}), 3e-3f);
  }
  // From afar every place shows the mean.
  double mean = 0.0;
  for (std::size_t i = 0; i < pixels.size(); i += 3) mean += pixels[i] / (width * height);
  for (const float u : {0.1f, 0.6f}) {
    EXPECT_NEAR(b.color(texture, {V2f(u), {1.0f, 0.0f}, {0.0f, 1.0f}}).x, mean, 2e-4);
  }
}

TEST(Texture, WhatDoesNotFitIsReadOnDemand) {
  const std::vector<float> pixels(64 * 64 * 3, 0.25f);
  Textures textures;
  const std::uint32_t large = textures.add({.path = write_image("large.exr", 64, 64, 3, pixels)});
  const std::uint32_t small = textures.add({.path = write_image("small.exr", 2, 2, 3, kFour)});
  textures.make_resident({large, small}, MipTexture::bytes(2, 2, 3));
  EXPECT_EQ(textures.resident_bytes(), MipTexture::bytes(2, 2, 3));
  const std::uint32_t hot =
      textures.add({.path = write_image("hot.exr", 2, 1, 3, {0.3f, 0.3f, 0.3f, 60000, 0, 0}),
                    .space = ColorSpace::linear});
  textures.make_resident({large, small, hot}, MipTexture::bytes(2, 2, 3) + MipTexture::bytes(2, 1, 3));
  const Textures::Reader reader(textures);
  EXPECT_NEAR(reader.color(hot, {V2f(0.25f, 0.5f)}).y, 0.3f, 1e-3f)
      << "one hot pixel costs the others nothing";
  EXPECT_GT(reader.color(large, {V2f(0.5f)}).x, 0.0f);
  EXPECT_GT(reader.color(small, {V2f(0.25f, 0.75f)}).x, 0.9f);
}

TEST(Texture, ThoseOfObjectsAloneAreResident) {
  write_image("four.png", 2, 2, 3, kFour);
  const auto bytes = [](const std::string& material) {
    const std::string texture = "{'image': 'four.png', 'space': 'srgb'}";
    const Scene scene = load_text(
        "{'camera': {'look_at': {'eye': [0,2,1], 'target': [0,0,0]}},"
        "'materials': {'plain': {'type': 'diffuse', 'reflectance': 0.5},"
        "'painted': {'type': 'diffuse', 'reflectance': " +
        texture +
        "},"
        "'both': {'type': 'mix', 'materials': ['plain', 'painted'], 'factor': 0.5}},"
        "'meshes': {'p': {'shape': 'rectangle'}}, 'objects': [{'mesh': 'p', 'material': '" +
        material + "'}]}");
    return scene.description().textures.resident_bytes();
  };
  EXPECT_EQ(bytes("plain"), 0u);
  EXPECT_GT(bytes("painted"), 0u);
  EXPECT_GT(bytes("both"), 0u);
}

TEST(Texture, DamagedFilesAreReportedWithTheirName) {
  std::vector<float> pixels(64 * 64 * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i * i % 251) / 255.0f;
  const std::string path = write_image("whole.exr", 64, 64, 3, pixels);
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  bytes.resize(bytes.size() / 2);
  write_file("cut.exr", bytes);
  const auto expect_named = [](const auto& reading) {
    try {
      reading();
      FAIL() << "half a file was read as a whole one";
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), ExitStatus::bad_input);
      EXPECT_NE(std::string(error.what()).find("cut.exr"), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
    }
  };
  expect_named([&] {
    load_text(R"({'camera': {'look_at': {'eye': [0,2,0], 'target': [0,0,0], 'up': [0,0,-1]}},
      'materials': {'m': {'type': 'diffuse', 'reflectance': {'image': 'cut.exr'}}},
      'meshes': {'p': {'shape': 'rectangle'}}, 'objects': [{'mesh': 'p', 'material': 'm'}]})");
  });
  expect_named([&] {  // what is read on demand
    Textures textures;
    const std::uint32_t texture = textures.add({.path = file_path("cut.exr")});
    Textures::Reader(textures).color(texture, {V2f(0.5f, 0.01f)});
    textures.check();
  });
  EXPECT_NE(load_error(R"({'camera': {'look_at': {'eye': [0,2,1], 'target': [0,0,0]}},
    'materials': {'m': {'type': 'diffuse', 'reflectance': {'image': 'scene.json'}}}, 'meshes': {}, 'objects': []})")
                .find("scene.json: /materials/m/reflectance/image: cannot read 'scene.json'"),
            std::string::npos);
}

TEST(Texture, ShowsOnSurfaces) {
  // The rectangle seen from above with -z up shows the picture upright.
  write_image("four.png", 2, 2, 3, kFour);
  Scene scene = load_text(R"({'film': {'width': 2, 'height': 2, 'filter': {'type': 'box', 'radius_px': 0}},
    'integrator': {'max_depth': 1}, 'environment': {'radiance': 1},
    'camera': {'fov_y_deg': 53.13, 'look_at': {'eye': [0,2,0], 'target': [0,0,0], 'up': [0,0,-1]}},
    'materials': {'m': {'type': 'diffuse', 'reflectance': {'image': 'four.png', 'space': 'srgb'}}},
    'meshes': {'p': {'shape': 'rectangle'}}, 'objects': [{'mesh': 'p', 'material': 'm'}]})");
  EXPECT_TRUE(scene.needs().textures);
  const Frame frame = render_frame(scene, 1, options(16, {Aov::albedo})).value();
  const auto albedo = [&](int x, int y) {
    const auto p = frame.image(Aov::albedo).pixel(x, y);
    return V3f(p[0], p[1], p[2]);
  };
  EXPECT_GT(albedo(0, 0).x, 0.99f);
  EXPECT_GT(albedo(1, 0).y, 0.99f);
  EXPECT_GT(albedo(0, 1).z, 0.99f);
  EXPECT_NEAR(frame.image(Aov::beauty).at(0, 0, 0), 1.0f, 0.1f)
      << "a plane under a sky of 1 shows its reflectance";
}

constexpr const char* kBoxFilter = "'filter': {'type': 'box', 'radius_px': 0.5}";

/// How far the albedo of columns of black and white is from grey, on average. They stand at `distance` before
/// the camera; at a distance of 1 a pixel is as wide as 1.6 of them. Pixels whose only ray was reflected and
/// met nothing do not count.
double contrast_of_columns(double distance, const std::string& film, const std::string& glass = "") {
  std::vector<float> pixels(64 * 64 * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i / 3 % 2);
  write_image("columns.exr", 64, 64, 3, pixels);
  Scene scene = load_text("{'film': {'width': 48, 'height': 32, " + film +
                          R"(}, 'camera': {'fov_y_deg': 10, 'look_at': {'eye': [0,0,0], 'target': [0,0,-1]}},
    'materials': {'glass': {'type': 'dielectric', 'ior': 1.5},
      'm': {'type': 'diffuse', 'reflectance': {'image': 'columns.exr', 'space': 'linear', 'repeat': [37.5,37.5]}}},
    'meshes': {'plane': {'shape': 'rectangle'}}, 'objects': [)" +
                          glass +
                          "{'mesh': 'plane', 'material': 'm', 'transform': {'rotate_deg': [90,0,0], 'scale': "
                          "4, 'translate': [0,0," +
                          std::to_string(-distance) + "]}}]}");
  const Frame frame = render_frame(scene, 1, options(1, {Aov::albedo, Aov::normal})).value();
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < frame.image(Aov::albedo).pixel_count(); ++i) {
    if (frame.image(Aov::normal).data()[3 * i + 2] == 0.0f) continue;
    sum += std::abs(frame.image(Aov::albedo).data()[3 * i] - 0.5);
    ++count;
  }
  EXPECT_GT(count, 1000);
  return sum / count;
}

TEST(Texture, FootprintsOfJitteredFramesAreThoseOfAWholeCycle) {
  const double blurred = contrast_of_columns(1.0, kBoxFilter);
  const double sharp = contrast_of_columns(1.0, std::string("'jitter_cycle': 64, ") + kBoxFilter);
  EXPECT_LT(blurred, 0.15);
  EXPECT_GT(sharp, 0.2);
}

TEST(Texture, FootprintsBehindGlassAreNarrowerByItsIndex) {
  // What stands in glass 1.5 times as far looks as it does without.
  const double bare = contrast_of_columns(1.0, kBoxFilter);
  const double behind = contrast_of_columns(1.5, kBoxFilter,
                                            "{'mesh': 'plane', 'material': 'glass', 'transform': "
                                            "{'rotate_deg': [90,0,0], 'translate': [0,0,-1e-3]}}, ");
  EXPECT_NEAR(behind / bare, 1.0, 0.05) << bare;
}

}  // namespace
}  // namespace becalm::tracer::test
