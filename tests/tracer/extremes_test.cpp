// Sizes, numbers and meshes at the ends of their ranges: a right result or a clear error.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "frame/error.h"
#include "tests/tracer/estimates.h"
#include "tests/tracer/everything_scene.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/scene/shapes.h"

namespace becalm::tracer::test {
namespace {

TEST(Extremes, EverythingLooksTheSameAtAnySize) {
  constexpr int pixels = 24 * 18;
  const auto rendered = [](double unit) {
    // Without scattering in media every path is the same at all sizes, but for those within rounding errors
    // of an edge.
    Scene scene = load_text(
        everything_scene({.unit = unit, .film = "'width': 24, 'height': 18", .scatters_in_media = false}));
    RenderReport report;
    Frame frame =
        render_frame(scene, 2, options(4, {Aov::normal, Aov::depth, Aov::motion, Aov::object_id}), &report)
            .value();
    EXPECT_EQ(report.non_finite_samples, 0u) << unit;
    return frame;
  };
  const Frame reference = rendered(1.0);
  for (const double unit : {1e-4, 1e6}) {
    const Frame frame = rendered(unit);
    int different = 0, moved = 0;
    double sum = 0.0, difference = 0.0;
    for (int i = 0; i < pixels; ++i) {
      const float a = reference.image(Aov::beauty).data()[4 * i + 1],
                  b = frame.image(Aov::beauty).data()[4 * i + 1];
      different += std::abs(a - b) > 0.02f * std::max(a, b);
      sum += a;
      difference += b - a;
      const double depth = frame.image(Aov::depth).data()[i] / unit;
      moved += std::isfinite(depth) && std::abs(depth - reference.image(Aov::depth).data()[i]) > 1e-2;
    }
    EXPECT_LT(different, pixels / 8) << unit;
    EXPECT_LT(moved, pixels / 50) << unit;
    EXPECT_LT(std::abs(difference), 0.02 * sum) << unit;
  }
}

TEST(Extremes, FogScalesWithItsScene) {
  const auto at = [](const char* name, double unit, std::uint32_t seed) {
    return Estimator{
        name,
        everything_scene({.unit = unit, .film = "'width': 16, 'height': 12", .integrator = "'max_depth': 3"}),
        8,
        12,
        seed,
        2};
  };
  expect_same_expectation(at("tiny", 1e-4, 1), at("metres", 1.0, 400), 4, 0.1, 3e-3);
  expect_same_expectation(at("huge", 1e6, 800), at("metres", 1.0, 400), 4, 0.1, 3e-3);
}

std::string simple(const std::string& objects, const std::string& more = "'environment': {'radiance': 1}, ",
                   const std::string& meshes = "", const std::string& film = "'width': 8, 'height': 8") {
  return "{'film': {" + film + R"(}, 'integrator': {'max_depth': 3},
    'camera': {'fov_y_deg': 40, 'look_at': {'eye': [0,1,5], 'target': [0,0,0]}}, )" +
         more + R"(
    'materials': {'white': {'type': 'diffuse', 'reflectance': 0.5}, 'air': {'type': 'interface'}},
    'media': {'fog': {'type': 'homogeneous', 'extinction': 0.5, 'albedo': 0.9}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'cube': {'shape': 'cube'}, 'ball': {'shape': 'exact_sphere'})" +
         meshes + "}, 'objects': [" + objects + "]}";
}

struct Rendered {
  Frame frame;
  RenderReport report;
};
Rendered render(Scene& scene, int spp = 4) {
  Rendered result;
  result.frame = render_frame(scene, 1, options(spp, {Aov::variance, Aov::albedo, Aov::normal, Aov::depth}),
                              &result.report)
                     .value();
  return result;
}
Rendered render(const std::string& json, int spp = 4) {
  Scene scene = load_text(json);
  return render(scene, spp);
}

void expect_finite(const Frame& frame, const std::string& what) {
  for (const Aov aov : {Aov::beauty, Aov::variance, Aov::albedo, Aov::normal}) {
    for (const float v : frame.image(aov).data())
      ASSERT_TRUE(std::isfinite(v)) << what << ": " << info(aov).name;
  }
}

const std::string kCube = "{'mesh': 'cube', 'material': 'white'}";

TEST(Extremes, DegenerateTrianglesAreNotThere) {
  // A corner twice, three corners in a line, all in one point: beside a proper triangle.
  write_file(
      "odd.obj",
      "v -1 0 0\nv 1 0 0\nv 0 1 0\nv 3 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\nf 1 1 3\nf 1 2 4\nf 5 6 5\nf 5 5 5\n");
  write_file("plain.obj", "v -1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const char* emission : {"", ", 'emission': 2"}) {
    const auto json = [&](const char* file) {
      return simple("{'mesh': 'odd', 'material': 'white'" + std::string(emission) +
                        "}, {'mesh': 'plane', 'material': 'white', 'transform': {'translate': [0,-1,0]}}",
                    "'environment': {'radiance': 1}, ", ", 'odd': {'obj': '" + std::string(file) + "'}");
    };
    const Rendered odd = render(json("odd.obj"), 64), plain = render(json("plain.obj"), 64);
    EXPECT_EQ(odd.report.non_finite_samples, 0u);
    expect_finite(odd.frame, emission);
    const Mean a = mean_radiance(odd.frame), b = mean_radiance(plain.frame);
    EXPECT_NEAR(a.value, b.value, 4.0 * std::hypot(a.error, b.error) + 1e-6);
  }
}

TEST(Extremes, LightsWithoutAreaGiveNothing) {
  write_file("line.obj", "v -1 2 0\nv 1 2 0\nv 0 2 0\nf 1 2 3\n");
  const Rendered with = render(simple(kCube + ", {'mesh': 'line', 'material': 'white', 'emission': 1e6}",
                                      "'environment': {'radiance': 1}, ", ", 'line': {'obj': 'line.obj'}"),
                               16);
  const Rendered without = render(simple(kCube), 16);
  EXPECT_EQ(with.report.non_finite_samples, 0u);
  const Mean a = mean_radiance(with.frame), b = mean_radiance(without.frame);
  EXPECT_NEAR(a.value, b.value, 4.0 * std::hypot(a.error, b.error) + 1e-6);
  // And where there is no other light.
  const Rendered dark = render(simple(kCube + ", {'mesh': 'line', 'material': 'white', 'emission': 1e6}", "",
                                      ", 'line': {'obj': 'line.obj'}"));
  EXPECT_EQ(mean_radiance(dark.frame).value, 0.0);
  EXPECT_EQ(dark.report.non_finite_samples, 0u);
}

TEST(Extremes, VerticesThatAreNoNumbersAreErrorsInFiles) {
  for (const char* number : {"nan", "inf", "-inf", "1e39"}) {
    write_file("bad.obj", "v 0 0 0\nv 1 0 " + std::string(number) + "\nv 0 1 0\nf 1 2 3\n");
    EXPECT_NE(load_error(simple("{'mesh': 'bad', 'material': 'white'}", "", ", 'bad': {'obj': 'bad.obj'}"))
                  .find("bad.obj: line 2"),
              std::string::npos)
        << number;
  }
}

TEST(Extremes, VerticesThatAreNoNumbersInMemory) {
  // Made by a program: what has a broken corner is not there, or is refused, and the rest is.
  for (const float broken : {std::nanf(""), std::numeric_limits<float>::infinity(), 3e38f}) {
    SceneDescription description;
    description.film.width = description.film.height = 8;
    description.environment = Environment::constant(V3f(1.0f));
    description.light_groups = {"default"};
    Material white;
    white.model = DiffuseMaterial{V3f(0.5f)};
    finish_material(white);
    description.materials.push_back(std::move(white));
    Mesh mesh = make_cube();
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {V3f(0, 0, 0), V3f(broken, 0, 0), V3f(0, 9, 0)});
    mesh.uvs.resize(mesh.positions.size());
    mesh.triangles.push_back({first, first + 1, first + 2});
    description.meshes.emplace_back(std::move(mesh));
    description.objects.emplace_back();
    try {
      Scene scene(std::move(description));
      const Rendered result = render(scene, 4);
      EXPECT_EQ(result.report.non_finite_samples, 0u) << broken;
      expect_finite(result.frame, std::to_string(broken));
      EXPECT_GT(mean_radiance(result.frame).value, 0.3);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("coordinates"), std::string::npos) << error.what();
    }
  }
}

TEST(Extremes, ScalesOfAlmostNothing) {
  for (const char* zero : {"0", "1e-50"}) {
    EXPECT_EQ(
        load_error(simple("{'mesh': 'cube', 'material': 'white', 'transform': {'scale': [1," +
                          std::string(zero) + ",1]}}")),
        "scene.json: /objects/0/transform/scale: a scale must not be 0, nor less than floats hold (1.4e-45)");
  }
  const Mean plain = mean_radiance(render(simple(kCube), 16).frame);
  for (const char* mesh : {"cube", "ball"}) {
    for (const char* scale : {"1e-10", "1e-20", "1e-30", "[1,1e-12,1]", "[1,1e-30,1]", "[1e-38,1,1]"}) {
      for (const char* keys :
           {"'scale': %",
            "'keys': [{'frame': 1, 'scale': %}, {'frame': 3, 'scale': %, 'rotate_deg': [0,90,0]}]"}) {
        std::string transform = keys;
        for (std::size_t at; (at = transform.find('%')) != std::string::npos;)
          transform.replace(at, 1, scale);
        const std::string what = std::string(mesh) + " " + transform;
        const Rendered result = render(simple(kCube + ", {'mesh': '" + mesh +
                                              "', 'material': 'white', 'transform': {" + transform + "}}"),
                                       16);
        EXPECT_EQ(result.report.non_finite_samples, 0u) << what;
        expect_finite(result.frame, what);
        // Inside or behind the cube's outline, nothing of it is seen but a flat edge.
        const Mean mean = mean_radiance(result.frame);
        EXPECT_NEAR(mean.value, plain.value, 0.1) << what;
      }
    }
  }
}

TEST(Extremes, FlatAndTinyInstancesAreSeenFromTheFront) {
  const auto rendered = [](const std::string& mesh, const std::string& scale) {
    const std::string key = "'scale': [" + scale + "]";
    return render(
        simple("{'mesh': '" + mesh + "', 'material': 'white', 'transform': {'keys': [{'frame': 1, " + key +
               "}, {'frame': 3, " + key + ", 'rotate_deg': [0,40,0]}]}}"),
        16);
  };
  for (const char* mesh : {"cube", "ball"}) {
    const Mean thin = mean_radiance(rendered(mesh, "1,1,1e-4").frame);
    for (const char* thickness : {"1e-12", "1e-19", "1e-30", "1e-38"}) {
      const std::string scale = std::string("1,1,") + thickness;
      EXPECT_NEAR(mean_radiance(rendered(mesh, scale).frame).value, thin.value, 1e-3)
          << mesh << " " << thickness;
    }
  }
  for (const char* scale : {"1e-8,1e-8,1e-30", "1e-16,1e-16,1e-16", "1e-40,1e-40,1", "1e-38,1e-38,1e-38"}) {
    for (const char* mesh : {"cube", "ball"}) expect_finite(rendered(mesh, scale).frame, scale);
  }
}

TEST(Extremes, WhatIsTooLargeIsAnError) {
  for (const char* scale : {"1e18", "1e30", "3e38"}) {
    EXPECT_THROW(
        {
          Scene scene = load_text(simple(
              "{'mesh': 'cube', 'material': 'white', 'transform': {'scale': " + std::string(scale) + "}}"));
          render(scene);
        },
        Error)
        << scale;
  }
}

TEST(Extremes, OnePixelAndTenThousandSamples) {
  Scene scene =
      load_text(everything_scene({.film = "'width': 1, 'height': 1", .integrator = "'max_depth': 2"}));
  RenderReport report;
  const Frame frame =
      render_frame(scene, 2, options(10000, {Aov::variance, Aov::half_a, Aov::half_b}), &report).value();
  EXPECT_EQ(report.samples, 10000u);
  EXPECT_EQ(report.non_finite_samples, 0u);
  const float value = frame.image(Aov::beauty).at(0, 0, 1);
  const float error = std::sqrt(frame.image(Aov::variance).at(0, 0, 1));
  EXPECT_LT(error, 0.1f * value);
  const float a = frame.image(Aov::half_a).at(0, 0, 1), b = frame.image(Aov::half_b).at(0, 0, 1);
  EXPECT_NEAR(0.5f * (a + b), value, 1e-5f * value);
  EXPECT_NEAR(a, b, 8.0f * error);
}

TEST(Extremes, RadianceFromNothingToEnormous) {
  // In proportion to the light, whatever its size, by every kind of it.
  const struct {
    const char* name;
    const char* more;
    const char* object;
  } lights[] = {{"environment", "'environment': {'radiance': %}, ", ""},
                {"point", "'lights': [{'type': 'point', 'position': [1,3,2], 'intensity': %}], ", ""},
                {"spot",
                 "'lights': [{'type': 'spot', 'position': [1,3,2], 'target': [0,0,0], 'outer_deg': 40, "
                 "'intensity': %}], ",
                 ""},
                {"sun", "'lights': [{'type': 'sun', 'direction': [1,2,1], 'irradiance': %}], ", ""},
                {"area", "",
                 ", {'mesh': 'plane', 'material': 'white', 'emission': %, 'transform': {'rotate_deg': "
                 "[160,0,0], 'translate': [0,3,2]}}"},
                {"sphere", "",
                 ", {'mesh': 'ball', 'material': 'white', 'emission': %, 'transform': {'scale': 0.5, "
                 "'translate': [1,2.5,1.5]}}"}};
  for (const auto& [name, more, object] : lights) {
    for (const char* fog :
         {"", ", {'mesh': 'cube', 'material': 'air', 'interior': 'fog', 'transform': {'scale': 2}}"}) {
      const auto mean_at = [&](const std::string& radiance) {
        const auto filled = [&](std::string text) {
          const std::size_t at = text.find('%');
          return at == std::string::npos ? text : text.replace(at, 1, radiance);
        };
        const Rendered result = render(simple(kCube + filled(object) + fog, filled(more)), 16);
        EXPECT_EQ(result.report.non_finite_samples, 0u) << name << " " << radiance << fog;
        expect_finite(result.frame, name);
        return mean_radiance(result.frame).value;
      };
      const double one = mean_at("1");
      EXPECT_GT(one, 0.0) << name << fog;
      EXPECT_NEAR(mean_at("1e-30") / 1e-30, one, 0.02 * one) << name << fog;
      EXPECT_NEAR(mean_at("1e30") / 1e30, one, 0.02 * one) << name << fog;
    }
  }
}

TEST(Extremes, MediaFromNothingToOpaque) {
  const auto through = [](const std::string& extinction, const std::string& albedo) {
    std::string json =
        simple("{'mesh': 'cube', 'material': 'air', 'interior': 'fog', 'transform': {'scale': 3}}");
    const std::string fog = "'extinction': 0.5, 'albedo': 0.9";
    json.replace(json.find(fog), fog.size(), "'extinction': " + extinction + ", 'albedo': " + albedo);
    const Rendered result = render(json, 16);
    EXPECT_EQ(result.report.non_finite_samples, 0u) << extinction;
    expect_finite(result.frame, extinction);
    return mean_radiance(result.frame).value;
  };
  EXPECT_NEAR(through("1e-30", "0.9"), 1.0, 1e-5);
  EXPECT_NEAR(through("0", "1"), 1.0, 1e-5);
  EXPECT_EQ(through("1e30", "0"), 0.0);
  EXPECT_LT(through("1e30", "0.9"), 1.0);
  EXPECT_NEAR(through("[1e-30,1e30,1]", "[1,0,0.5]"), 1.0, 0.3);
}

}  // namespace
}  // namespace becalm::tracer::test
