// Procedural surfaces in whole renders: they do not shade themselves, and turn and scale as meshes do.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tracer/estimates.h"
#include "tracer/camera.h"
#include "tracer/snapshot/snapshot.h"

namespace becalm::tracer::test {
namespace {

std::string under_the_sky(const std::string& mesh, const std::string& material, const std::string& integrator,
                          const std::string& look_at, const std::string& fov_deg = "30") {
  return "{'film': {'width': 48, 'height': 32}, 'integrator': {" + integrator +
         "}, 'camera': {'fov_y_deg': " + fov_deg + ", 'look_at': {" + look_at +
         R"(}}, 'environment': {'radiance': [1,2,3]},
    'materials': {'white': {'type': 'diffuse', 'reflectance': 1}, 'mirror': {'type': 'conductor', 'reflectance': 1}},
    'meshes': {'m': {)" +
         mesh + "}}, 'objects': [{'mesh': 'm', 'material': '" + material + "'}]}";
}

const struct {
  const char* mesh;
  const char* look_at;
} kSurfaces[] = {
    {"'procedural': 'terrain', 'size': 10, 'height': 2, 'resolution': 256, 'seed': 1",
     "'eye': [0,4,9], 'target': [0,0.5,0]"},
    {"'procedural': 'ocean', 'size': 10, 'wavelength': 2, 'shortest_wavelength': 0.1, 'wave_height': 0.3",
     "'eye': [0,2,8], 'target': [0,0,0]"},
    {"'procedural': 'blobs', 'count': 8, 'seed': 3", "'eye': [0,2,4], 'target': [0,0,0]"}};

/// Samples whose radiance is less than the sky's. No pixel has more than `largest` times the sky's.
int samples_lost(const std::string& json, float largest = 1.0f + 1e-4f) {
  constexpr int spp = 16;
  Scene scene = load_text(json);
  const Frame frame = render_frame(scene, 1, options(spp)).value();
  int lost = 0;
  for (int i = 0; i < 48 * 32; ++i) {
    const float value = frame.image(Aov::beauty).data()[4 * i];
    EXPECT_LT(value, largest);
    EXPECT_NEAR(frame.image(Aov::beauty).data()[4 * i + 2], 3.0f * value, 1e-4f);
    lost += static_cast<int>(std::lround(std::max(0.0f, 1.0f - value) * spp));
  }
  return lost;
}

TEST(Procedurals, PerfectMirrorsInAUniformSkyDisappear) {
  // However often a ray is reflected. What slopes within a pixel widens into a lobe, whose further bounces
  // are sampled with other weights than 1.
  for (const auto& [mesh, look_at] : kSurfaces) {
    const int lost = samples_lost(
        under_the_sky(mesh, "mirror", "'max_depth': 60, 'roulette_depth': 100, 'direct': 'material'", look_at,
                      "1"),
        /*largest=*/2.0f);
    EXPECT_LE(lost, 48 * 32 * 16 / 50) << mesh;
  }
}

TEST(Procedurals, WhiteSurfacesInAUniformSkyDisappear) {
  for (const auto& [mesh, look_at] : kSurfaces) {
    // Directions that shading and geometric normal do not agree on are dropped: few, since the shading normal
    // is averaged over less than the waves' length.
    EXPECT_LE(samples_lost(under_the_sky(
                  mesh, "white", "'max_depth': 200, 'roulette_depth': 300, 'direct': 'material'", look_at)),
              48 * 32 * 16 / 50)
        << mesh;
  }
}

TEST(Procedurals, ACalmOceanIsAFlatPlane) {
  const std::string mesh = "'procedural': 'ocean', 'size': 100, 'wavelength': 10, 'wave_height': 0";
  const std::string json = under_the_sky(mesh, "white", "'max_depth': 1, 'direct': 'material'",
                                         "'eye': [0,2,8], 'target': [0,0,0]");
  EXPECT_EQ(samples_lost(json), 0);
  Scene scene = load_text(json);
  const Frame frame = render_frame(scene, 1, options(1, {Aov::normal, Aov::depth})).value();
  int water = 0;
  for (int i = 0; i < 48 * 32; ++i) {
    if (!std::isfinite(frame.image(Aov::depth).data()[i])) continue;
    ++water;
    EXPECT_NEAR(frame.image(Aov::normal).data()[3 * i + 1], 1.0f, 1e-5f);
  }
  EXPECT_GT(water, 700);
}

TEST(Procedurals, FlatOnesCarryImagesAsTheRectangleDoes) {
  write_uv_picture();
  const auto seen = [](const std::string& mesh) {
    Scene scene = load_text(
        R"({'film': {'width': 16, 'height': 16, 'filter': {'type': 'box', 'radius_px': 0}},
      'camera': {'fov_y_deg': 20, 'look_at': {'eye': [0,5,1], 'target': [0,0,0]}},
      'materials': {'m': {'type': 'diffuse', 'reflectance': {'image': 'uv.ppm', 'space': 'linear'}}},
      'meshes': {'flat': {)" +
        mesh + "}}, 'objects': [{'mesh': 'flat', 'material': 'm'}]}");
    return render_frame(scene, 1, options(1, {Aov::albedo})).value();
  };
  const Frame rectangle = seen("'shape': 'rectangle'");
  for (const char* mesh : {"'procedural': 'terrain', 'size': 2, 'height': 1e-4, 'resolution': 64",
                           "'procedural': 'ocean', 'size': 2, 'wavelength': 1, 'wave_height': 0"}) {
    const Frame procedural = seen(mesh);
    int different = 0;
    for (std::size_t i = 0; i < rectangle.image(Aov::albedo).data().size(); ++i) {
      different +=
          std::abs(procedural.image(Aov::albedo).data()[i] - rectangle.image(Aov::albedo).data()[i]) > 0.03f;
    }
    EXPECT_LT(different, 20) << "of 768 values of " << mesh;
  }
}

TEST(Procedurals, MotionIsThatOfTheHeights) {
  const struct {
    const char* mesh;
    double least_px;  ///< the longest motion is at least this long
  } fields[] = {
      {"'procedural': 'ocean', 'size': 10, 'wavelength': 2, 'wave_height': 0.3, "
       "'time_s': {'keys': [{'frame': 1, 'value': 0}, {'frame': 3, 'value': 0.3}]}",
       1.0},
      {"'procedural': 'terrain', 'size': 10, 'resolution': 256, "
       "'height': {'keys': [{'frame': 1, 'value': 1}, {'frame': 3, 'value': 2}]}",
       1.0},
      {"'procedural': 'blobs', 'time_s': {'keys': [{'frame': 1, 'value': 0}, {'frame': 3, 'value': 1}]}",
       0.0}};
  const Camera camera({{0, 3, 9}, {0, 0, 0}, {0, 1, 0}}, 30.0, 48, 32);
  for (const auto& [mesh, least_px] : fields) {
    std::string json = under_the_sky(mesh, "white", "'max_depth': 1", "'eye': [0,3,9], 'target': [0,0,0]");
    json.replace(json.find("'height': 32"), 12, "'height': 32, " + std::string(kPointFilter));
    Scene scene = load_text(json);
    const auto frame_of = [&](int number) {
      return render_frame(scene, number, options(1, {Aov::depth, Aov::motion})).value();
    };
    const Frame frame = frame_of(2), still = frame_of(5);
    Procedural before;
    update(std::get<ProceduralDescription>(scene.description().meshes[0]), 1.0, before);
    double longest = 0.0;
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 48; ++x) {
        EXPECT_EQ(V2f(still.image(Aov::motion).at(x, y, 0), still.image(Aov::motion).at(x, y, 1)), V2f(0.0f))
            << "nothing moves: exactly none";
        const float depth = frame.image(Aov::depth).at(x, y, 0);
        if (!std::isfinite(depth)) continue;
        const V2d at(x + 0.5, y + 0.5);
        V3d p = V3d(camera.eye()) + camera.direction(V2f(at)).normalized() * static_cast<double>(depth);
        if (least_px > 0.0) p.y = point(before, V3f(p)).position.y;
        const V2d expected = *camera.project(p) - at;
        EXPECT_NEAR(frame.image(Aov::motion).at(x, y, 0), expected.x, 2e-3) << mesh;
        EXPECT_NEAR(frame.image(Aov::motion).at(x, y, 1), expected.y, 2e-3) << mesh;
        longest = std::max(longest, expected.length());
      }
    }
    EXPECT_GE(longest, least_px) << mesh;
  }
}

std::string blobs(const std::string& transform, const std::string& look_at, const std::string& lamp) {
  return R"({'film': {'width': 32, 'height': 32, 'filter': {'type': 'box', 'radius_px': 0}}, 'integrator': {'max_depth': 1},
    'camera': {'fov_y_deg': 35, 'look_at': {)" +
         look_at + "}}, 'lights': {'lamp': {'type': 'point', " + lamp + R"(}},
    'materials': {'m': {'type': 'conductor', 'reflectance': 0.9, 'roughness': 0.5}},
    'meshes': {'m': {'procedural': 'blobs', 'count': 8, 'seed': 3}},
    'objects': [{'mesh': 'm', 'material': 'm', 'transform': )" +
         transform + "}]}";
}

TEST(Procedurals, TurnAndScaleAsTheirSceneDoes) {
  const double size = 250.0;
  const M44d place = transform_at(TransformCurve::Value{30, -20, 10, 25, 40, -70, size, size, size}, 0.0);
  const auto point = [&](const V3d& p) {
    const V3d q = transform_point(p, place);
    char text[100];
    std::snprintf(text, sizeof text, "[%.9g,%.9g,%.9g]", q.x, q.y, q.z);
    return std::string(text);
  };
  const V3d up = transform_vector(V3d(0, 1, 0), place);
  char up_text[100];
  std::snprintf(up_text, sizeof up_text, "[%.9g,%.9g,%.9g]", up.x, up.y, up.z);
  Scene plain =
      load_text(blobs("{}", "'eye': [0,2,4], 'target': [0,0,0]", "'position': [3,4,2], 'intensity': 10"));
  Scene turned =
      load_text(blobs("{'scale': 250, 'rotate_deg': [25,40,-70], 'translate': [30,-20,10]}",
                      "'eye': " + point({0, 2, 4}) + ", 'target': " + point({0, 0, 0}) + ", 'up': " + up_text,
                      "'position': " + point({3, 4, 2}) + ", 'intensity': 625000"));
  const auto o = options(1, {Aov::normal, Aov::depth});
  const Frame a = render_frame(plain, 1, o).value(), b = render_frame(turned, 1, o).value();
  int hits = 0, different = 0;
  for (int i = 0; i < 32 * 32; ++i) {
    const float depth_a = a.image(Aov::depth).data()[i], depth_b = b.image(Aov::depth).data()[i];
    if (!std::isfinite(depth_a) || !std::isfinite(depth_b)) {
      different += std::isfinite(depth_a) != std::isfinite(depth_b);
      continue;
    }
    ++hits;
    const float* na = &a.image(Aov::normal).data()[3 * i];
    const float* nb = &b.image(Aov::normal).data()[3 * i];
    const V3d expected = transform_vector(V3d(na[0], na[1], na[2]), place) / size;
    const float va = a.image(Aov::beauty).data()[4 * i], vb = b.image(Aov::beauty).data()[4 * i];
    const bool same = std::abs(depth_b / size - depth_a) < 1e-3f &&
                      (expected - V3d(nb[0], nb[1], nb[2])).length() < 5e-3 &&
                      std::abs(va - vb) < 0.02f * std::max(va, vb) + 1e-3f;
    different += !same;
  }
  EXPECT_GE(hits, 150);
  EXPECT_LT(different, 10) << "silhouettes apart";
}

}  // namespace
}  // namespace becalm::tracer::test
