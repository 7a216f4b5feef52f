// The table of renderers in frame/io/README.md: for each of them a file with the parts, names and attributes
// that it writes, and what is found in it.

#include <OpenEXR/ImfIntAttribute.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "frame/io/exr.h"
#include "tests/io/exr_files.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {
namespace {

const std::vector<std::string> kRgb = {"R", "G", "B"};
const std::vector<std::string> kRgba = {"R", "G", "B", "A"};
const std::vector<std::string> kXyz = {"X", "Y", "Z"};

class Renderers : public ::testing::Test {
 protected:
  void write(const std::vector<std::vector<TestChannel>>& layers) const {
    write_test_file(path_, {scanline_part(window(0, 0, 8, 6), joined(layers))});
  }

  LoadedFrame read() const { return read_exr(path_, 1, AovSet().set()); }

  /// The file's channels of every AOV that was found, and the part where there are several.
  std::map<std::string, std::string> found() const {
    std::map<std::string, std::string> found;
    const LayerMap layers = read().layers;
    for (const AovInfo& entry : kAovTable) {
      const std::optional<LayerSource>& source = layers[static_cast<std::size_t>(entry.aov)];
      if (!source) continue;
      const std::string part = source->part > 0 ? fmt::format("part {}: ", source->part) : "";
      found[entry.name.empty() ? "beauty" : std::string(entry.name)] =
          fmt::format("{}{}", part, fmt::join(source->channels, " "));
    }
    return found;
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_.path("image.exr");
};

using Found = std::map<std::string, std::string>;

TEST_F(Renderers, Blender) {
  write({blender_channels("ViewLayer"), layer_channels("ViewLayer.Position", kXyz)});
  EXPECT_EQ(found(),
            (Found{{"beauty",
                    "ViewLayer.Combined.R ViewLayer.Combined.G ViewLayer.Combined.B ViewLayer.Combined.A"},
                   {"albedo",
                    "ViewLayer.Denoising Albedo.R ViewLayer.Denoising Albedo.G ViewLayer.Denoising Albedo.B"},
                   {"normal",
                    "ViewLayer.Denoising Normal.X ViewLayer.Denoising Normal.Y ViewLayer.Denoising Normal.Z"},
                   {"depth", "ViewLayer.Depth.Z"},
                   {"motion", "ViewLayer.Vector.X ViewLayer.Vector.Y"}}));
}

TEST_F(Renderers, BlenderWithAPartForEachPass) {
  write_test_file(path_, {named_part("ViewLayer.Combined", layer_channels("", kRgba)),
                          named_part("ViewLayer.Position", layer_channels("", kXyz)),
                          named_part("ViewLayer.Depth", layer_channels("", {"V"})),
                          named_part("ViewLayer.DiffCol", layer_channels("", kRgb)),
                          named_part("ViewLayer.Denoising Normal", layer_channels("", kXyz)),
                          named_part("ViewLayer.Denoising Albedo", layer_channels("", kRgb)),
                          named_part("ViewLayer.Vector", layer_channels("", {"X", "Y", "Z", "W"}))});
  EXPECT_EQ(found(), (Found{{"beauty", "R G B A"},
                            {"depth", "part 2: V"},
                            {"normal", "part 4: X Y Z"},
                            {"albedo", "part 5: R G B"},
                            {"motion", "part 6: X Y"}}));
}

TEST_F(Renderers, Arnold) {
  write({layer_channels("", {"R", "G", "B", "A", "Z"}), layer_channels("N", kXyz), layer_channels("P", kXyz),
         layer_channels("denoise_albedo", kRgb), layer_channels("diffuse_albedo", kRgb),
         layer_channels("diffuse", kRgb), layer_channels("motionvector", kRgb),
         layer_channels("variance", kRgb)});
  EXPECT_EQ(found(), (Found{{"beauty", "R G B A"},
                            {"albedo", "denoise_albedo.R denoise_albedo.G denoise_albedo.B"},
                            {"normal", "N.X N.Y N.Z"},
                            {"depth", "Z"},
                            {"motion", "motionvector.R motionvector.G"},
                            {"variance", "variance.R variance.G variance.B"}}));
  // To the next frame, y upwards.
  EXPECT_EQ(read().frame.image(Aov::motion).at(3, 2, 0), -test_value("motionvector.R", 3, 2));
  EXPECT_EQ(read().frame.image(Aov::motion).at(3, 2, 1), test_value("motionvector.G", 3, 2));
}

TEST_F(Renderers, ArnoldThatPreservesLayerNames) {
  write({layer_channels("RGBA", kRgba), layer_channels("N", kRgb), layer_channels("diffuse_albedo", kRgb),
         layer_channels("", {"Z"})});
  EXPECT_EQ(found(), (Found{{"beauty", "RGBA.R RGBA.G RGBA.B RGBA.A"},
                            {"albedo", "diffuse_albedo.R diffuse_albedo.G diffuse_albedo.B"},
                            {"normal", "N.R N.G N.B"},
                            {"depth", "Z"}}));
}

TEST_F(Renderers, ArnoldWithItsNoisyAlbedo) {
  write({layer_channels("RGBA", kRgba), layer_channels("denoise_albedo_noisy", kRgb)});
  EXPECT_EQ(found()["albedo"], "denoise_albedo_noisy.R denoise_albedo_noisy.G denoise_albedo_noisy.B");
  write({layer_channels("RGBA", kRgba), layer_channels("denoise_albedo", kRgb),
         layer_channels("denoise_albedo_noisy", kRgb)});
  EXPECT_EQ(found()["albedo"], "denoise_albedo.R denoise_albedo.G denoise_albedo.B");
}

TEST_F(Renderers, LuxCore) {
  write({layer_channels("", kRgba), layer_channels("ALBEDO", kRgb), layer_channels("SHADING_NORMAL", kXyz),
         layer_channels("DEPTH", {"Z"})});
  EXPECT_EQ(found(), (Found{{"beauty", "R G B A"},
                            {"albedo", "ALBEDO.R ALBEDO.G ALBEDO.B"},
                            {"normal", "SHADING_NORMAL.X SHADING_NORMAL.Y SHADING_NORMAL.Z"},
                            {"depth", "DEPTH.Z"}}));
  write({layer_channels("V.Combined", kRgba), layer_channels("V.AVG_SHADING_NORMAL", kXyz),
         layer_channels("V.SHADING_NORMAL", kXyz)});
  EXPECT_EQ(found()["normal"], "V.AVG_SHADING_NORMAL.X V.AVG_SHADING_NORMAL.Y V.AVG_SHADING_NORMAL.Z");
}

TEST_F(Renderers, ArnoldsDiffuseLightIsNoAlbedo) {
  write({layer_channels("", kRgba), layer_channels("diffuse", kRgb), layer_channels("specular", kRgb)});
  EXPECT_EQ(found(), (Found{{"beauty", "R G B A"}}));
}

TEST_F(Renderers, VRay) {
  write({layer_channels("", kRgba), layer_channels("diffuse", {"red", "green", "blue"}),
         layer_channels("normals", kXyz), layer_channels("bump_normals", kXyz),
         layer_channels("velocity", kXyz), layer_channels("", {"zDepth", "noiseLevel"})});
  EXPECT_EQ(found(), (Found{{"beauty", "R G B A"},
                            {"albedo", "diffuse.red diffuse.green diffuse.blue"},
                            {"normal", "normals.X normals.Y normals.Z"},
                            {"depth", "zDepth"},
                            {"motion", "velocity.X velocity.Y"},
                            {"variance", "noiseLevel noiseLevel noiseLevel"}}));
  const float noise = test_value("noiseLevel", 3, 2);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(read().frame.image(Aov::variance).at(3, 2, c), noise * noise);
  const std::vector<std::string> lines = describe_exr(path_).lines();
  EXPECT_NE(std::ranges::find(lines,
                              "  noiseLevel      float  variance.R squared, variance.G squared, "
                              "variance.B squared"),
            lines.end());
}

TEST_F(Renderers, VRayWithAPartForEachElement) {
  write_test_file(
      path_,
      {named_part("position", layer_channels("", kXyz)), named_part("normals", layer_channels("", kXyz)),
       named_part("rgba", layer_channels("", kRgba)), named_part("diffuse", layer_channels("", kRgb)),
       named_part("zDepth", layer_channels("", {"Z"}))});
  EXPECT_EQ(found(), (Found{{"beauty", "part 2: R G B A"},
                            {"normal", "part 1: X Y Z"},
                            {"albedo", "part 3: R G B"},
                            {"depth", "part 4: Z"}}));
}

TEST_F(Renderers, VRayWithBumpNormals) {
  const auto write_with = [&](const std::string& depth) {
    write({layer_channels("", kRgb), layer_channels("diffuse", kRgb), layer_channels("bumpNormals", kRgb),
           layer_channels(depth, {"Z"})});
  };
  Found expected{{"beauty", "R G B "},
                 {"albedo", "diffuse.R diffuse.G diffuse.B"},
                 {"normal", "bumpNormals.R bumpNormals.G bumpNormals.B"},
                 {"depth", "zDepth.Z"}};
  write_with("zDepth");
  EXPECT_EQ(found(), expected);
  write_with("Depth");
  expected["depth"] = "Depth.Z";
  expected.erase("albedo");
  EXPECT_EQ(found(), expected) << "others have bumpNormals, too";
}

TEST_F(Renderers, Redshift) {
  write({layer_channels("", kRgba), layer_channels("Beauty_Noisy", kRgba),
         layer_channels("DiffuseFilter", kRgba), layer_channels("DiffuseLighting", kRgba),
         layer_channels("BumpNormals", kRgb), layer_channels("Depth", {"Z"}),
         layer_channels("MotionVectors", kRgb)});
  // The user chooses the range to which the motion vectors are scaled.
  EXPECT_EQ(found(), (Found{{"beauty", "R G B A"},
                            {"albedo", "DiffuseFilter.R DiffuseFilter.G DiffuseFilter.B"},
                            {"normal", "BumpNormals.R BumpNormals.G BumpNormals.B"},
                            {"depth", "Depth.Z"}}));
  write({layer_channels("Beauty_Noisy", kRgba)});
  EXPECT_EQ(found(), (Found{{"beauty", "Beauty_Noisy.R Beauty_Noisy.G Beauty_Noisy.B Beauty_Noisy.A"}}));
}

TEST_F(Renderers, Karma) {
  write({layer_channels("C", kRgba), layer_channels("basecolor", kRgb), layer_channels("N", kXyz)});
  EXPECT_EQ(found(), (Found{{"beauty", "C.R C.G C.B C.A"},
                            {"albedo", "basecolor.R basecolor.G basecolor.B"},
                            {"normal", "N.X N.Y N.Z"}}));
}

TEST_F(Renderers, RenderMan) {
  write({layer_channels("Ci", {"r", "g", "b"}), layer_channels("", {"a", "z", "sampleCount"}),
         layer_channels("albedo", {"r", "g", "b"}), layer_channels("normal", {"x", "y", "z"}),
         layer_channels("mse", {"r", "g", "b"}), layer_channels("forward", {"x", "y", "z"}),
         layer_channels("backward", {"x", "y", "z"}), layer_channels("diffuse", {"r", "g", "b"})});
  EXPECT_EQ(found(), (Found{{"beauty", "Ci.r Ci.g Ci.b a"},
                            {"albedo", "albedo.r albedo.g albedo.b"},
                            {"normal", "normal.x normal.y normal.z"},
                            {"depth", "z"},
                            {"motion", "backward.x backward.y"},
                            {"variance", "mse.r mse.g mse.b"}}));
}

TEST_F(Renderers, RenderManWithForwardMotionOnly) {
  write({layer_channels("", kRgba), layer_channels("forward", {"x", "y", "z"})});
  EXPECT_EQ(found(), (Found{{"beauty", "R G B A"}, {"motion", "forward.x forward.y"}}));
  EXPECT_EQ(read().frame.image(Aov::motion).at(3, 2, 1), -test_value("forward.y", 3, 2));
}

TEST_F(Renderers, Pbrt) {
  Imf::Header header = scanline_part(
      window(0, 0, 8, 6),
      joined({layer_channels("", kRgb), layer_channels("Albedo", kRgb), layer_channels("P", kXyz),
              layer_channels("N", kXyz), layer_channels("Ns", kXyz), layer_channels("Variance", kRgb),
              layer_channels("RelativeVariance", kRgb), layer_channels("", {"u", "v", "dzdx", "dzdy"})}));
  header.insert("samplesPerPixel", Imf::IntAttribute(16));
  write_test_file(path_, {header});
  EXPECT_EQ(found(), (Found{{"beauty", "R G B "},
                            {"albedo", "Albedo.R Albedo.G Albedo.B"},
                            {"normal", "Ns.X Ns.Y Ns.Z"},
                            {"variance", "Variance.R Variance.G Variance.B"}}));
  // That of one sample in the file, that of the pixel's mean in becalm.
  EXPECT_EQ(read().frame.image(Aov::variance).at(3, 2, 1), test_value("Variance.G", 3, 2) / 16.0f);
}

TEST_F(Renderers, Mitsuba) {
  write({layer_channels("<root>", kRgba), layer_channels("albedo", kRgb), layer_channels("sh_normal", kXyz),
         layer_channels("geo_normal", kXyz), layer_channels("position", kXyz),
         layer_channels("depth", {"T"})});
  EXPECT_EQ(found(), (Found{{"beauty", "<root>.R <root>.G <root>.B <root>.A"},
                            {"albedo", "albedo.R albedo.G albedo.B"},
                            {"normal", "sh_normal.X sh_normal.Y sh_normal.Z"},
                            {"depth", "depth.T"}}));
  write({layer_channels("<root>", kRgb), layer_channels("geo_normal", kXyz)});
  EXPECT_EQ(found()["normal"], "geo_normal.X geo_normal.Y geo_normal.Z");
}

TEST_F(Renderers, Altus) {
  write({layer_channels("", kRgb), layer_channels("alb", kRgb), layer_channels("nrm", kXyz),
         layer_channels("pos", kXyz)});
  EXPECT_EQ(found(),
            (Found{{"beauty", "R G B "}, {"albedo", "alb.R alb.G alb.B"}, {"normal", "nrm.X nrm.Y nrm.Z"}}));
}

TEST_F(Renderers, NukesParts) {
  write_test_file(path_, {named_part("rgba", layer_channels("", kRgba)),
                          named_part("depth", layer_channels("depth", {"Z"})),
                          named_part("forward", layer_channels("forward", {"u", "v"})),
                          named_part("other", layer_channels("", kRgb))});
  EXPECT_EQ(found(), (Found{{"beauty", "R G B A"},
                            {"depth", "part 1: depth.Z"},
                            {"motion", "part 2: forward.u forward.v"}}));
}

}  // namespace
}  // namespace becalm::io
