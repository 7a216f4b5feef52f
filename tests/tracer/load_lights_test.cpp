// The section "lights" of scene files: what is read, what is refused, and what it does to a picture.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

/// A horizontal grey plane (reflectance 0.5) seen from above, under these lights.
std::string plane_under(const std::string& lights, const std::string& direct = "mis") {
  return "{'lights': " + lights + ", 'integrator': {'max_depth': 1, 'direct': '" + direct + R"('},
    'film': {'width': 4, 'height': 4},
    'camera': {'fov_y_deg': 0.01, 'look_at': {'eye': [3,4,0], 'target': [0,0,0]}},
    'materials': {'grey': {'type': 'diffuse', 'reflectance': 0.5}},
    'meshes': {'plane': {'shape': 'rectangle'}},
    'objects': [{'mesh': 'plane', 'material': 'grey'}]})";
}

LightList list_of(const std::string& lights, const ShutterInterval& shutter) {
  LightList list;
  add_lights(load_text(plane_under(lights)).description().lights, shutter, list);
  return list;
}

TEST(LoadLights, ReadsEveryKind) {
  const std::string lights = R"([
    {'type': 'point', 'position': [1,2,3], 'intensity': [4,5,6], 'group': 'key'},
    {'type': 'spot', 'position': [0,4,0], 'target': [3,0,0], 'intensity': 7, 'inner_deg': 10, 'outer_deg': 20},
    {'type': 'spot', 'position': [0,4,0], 'direction': [0,-2,0], 'intensity': 8, 'outer_deg': 30, 'group': 'key'},
    {'type': 'sun', 'direction': [0,3,4], 'diameter_deg': 1, 'irradiance': 9, 'group': 'sky'},
    {'type': 'sun', 'azimuth_deg': 90, 'elevation_deg': 30, 'irradiance': [1,2,3]}])";
  const LightList list = list_of(lights, {1.0, 1.0, 0});
  ASSERT_EQ(list.points.size(), 1u);
  EXPECT_EQ(list.points[0].position, V3f(1, 2, 3));
  EXPECT_EQ(list.points[0].intensity, V3f(4, 5, 6));
  EXPECT_FALSE(list.points[0].motion.moving());
  ASSERT_EQ(list.spots.size(), 2u);
  EXPECT_EQ(list.spots[0].position, V3f(0, 4, 0));
  EXPECT_LT((list.spots[0].direction - V3f(0.6f, -0.8f, 0)).length(), 1e-6f);
  EXPECT_EQ(list.spots[0].inner_deg, 10.0f);
  EXPECT_EQ(list.spots[0].outer_deg, 20.0f);
  EXPECT_EQ(list.spots[0].intensity, V3f(7.0f));
  EXPECT_EQ(list.spots[1].direction, V3f(0, -1, 0));
  EXPECT_EQ(list.spots[1].inner_deg, 30.0f);
  ASSERT_EQ(list.suns.size(), 2u);
  EXPECT_LT((list.suns[0].direction - V3f(0, 0.6f, 0.8f)).length(), 1e-6f);
  EXPECT_EQ(list.suns[0].diameter_deg, 1.0f);
  EXPECT_EQ(list.suns[0].irradiance, V3f(9.0f));
  EXPECT_LT((list.suns[1].direction - V3f(std::sqrt(0.75f), 0.5f, 0)).length(), 1e-6f);
  EXPECT_EQ(list.suns[1].diameter_deg, 0.533f);
  EXPECT_EQ(list.suns[1].irradiance, V3f(1, 2, 3));
}

TEST(LoadLights, NumbersGroupsInTheirOrder) {
  const Scene scene =
      load_text("{'environment': {'radiance': 1, 'group': 'sky'}, " +
                plane_under("{'a': {'type': 'point', 'position': [0,1,0], 'intensity': 1, 'group': 'key'}, "
                            "'b': {'type': 'sun', 'direction': [0,1,0], 'irradiance': 1, 'group': 'sky'}, "
                            "'c': {'type': 'spot', 'position': [0,1,0], 'direction': [0,-1,0], 'outer_deg': "
                            "5, 'intensity': 1}}")
                    .substr(1));
  const SceneDescription& d = scene.description();
  EXPECT_EQ(d.light_groups, (std::vector<std::string>{"sky", "key", "default"}));
  EXPECT_EQ(d.environment_group, 0);
  LightList list;
  add_lights(d.lights, {1.0, 1.0, 0}, list);
  EXPECT_EQ(list.points[0].group, 1);
  EXPECT_EQ(list.suns[0].group, 0);
  EXPECT_EQ(list.spots[0].group, 2);
}

TEST(LoadLights, FollowsKeys) {
  const std::string lights = R"({
    'bulb': {'type': 'point', 'position': {'keys': [{'frame': 1, 'value': [0,1,0]}, {'frame': 5, 'value': [4,1,0]}]},
             'intensity': {'keys': [{'frame': 1, 'value': 1}, {'frame': 3, 'value': [3,5,1]}]}},
    'sun': {'type': 'sun', 'azimuth_deg': {'keys': [{'frame': 1, 'value': 0}, {'frame': 3, 'value': 180}]},
            'elevation_deg': 0, 'irradiance': 2},
    'head': {'type': 'spot', 'position': [0,2,0], 'intensity': 1,
             'target': {'keys': [{'frame': 1, 'value': [-1,1,0]}, {'frame': 3, 'value': [1,1,0]}]},
             'inner_deg': {'keys': [{'frame': 1, 'value': 5}, {'frame': 3, 'value': 15}]}, 'outer_deg': 20}})";
  const LightList list = list_of(lights, {2.0, 2.0, 0});
  EXPECT_EQ(list.points[0].position, V3f(1, 1, 0));
  EXPECT_EQ(list.points[0].intensity, V3f(2, 3, 1));
  EXPECT_LT((list.suns[0].direction - V3f(1, 0, 0)).length(), 1e-6f);
  EXPECT_EQ(list.spots[0].direction, V3f(0, -1, 0));
  EXPECT_EQ(list.spots[0].inner_deg, 10.0f);
  const Scene scene = load_text(plane_under(lights));
  for (const LightDescription& light : scene.description().lights) EXPECT_TRUE(animated(light));
  for (const char* still : {"[{'type': 'point', 'position': [0,1,0], 'intensity': 1}]",
                            "[{'type': 'sun', 'direction': [0,1,0], 'irradiance': 1}]",
                            "[{'type': 'spot', 'position': [0,1,0], 'target': [0,0,0], 'outer_deg': 9, "
                            "'intensity': {'keys': [{'frame': 3, 'value': 2}]}}]"}) {
    EXPECT_FALSE(animated(load_text(plane_under(still)).description().lights.at(0))) << still;
  }
}

TEST(LoadLights, MovesWithinTheShutterOnlyWhatMoves) {
  const std::string lights = R"([
    {'type': 'point', 'position': [0,1,0], 'intensity': 1},
    {'type': 'point', 'position': {'keys': [{'frame': 1, 'value': [0,1,0]}, {'frame': 2, 'value': [4,1,0]}]},
     'intensity': {'keys': [{'frame': 1, 'value': 0}, {'frame': 2, 'value': 1}]}},
    {'type': 'spot', 'position': [0,1,0], 'outer_deg': 20, 'intensity': 1,
     'target': {'interpolation': 'smooth', 'keys': [{'frame': 1, 'value': [0,0,0]}, {'frame': 2, 'value': [1,1,0]}]}}])";
  const LightList list = list_of(lights, {1.0, 1.5, 2});
  EXPECT_FALSE(list.points[0].motion.moving());
  ASSERT_TRUE(list.points[1].motion.moving());
  EXPECT_EQ(list.points[1].motion.first, 0u);
  EXPECT_EQ(list.points[1].motion.segments, 2u);
  EXPECT_EQ(list.points[1].intensity, V3f(0.25f));
  EXPECT_EQ(list.point_keys, (std::vector<V3f>{V3f(0, 1, 0), V3f(1, 1, 0), V3f(2, 1, 0)}));
  ASSERT_EQ(list.spots[0].motion.segments, 2u);
  ASSERT_EQ(list.spot_keys.size(), 3u);
  EXPECT_EQ(list.spot_keys[0].direction, V3f(0, -1, 0));
  // Half-way from frame 1 to 2 a smooth curve is half-way too.
  EXPECT_LT((list.spot_keys[2].direction - V3f(0.5f, -0.5f, 0).normalized()).length(), 1e-6f);
}

TEST(LoadLights, ATinyDirectionIsOneToo) {
  const LightList list =
      list_of("[{'type': 'sun', 'irradiance': 1, 'direction': [0, 1e-46, 0]}]", {1.0, 1.0, 0});
  ASSERT_EQ(list.suns.size(), 1u);
  EXPECT_EQ(list.suns[0].direction, V3f(0, 1, 0));
}

TEST(LoadLights, NamesWhatIsWrong) {
  const auto error = [](const std::string& light) { return load_error(plane_under("[" + light + "]")); };
  const std::string spot = "{'type': 'spot', 'position': [0,1,0], 'intensity': 1, 'outer_deg': 20, ";
  const std::string sun = "{'type': 'sun', 'irradiance': 1, ";
  EXPECT_EQ(error("{'type': 'lamp'}"),
            "scene.json: /lights/0/type: expected one of point, spot, sun, found \"lamp\"");
  EXPECT_EQ(error("{'position': [0,1,0]}"), "scene.json: /lights/0: 'type' is missing");
  EXPECT_EQ(error("{'type': 'point', 'position': [0,1,0]}"), "scene.json: /lights/0: 'intensity' is missing");
  EXPECT_EQ(error("{'type': 'point', 'position': [0,1], 'intensity': 1}"),
            "scene.json: /lights/0/position: expected a list of 3 numbers, found [0,1]");
  EXPECT_EQ(error("{'type': 'point', 'position': [0,1,0], 'intensity': -1}"),
            "scene.json: /lights/0/intensity: expected a number of at least 0, found -1");
  EXPECT_EQ(error("{'type': 'point', 'position': [0,1,0], 'intensity': 1, 'radius': 1}"),
            "scene.json: /lights/0/radius: unknown key; expected one of type, position, intensity, group");
  EXPECT_EQ(error("{'type': 'point', 'position': [0,1,0], 'intensity': 1, 'group': ''}"),
            "scene.json: /lights/0/group: expected a name, found \"\"");
  EXPECT_EQ(error(spot + "'target': [0,0,0], 'direction': [0,-1,0]}"),
            "scene.json: /lights/0: expected either 'target' or 'direction'");
  EXPECT_EQ(error(spot + "'inner_deg': 10}"),
            "scene.json: /lights/0: expected either 'target' or 'direction'");
  EXPECT_EQ(error(spot + "'direction': [0,-1,0], 'inner_deg': 21}"),
            "scene.json: /lights/0/inner_deg: expected at most outer_deg, 20, found 21");
  EXPECT_EQ(
      error(spot + "'target': {'keys': [{'frame': 1, 'value': [0,0,0]}, {'frame': 2, 'value': [0,1,0]}]}}"),
      "scene.json: /lights/0/target: expected another point than the position");
  EXPECT_EQ(error(spot + "'direction': [0,0,0]}"),
            "scene.json: /lights/0/direction: a direction must not be 0");
  EXPECT_EQ(
      error(sun + "'direction': {'keys': [{'frame': 1, 'value': [1,2,3]}, {'frame': 2, 'value': "
                  "[-2,-4,-6]}]}}"),
      "scene.json: /lights/0/direction: a direction must not turn to its opposite between keys: it would "
      "pass through 0");
  EXPECT_EQ(error(sun + "'azimuth_deg': 5}"), "scene.json: /lights/0: 'elevation_deg' is missing");
  EXPECT_EQ(error(sun + "'diameter_deg': 1}"),
            "scene.json: /lights/0: expected either 'direction' or 'azimuth_deg' and 'elevation_deg'");
  EXPECT_EQ(error(sun + "'azimuth_deg': 5, 'elevation_deg': 91}"),
            "scene.json: /lights/0/elevation_deg: expected a number from -90 to 90, found 91");
  EXPECT_EQ(error(sun + "'direction': [0,1,0], 'diameter_deg': 181}"),
            "scene.json: /lights/0/diameter_deg: expected a number from 0 to 180, found 181");
}

/// Radiance of the plane, reflectance / pi times the irradiance at its middle.
void expect_irradiance(const std::string& lights, double irradiance, const std::string& direct = "mis",
                       int spp = 16) {
  Scene scene = load_text(plane_under(lights, direct));
  const Frame frame = render_frame(scene, 1, options(spp, {Aov::variance})).value();
  const Mean mean = mean_radiance(frame);
  const double truth = 0.5 / std::numbers::pi * irradiance;
  EXPECT_NEAR(mean.value, truth, 4.0 * mean.error + 1e-4 * truth) << lights;
  EXPECT_LT(mean.error, 0.02 * truth) << lights;
}

TEST(LoadLights, CodesOfEnvironmentImagesAreDecoded) {
  const std::vector<float> grey(6, 128.0f / 255.0f);
  write_image("sky.png", 2, 1, 3, grey);
  write_image("sky.exr", 2, 1, 3, grey);
  const auto radiance = [](const std::string& image) {
    const Scene scene =
        load_text("{'environment': {'image': '" + image + R"('}, 'film': {'width': 4, 'height': 4},
      'camera': {'look_at': {'eye': [3,4,0], 'target': [0,0,0]}}, 'materials': {}, 'meshes': {}, 'objects': []})");
    return scene.description().environment->radiance(V3f(0.0f, 0.0f, 1.0f)).y;
  };
  EXPECT_NEAR(radiance("sky.png"), 0.21586f, 1e-4f) << "of sRGB";
  EXPECT_NEAR(radiance("sky.exr"), grey[0], 1e-4f) << "as it is";
}

TEST(LoadLights, PicturesHaveTheIrradianceOfTheirLights) {
  const std::string point = "{'type': 'point', 'position': [1,2,0], 'intensity': 10}";
  const std::string spot =
      "{'type': 'spot', 'position': [-1,2,0], 'target': [0,0,0], 'intensity': 3, "
      "'inner_deg': 5, 'outer_deg': 6}";
  const std::string sun = "{'type': 'sun', 'direction': [0,4,3], 'irradiance': 2}";
  const std::string hard_sun = "{'type': 'sun', 'direction': [0,4,3], 'irradiance': 2, 'diameter_deg': 0}";
  const std::string below = "{'type': 'point', 'position': [0,-1,0], 'intensity': 1000}";
  const double from_point = 10.0 * 2.0 / std::pow(5.0, 1.5), from_spot = 3.0 * 2.0 / std::pow(5.0, 1.5);
  expect_irradiance("[" + point + "]", from_point);
  expect_irradiance("[" + spot + "]", from_spot);
  expect_irradiance("[" + sun + "]", 2.0 * 0.8);
  expect_irradiance("[" + hard_sun + "]", 2.0 * 0.8);
  expect_irradiance("[" + below + ", " + hard_sun + "]", 2.0 * 0.8, "mis", 4096);
  expect_irradiance("[" + point + ", " + spot + ", " + sun + ", " + hard_sun + "]",
                    from_point + from_spot + 3.2, "mis", 4096);
}

/// A sun so wide that rays find it by themselves: all ways of finding it agree.
TEST(LoadLights, EscapingRaysSeeASunsDisc) {
  for (const char* direct : {"mis", "light", "material"}) {
    expect_irradiance("[{'type': 'sun', 'direction': [0,4,3], 'irradiance': 2, 'diameter_deg': 60}]", 1.6,
                      direct, 4096);
  }
}

}  // namespace
}  // namespace becalm::tracer::test
