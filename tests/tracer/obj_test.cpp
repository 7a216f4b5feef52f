#include "tracer/scene/load/obj.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/error_of.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

std::string obj_error(const std::string& text) {
  const std::string path = write_file("m.obj", text);
  const std::string message = error_of(ExitStatus::bad_input, [&] { load_obj(path); });
  return message.rfind(path, 0) == 0 ? "m.obj" + message.substr(path.size()) : message;
}

const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, SharesVerticesAndCutsPolygons) {
  const Mesh mesh = load_obj(write_file("m.obj", kCorners + "v 0 0 5\nf 1 2 3 4\nf 1 2 5\n"));
  EXPECT_EQ(mesh.positions.size(), 5u);
  EXPECT_EQ(mesh.triangles.size(), 3u);
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.uvs.empty());
}

TEST(Obj, CutsConcavePolygonsInside) {
  // An L of area 3.
  const Mesh mesh =
      load_obj(write_file("m.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n"));
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const float z =
        (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]).z;
    EXPECT_GE(z, 0.0f) << "winding kept";
    area += 0.5 * z;
  }
  EXPECT_NEAR(area, 3.0, 1e-6);
}

TEST(Obj, CutsConcaveQuadrilateralsInside) {
  // A dart of area 9 whose shorter diagonal lies outside, from each of its corners.
  for (const char* face : {"f 1 2 3 4\n", "f 2 3 4 1\n", "f 3 4 1 2\n", "f 4 1 2 3\n"}) {
    const Mesh mesh =
        load_obj(write_file("m.obj", std::string("v 1 0 0\nv 0 10 0\nv -1 0 0\nv 0 1 0\n") + face));
    ASSERT_EQ(mesh.triangles.size(), 2u);
    double area = 0.0;
    for (const auto& t : mesh.triangles) {
      const float z =
          (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]).z;
      EXPECT_GT(z, 0.0f) << face;
      area += 0.5 * z;
    }
    EXPECT_NEAR(area, 9.0, 1e-5) << face;
  }
}

TEST(Obj, CutsPolygonsIntoTwoTrianglesFewerThanTheyHaveCorners) {
  // A comb whose tines are corners on one line, then a polygon of no area.
  const Mesh comb = load_obj(write_file("m.obj",
                                        "v 0 0 0\nv 5 0 0\nv 5 2 0\nv 4 2 0\nv 4 1 0\nv 3 1 0\nv 3 2 0\n"
                                        "v 2 2 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
                                        "f 1 2 3 4 5 6 7 8 9 10 11 12\n"));
  ASSERT_EQ(comb.triangles.size(), 10u);
  double area = 0.0;
  for (const auto& t : comb.triangles) {
    const V3f& a = comb.positions[t[0]];
    const float z = (comb.positions[t[1]] - a).cross(comb.positions[t[2]] - a).z;
    EXPECT_GE(z, 0.0f);
    area += 0.5 * z;
  }
  EXPECT_NEAR(area, 8.0, 1e-6);
  EXPECT_EQ(load_obj(write_file("m.obj", kCorners + "f 1 2 1 2 1\n")).triangles.size(), 3u);
}

TEST(Obj, SplitsVerticesWhereNormalsOrUvsDiffer) {
  const Mesh mesh = load_obj(write_file(
      "m.obj",
      kCorners + "vn 0 0 1\nvn 0 1 0\nvt 0 0\nvt 1 0.5\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/2/1 4/1/2\n"));
  EXPECT_EQ(mesh.positions.size(), 5u);
  ASSERT_EQ(mesh.normals.size(), 5u);
  ASSERT_EQ(mesh.uvs.size(), 5u);
  EXPECT_EQ(mesh.positions[mesh.triangles[1][1]], V3f(1, 1, 0));
  EXPECT_EQ(mesh.uvs[mesh.triangles[1][1]], V2f(1, 0.5f));
}

TEST(Obj, CountsBackwardFromNegativeIndicesAndAcceptsWindowsLines) {
  const Mesh mesh =
      load_obj(write_file("m.obj", "v 0 0 0\r\nv 1e-40 +1 0 1 1 1\r\nv 1 1 1\r\nf -3 -2 -1\r\n"));
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.positions[mesh.triangles[0][2]], V3f(1, 1, 1));
}

TEST(Obj, VIs0IfLeftOut) {
  const Mesh mesh = load_obj(write_file("m.obj", kCorners + "vt 0.5 # u\nvt 0.25 1 0\nf 1/1 2/2 3/1\n"));
  ASSERT_EQ(mesh.uvs.size(), 3u);
  EXPECT_EQ(mesh.uvs[mesh.triangles[0][0]], V2f(0.5f, 0.0f));
  EXPECT_EQ(mesh.uvs[mesh.triangles[0][1]], V2f(0.25f, 1.0f));
  EXPECT_EQ(obj_error("vt\n"), "m.obj: line 1: 'vt' needs 1 to 2 finite numbers, found ''");
}

TEST(Obj, AcceptsLinesThatEndInACarriageReturn) {
  const Mesh mesh = load_obj(write_file("m.obj", "v 0 0 0\rv 1 0 0\rv 1 1 0\r\rf 1 2 3\r"));
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(obj_error("v 0 0 0\rv 1 0\r"), "m.obj: line 2: 'v' needs 3 finite numbers, found ''");
}

TEST(Obj, AByteOrderMarkIsSkipped) {
  const Mesh mesh = load_obj(write_file("m.obj", "\xef\xbb\xbf" + kCorners + "f 2 3 1\n"));
  EXPECT_EQ(mesh.positions, (std::vector{V3f(1, 0, 0), V3f(1, 1, 0), V3f(0, 0, 0)}));
}

TEST(Obj, LinesThatEndInABackslashContinue) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const Mesh mesh =
        load_obj(write_file("m.obj", "v 0 0 0" + end + "v 1 \\" + end + "0 0" + end + "v 1 1 0" + end +
                                         "f 1 \\" + end + "2\\" + end + " 3 \\" + end));
    ASSERT_EQ(mesh.positions.size(), 3u) << end;
    EXPECT_EQ(mesh.positions[1], V3f(1, 0, 0));
  }
  EXPECT_EQ(obj_error("v 0 \\\n0 \\\n0\nv 1 0 x\n"), "m.obj: line 4: 'v' needs 3 finite numbers, found 'x'");
  EXPECT_EQ(obj_error("v 0 \\\n0 x\nv 1 0 0\n"), "m.obj: line 1: 'v' needs 3 finite numbers, found 'x'");
  EXPECT_EQ(obj_error("v 0 \\\n0"), "m.obj: line 1: 'v' needs 3 finite numbers, found ''");
}

TEST(Obj, CommentsEndStatements) {
  const Mesh mesh = load_obj(write_file(
      "m.obj", "# C:\\models\\\nv 0 0 0 # a\nv 1 0 0# b\nv 1 1 0\nf 1 2 3 # C:\\\nv 0 1 0\nf 2 3 4#c\n"));
  EXPECT_EQ(mesh.triangles.size(), 2u) << "comments do not continue";
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(obj_error("v 0 0 # 0\n"), "m.obj: line 1: 'v' needs 3 finite numbers, found ''");
  const ObjParts parts = load_obj_parts(write_file("m.obj", kCorners + "usemtl red #2\nf 1 2 3\n"));
  EXPECT_EQ(parts.parts.at(0).material, "red #2") << "a name may hold any character";
}

/// Separate triangles, more than a megabyte of them: the file is read in several blocks.
std::string long_obj(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text += fmt::format("v {0} 0 0\nv {0} 1 0\nv {0} 0 1\n", i);
    text += i % 2 == 0 ? "f -3 -2 -1\n" : fmt::format("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
  }
  return text;
}

TEST(Obj, CountsLinesFacesAndElementsThroughAllBlocks) {
  constexpr int count = 40000;
  const std::string text = long_obj(count);
  ASSERT_GT(text.size(), 1u << 20);
  const Mesh mesh = load_obj(write_file("m.obj", text));
  ASSERT_EQ(mesh.triangles.size(), static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto corner = static_cast<std::uint32_t>(3 * i);
    ASSERT_EQ(mesh.triangles[i], (std::array{corner, corner + 1, corner + 2}));
    ASSERT_EQ(mesh.positions[corner + 1], V3f(static_cast<float>(i), 1, 0));
  }
  EXPECT_EQ(obj_error(text + "v 0 x 0\nv y 0 0\n"),
            "m.obj: line 160001: 'v' needs 3 finite numbers, found 'x'");
  EXPECT_EQ(obj_error(text + "f 1 2 0\n"), "m.obj: line 160001: 'f' needs indices other than 0, found '0'");
  EXPECT_EQ(obj_error(text + "f 1 2\nf 1 2 120001\n"),
            "m.obj: face 40001: vertex index 120001 is outside the file's 120000");
}

TEST(Obj, NamesTheFaceOfABadIndex) {
  EXPECT_EQ(obj_error(kCorners + "f 1 2 3\nf 1 2 9\n"),
            "m.obj: face 2: vertex index 9 is outside the file's 4");
  EXPECT_EQ(obj_error(kCorners + "f 1 2 3 4 5\n"), "m.obj: face 1: vertex index 5 is outside the file's 4");
  EXPECT_EQ(obj_error(kCorners + "f 1//3 2//3 3//3\n"),
            "m.obj: face 1: normal index 3 is outside the file's 0");
  EXPECT_EQ(obj_error(kCorners + "f 1/7 2/7 3/7\n"), "m.obj: face 1: uv index 7 is outside the file's 0");
  EXPECT_EQ(obj_error(kCorners + "f 1 2 -9\n"), "m.obj: face 1: vertex index -4 is outside the file's 4");
  EXPECT_EQ(obj_error(kCorners + "f 0 1 2\n"), "m.obj: line 5: 'f' needs indices other than 0, found '0'");
  EXPECT_EQ(obj_error(kCorners + "f 1 2x 3\n"), "m.obj: line 5: 'f' needs indices other than 0, found '2x'");
  EXPECT_EQ(obj_error(kCorners + "f 1.5 2 3\n"),
            "m.obj: line 5: 'f' needs indices other than 0, found '1.5'");
  EXPECT_EQ(obj_error(kCorners + "f 1/1/1/1 2 3\n"),
            "m.obj: line 5: 'f' needs indices other than 0, found '1/1/1/1'");
}

TEST(Obj, NamesTheLineOfABadCoordinate) {
  EXPECT_EQ(obj_error("v 0 0 0\nv 1 nan 0\nv 1 1 0\nf 1 2 3\n"),
            "m.obj: line 2: 'v' needs 3 finite numbers, found 'nan'");
  EXPECT_EQ(obj_error("v 0 0 0\nv 1 inf 0\n"), "m.obj: line 2: 'v' needs 3 finite numbers, found 'inf'");
  EXPECT_EQ(obj_error("v 0 1e99 0\n"), "m.obj: line 1: 'v' needs 3 finite numbers, found '1e99'");
  EXPECT_EQ(obj_error("v 0 0\n"), "m.obj: line 1: 'v' needs 3 finite numbers, found ''");
  EXPECT_EQ(obj_error("vt 0 x\n"), "m.obj: line 1: 'vt' needs 2 finite numbers, found 'x'");
}

TEST(Obj, NeedsAFileWithFaces) {
  EXPECT_EQ(obj_error(kCorners), "m.obj: has no faces");
  EXPECT_EQ(obj_error(""), "m.obj: has no faces");
  EXPECT_THROW(load_obj("nowhere.obj"), Error);
}

}  // namespace
}  // namespace becalm::tracer::test
