// Many static copies of a mesh, and the scatterer that makes them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tracer/test_scenes.h"
#include "tracer/scene/load/scatter.h"
#include "tracer/snapshot/snapshot.h"

namespace becalm::tracer::test {
namespace {

/// Twelve balls of 16,384 triangles. With materials of their own they have no geometry in common.
std::string balls(bool shared) {
  std::string materials, objects;
  for (int i = 0; i < 12; ++i) {
    const std::string name = "m" + std::to_string(shared ? 0 : i);
    if (i == 0 || !shared)
      materials += ", '" + name + "': {'type': 'conductor', 'reflectance': [0.9,0.7,0.5], 'roughness': 0.3}";
    objects += ", {'mesh': 'ball', 'material': '" + name + "', 'transform': {'scale': [" +
               (i % 3 == 0 ? "-0.5" : "0.5") + ",0.3,0.4], 'rotate_deg': [" + std::to_string(20 * i) + "," +
               std::to_string(35 * i) + ",0], 'translate': [" + std::to_string(i % 4 - 1.5) + "," +
               std::to_string(0.4 + i / 4 * 0.8) + "," + std::to_string(-0.3 * i) + "]}}";
  }
  return R"({'film': {'width': 40, 'height': 30}, 'integrator': {'max_depth': 3}, 'environment': {'radiance': [0.4,0.5,0.7]},
    'camera': {'fov_y_deg': 40, 'look_at': {'eye': [0,1.5,6], 'target': [0,1,0]}},
    'lights': {'lamp': {'type': 'point', 'position': [3,5,4], 'intensity': 40}},
    'materials': {'floor': {'type': 'diffuse', 'reflectance': 0.6})" +
         materials +
         R"(}, 'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'sphere', 'segments': 128}},
    'objects': [{'mesh': 'plane', 'material': 'floor', 'transform': {'scale': 5}})" +
         objects + "]}";
}

TEST(Instances, ShowTheSamePictureAsBakedCopies) {
  Scene instanced = load_text(balls(true)), baked = load_text(balls(false));
  const GeometrySize of_instanced = instanced.at_frame(1).intersector().size();
  const GeometrySize of_baked = baked.at_frame(1).intersector().size();
  const std::size_t ball =
      instanced.description().meshes.size() == 2 ? (instanced.needs().triangles - 2) / 12 : 0;
  ASSERT_GT(11 * ball, 100'000u) << "too few triangles to be worth instances";
  EXPECT_EQ(of_instanced.baked_objects, 1u);
  EXPECT_EQ(of_instanced.instances, 12u);
  EXPECT_EQ(of_instanced.motion_instances, 0u);
  EXPECT_EQ(of_instanced.stored_triangles, ball + 2);
  EXPECT_EQ(of_instanced.visible_triangles, 12 * ball + 2);
  EXPECT_EQ(of_baked.baked_objects, 13u);
  EXPECT_EQ(of_baked.instances, 0u);
  EXPECT_EQ(of_baked.stored_triangles, 12 * ball + 2);
  EXPECT_EQ(of_baked.visible_triangles, 12 * ball + 2);
  EXPECT_LT(3 * of_instanced.embree_bytes, of_baked.embree_bytes);

  const auto o = options(4, {Aov::normal, Aov::depth, Aov::object_id});
  const Frame a = render_frame(instanced, 1, o).value(), b = render_frame(baked, 1, o).value();
  int different = 0;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const float va = a.image(Aov::beauty).at(x, y, 1), vb = b.image(Aov::beauty).at(x, y, 1);
      different += std::abs(va - vb) > 2e-3f * std::max(va, vb);
      EXPECT_EQ(a.image(Aov::object_id).at(x, y, 0), b.image(Aov::object_id).at(x, y, 0)) << x << "," << y;
    }
  }
  // The same paths, but for those within rounding errors of an edge.
  EXPECT_LT(different, 24) << "of 1200 pixels";
}

std::string scattered(const std::string& object, const std::string& scatter,
                      const std::string& ground_transform = "{'rotate_deg': [0,0,20], 'scale': [4,1,4]}") {
  return R"({'film': {'width': 4, 'height': 4}, 'camera': {'look_at': {'eye': [0,2,9], 'target': [0,0,0]}},
    'materials': {'m': {'type': 'diffuse', 'reflectance': 0.5}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'cube': {'shape': 'cube'}},
    'objects': [{'name': 'ground', 'mesh': 'plane', 'material': 'm', 'transform': )" +
         ground_transform + "}, {'name': 'stick', 'mesh': 'cube', 'material': 'm', " + object +
         "'scatter': {" + scatter + "}}]}";
}

std::vector<Object> copies(
    const std::string& object, const std::string& scatter,
    const std::string& ground_transform = "{'rotate_deg': [0,0,20], 'scale': [4,1,4]}") {
  const Scene scene = load_text(scattered(object, scatter, ground_transform));
  const std::vector<Object>& all = scene.description().objects;
  return {all.begin() + 1, all.end()};
}

M44d place(const Object& object) {
  EXPECT_FALSE(object.transform.animated());
  return transform_at(object.transform, 0.0);
}

TEST(Scatter, IsTheSameForTheSameSettingsAndAPrefixOfMore) {
  const std::string area = "'area': [-2,-3,4,1], 'scale': [0.5,2], 'tilt_deg': 20, ";
  const std::vector<Object> ten = copies("", area + "'count': 10, 'seed': 5");
  const std::vector<Object> again = copies("", area + "'count': 10, 'seed': 5");
  const std::vector<Object> more = copies("", area + "'count': 30, 'seed': 5");
  const std::vector<Object> other = copies("", area + "'count': 10, 'seed': 6");
  ASSERT_EQ(ten.size(), 10u);
  ASSERT_EQ(more.size(), 30u);
  int equal = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(place(ten[i]), place(again[i]));
    EXPECT_EQ(place(ten[i]), place(more[i]));
    EXPECT_EQ(ten[i].name, "stick " + std::to_string(i + 1));
    equal += place(ten[i]) == place(other[i]);
  }
  EXPECT_EQ(equal, 0);
}

TEST(Scatter, RefusesGroundsThatRaysCannotReach) {
  for (const char* transform : {"{'scale': [4,1e30,4]}", "{'translate': [0,-1e19,0]}"}) {
    const std::string error =
        load_error(scattered("", "'area': [-3,-3,3,3], 'count': 5, 'on': 'ground'", transform));
    EXPECT_EQ(error.find("scene.json: /objects: the ground 'ground' may reach to a height of "), 0u) << error;
  }
}

TEST(Scatter, RefusesGroundsWhoseShapeMoves) {
  const auto on_sea = [](const std::string& time) {
    return R"({'film': {'width': 4, 'height': 4}, 'camera': {'look_at': {'eye': [0,2,9], 'target': [0,0,0]}},
      'materials': {'m': {'type': 'diffuse', 'reflectance': 0.5}},
      'meshes': {'sea': {'procedural': 'ocean', 'size': 100, 'wavelength': 10, 'time_s': )" +
           time + R"(}, 'cube': {'shape': 'cube'}},
      'objects': [{'name': 'sea', 'mesh': 'sea', 'material': 'm'}, {'mesh': 'cube', 'material': 'm',
        'scatter': {'area': [-3,-3,3,3], 'count': 5, 'on': 'sea'}}]})";
  };
  EXPECT_EQ(load_text(on_sea("2")).description().objects.size(), 6u);
  EXPECT_EQ(load_error(on_sea("{'keys': [{'frame': 1, 'value': 0}, {'frame': 24, 'value': 1}]}")),
            "scene.json: /objects/1/scatter/on: the object 'sea' moves");
}

TEST(Scatter, StandsOnAllPartsOfAGround) {
  // The left half is 1 high, the right half 2.
  write_file(
      "ground.obj",
      "mtllib ground.mtl\nv -4 1 -4\nv -4 1 4\nv 0 1 4\nv 0 1 -4\nv 0 2 -4\nv 0 2 4\nv 4 2 4\nv 4 2 -4\n"
      "usemtl left\nf 1 2 3 4\nusemtl right\nf 5 6 7 8\n");
  write_file("ground.mtl", "newmtl left\nKd 1 0 0\nnewmtl right\nKd 0 1 0\n");
  const Scene scene = load_text(R"({'film': {'width': 4, 'height': 4},
    'camera': {'look_at': {'eye': [0,2,9], 'target': [0,0,0]}}, 'materials': {'m': {'type': 'diffuse', 'reflectance': 1}},
    'meshes': {'land': {'obj': 'ground.obj', 'materials': 'mtl'}, 'cube': {'shape': 'cube'}},
    'objects': [{'name': 'ground', 'mesh': 'land'}, {'name': 'stick', 'mesh': 'cube', 'material': 'm',
      'scatter': {'area': [-3,-3,3,3], 'count': 40, 'on': 'ground'}}]})");
  const std::vector<Object>& all = scene.description().objects;
  ASSERT_EQ(all.size(), 2u + 40u);
  for (std::size_t i = 2; i < all.size(); ++i) {
    const M44d m = place(all[i]);
    EXPECT_NEAR(m[3][1], m[3][0] < 0.0 ? 1.0 : 2.0, 1e-4) << m[3][0];
  }
}

TEST(Scatter, SpreadsOverItsAreaWithinItsLimits) {
  const std::vector<Object> all =
      copies("", "'area': [-2,-3,4,1], 'scale': [0.5,2], 'tilt_deg': 20, 'count': 800");
  ASSERT_EQ(all.size(), 800u);
  int quarters[4] = {0, 0, 0, 0};
  double least_scale = 9.0, most_scale = 0.0, most_tilt = 0.0;
  for (const Object& copy : all) {
    const M44d m = place(copy);
    ASSERT_TRUE(m[3][0] >= -2.0 && m[3][0] < 4.0 && m[3][2] >= -3.0 && m[3][2] < 1.0);
    EXPECT_EQ(m[3][1], 0.0);
    ++quarters[(m[3][0] > 1.0 ? 1 : 0) + (m[3][2] > -1.0 ? 2 : 0)];
    const V3d up(m[1][0], m[1][1], m[1][2]);
    least_scale = std::min(least_scale, up.length());
    most_scale = std::max(most_scale, up.length());
    most_tilt = std::max(most_tilt, std::acos(std::min(1.0, up.y / up.length())) * 180.0 / std::numbers::pi);
  }
  for (const int quarter : quarters) EXPECT_NEAR(quarter, 200, 6) << "a low-discrepancy sequence";
  EXPECT_GE(least_scale, 0.5 - 1e-9);
  EXPECT_LE(most_scale, 2.0 + 1e-9);
  EXPECT_LT(least_scale, 0.55);
  EXPECT_GT(most_scale, 1.95);
  EXPECT_LE(most_tilt, 20.0 + 1e-6);
  EXPECT_GT(most_tilt, 15.0);
}

TEST(Scatter, StandsOnItsGroundAndLeavesMissesOut) {
  // The plane y = x tan 20 over |x| < 4 cos 20, |z| < 4.
  const std::vector<Object> all = copies("", "'area': [-8,-8,8,8], 'count': 500, 'on': 'ground'");
  const double edge = 4.0 * std::cos(20.0 * std::numbers::pi / 180.0);
  const double share = 2.0 * edge * 8.0 / 256.0;
  EXPECT_NEAR(static_cast<double>(all.size()), 500.0 * share, 8.0);
  for (const Object& copy : all) {
    const M44d m = place(copy);
    EXPECT_LE(std::abs(m[3][0]), edge + 1e-5);
    EXPECT_LE(std::abs(m[3][2]), 4.0 + 1e-5);
    EXPECT_NEAR(m[3][1], m[3][0] * std::tan(20.0 * std::numbers::pi / 180.0), 1e-5);
  }
}

TEST(Scatter, OwnTransformsActBeforeTheScatters) {
  // A cube stretched to a stick along y, tipped over onto the x axis and moved along it: turned about y, it
  // lies in the xz plane in whatever direction, and its middle stands off the scatter's point that way.
  const std::string own =
      "'transform': {'scale': [0.1,3,0.1], 'rotate_deg': [0,0,-90], 'translate': [2,0.5,0]}, ";
  const std::string area = "'area': [0,0,1e-6,1e-6], 'scale': [2,2], 'count': 64";
  std::vector<int> octants(8, 0);
  for (const Object& copy : copies(own, area)) {
    const M44d m = place(copy);
    const V3d along(m[1][0], m[1][1], m[1][2]);
    EXPECT_NEAR(along.length(), 6.0, 1e-6);
    EXPECT_NEAR(along.y, 0.0, 1e-6);
    EXPECT_NEAR(m[3][1], 1.0, 1e-5);
    EXPECT_NEAR(std::hypot(m[3][0], m[3][2]), 4.0, 1e-5);
    EXPECT_NEAR(V3d(m[3][0], 0, m[3][2]).dot(along), 24.0, 1e-4) << "it was moved the way it points";
    ++octants[static_cast<std::size_t>((std::atan2(along.z, along.x) / std::numbers::pi + 1.0) * 3.999)];
  }
  for (const int octant : octants) EXPECT_GT(octant, 0) << "all directions occur";
}

}  // namespace
}  // namespace becalm::tracer::test
