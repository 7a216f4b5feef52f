#include "frame/io/additive_layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "frame/error.h"
#include "frame/io/coloured_light.h"
#include "tests/io/additive_fixture.h"

namespace becalm::io {
namespace {

TEST_F(AdditiveLayers, ThoseThatAddUpAreChosen) {
  write({{"", [](int i) { return first(i) + second(i); }}, {"diffuse", first}, {"specular", second}});
  ASSERT_EQ(sets().size(), 1u);
  EXPECT_EQ(sets()[0].layers, (Names{"diffuse", "specular"}));
  EXPECT_TRUE(sets()[0].adds_up());
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"diffuse", "specular"}));
  EXPECT_EQ(describe(sets()[0]), "diffuse, specular add up to the beauty and are denoised with it");
  denoise();
  EXPECT_EQ(result("diffuse.G", 9), 2.0f * Imath::half(first(9)));
  EXPECT_EQ(result("specular.B", 9), 2.0f * Imath::half(second(9)));
}

TEST_F(AdditiveLayers, ArnoldsDenoisedBeautyIsNoLightGroup) {
  write({{"", both}, {"RGBA_denoise", both}, {"RGBA_fill", first}, {"RGBA_key", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"RGBA_fill", "RGBA_key"}));
}

TEST_F(AdditiveLayers, VraysSecondSubsurfaceLightIsASummand) {
  write({{"", [](int i) { return first(i) + second(i); }}, {"VRayLighting", first}, {"VRaySSS2", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"VRayLighting", "VRaySSS2"}));
}

TEST_F(AdditiveLayers, LightWhoseColoursNukeSpellsOutIsNoAlbedo) {
  const auto spelled = [](const std::string& layer) {
    return Names{layer + ".red", layer + ".green", layer + ".blue"};
  };
  std::vector<PartChannels> parts(1);
  for (const Names& layer : {Names{"R", "G", "B", "N.red", "N.green", "N.blue"}, spelled("diffuse")}) {
    parts[0].channels.insert(parts[0].channels.end(), layer.begin(), layer.end());
  }
  const auto albedo = [&] { return find_layers("f", parts, {})[static_cast<std::size_t>(Aov::albedo)]; };
  EXPECT_FALSE(albedo());
  parts[0].channels.push_back("zDepth");
  EXPECT_TRUE(albedo()) << "V-Ray";
}

TEST_F(AdditiveLayers, AreToldAsLight) {
  write({{"", first}, {"diffuse", first}, {"light.key", first}, {"specular", second}});
  const std::vector<std::string> lines = describe_exr(path_, {.additive = {"diffuse"}}).lines();
  const auto has = [&](const char* line) { return std::ranges::find(lines, line) != lines.end(); };
  EXPECT_TRUE(has("  diffuse.R    half   light diffuse.R")) << lines[1];
  EXPECT_TRUE(has("  light.key.B  half   light key.B"));
  EXPECT_TRUE(has("  specular.G   half   passed on"));
}

TEST_F(AdditiveLayers, ThoseThatDoNotAreLeft) {
  write(
      {{"", [](int i) { return 1.01f * (first(i) + second(i)); }}, {"diffuse", first}, {"specular", second}});
  ASSERT_EQ(sets().size(), 1u);
  EXPECT_FALSE(sets()[0].adds_up());
  EXPECT_TRUE(choose_additive("auto", sets()).empty());
  EXPECT_EQ(choose_additive("specular,diffuse", sets()), (Names{"specular", "diffuse"}));
  EXPECT_TRUE(choose_additive("none", sets()).empty());
  const std::vector<AdditiveSet> found{{.layers = {"a", "b"}}, {.layers = {"c", "d"}, .share_off = 0.5}};
  EXPECT_EQ(choose_additive("auto,c,a", found), (Names{"a", "b", "c"}));
  EXPECT_NE(describe(sets()[0]).find("do not add up to the beauty in 100.0% of the values"),
            std::string::npos)
      << describe(sets()[0]);
}

TEST_F(AdditiveLayers, ABlackFrameSaysNothingAndTheNextOneDecides) {
  const auto black = [](int) { return 0.0f; };
  write({{"", black}, {"diffuse", black}, {"specular", black}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"diffuse", "specular"}))
      << "where nothing is known better";
  const std::string of_black = folder_.path("black.exr");
  std::filesystem::rename(path_, of_black);
  const std::string slate = folder_.path("slate.exr");
  write({{"", first}});
  std::filesystem::rename(path_, slate);
  const std::string damaged = folder_.path("damaged.exr");
  write_bytes(damaged, "no EXR");
  const Names sequence{slate, of_black, damaged, path_};
  write({{"", first}, {"diffuse", first}, {"specular", second}});
  EXPECT_TRUE(choose_additive("auto", find_additive_sets(sequence, {})).empty());
  EXPECT_EQ(find_additive_sets(sequence, {}).size(), 1u);
  write({{"", [](int i) { return first(i) + second(i); }}, {"diffuse", first}, {"specular", second}});
  EXPECT_EQ(choose_additive("auto", find_additive_sets(sequence, {})), (Names{"diffuse", "specular"}));
  EXPECT_TRUE(find_additive_sets(Names(8, slate), {}).empty());
  EXPECT_EQ(choose_additive("auto", find_additive_sets(Names{of_black, slate}, {})),
            (Names{"diffuse", "specular"}));
}

TEST_F(AdditiveLayers, AFrameWhoseLayersAreAovsDecides) {
  write({{"", [](int i) { return first(i) + second(i); }}, {"diffuse", first}, {"specular", second}});
  const std::string later = folder_.path("later.exr");
  std::filesystem::rename(path_, later);
  write({{"", [](int i) { return first(i) + second(i); }}, {"direct", first}, {"indirect", second}});
  EXPECT_TRUE(find_additive_sets(Names{path_, later}, {}).empty());
}

TEST_F(AdditiveLayers, DimAndSparseLightCounts) {
  const auto spark = [](int i) { return i == 5 ? 1.0f : 0.0f; };
  write({{"", spark}, {"diffuse", spark}, {"specular", [](int) { return 0.0f; }}});
  EXPECT_EQ(choose_additive("auto", find_additive_sets(Names{path_}, {})), (Names{"diffuse", "specular"}));
}

TEST_F(AdditiveLayers, LightGroupsOfCycles) {
  write({{"View Layer.Combined", [](int i) { return first(i) + second(i); }},
         {"View Layer.Combined_key", first},
         {"View Layer.Combined_fill", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"View Layer.Combined_fill", "View Layer.Combined_key"}));
}

TEST_F(AdditiveLayers, NamesOfVrayFor3dsMax) {
  write({{"", [](int i) { return first(i) + second(i); }},
         {"VRayGlobalIllumination", first},
         {"VRayLighting", second},
         {"VRayDiffuseFilter", first},
         {"VRayNormals", first}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"VRayGlobalIllumination", "VRayLighting"}));
  const AovSet found = read_exr(path_, 1, AovSet().set(), {}).frame.aovs();
  EXPECT_TRUE(contains(found, Aov::albedo));
  EXPECT_TRUE(contains(found, Aov::normal));
}

TEST_F(AdditiveLayers, ArnoldsLightGroups) {
  write({{"", [](int i) { return first(i) + second(i); }},
         {"RGBA_key", first},
         {"RGBA_default", second},
         {"RGBA_denoise_albedo", first}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"RGBA_default", "RGBA_key"}));
}

TEST_F(AdditiveLayers, VRaysElements) {
  const auto third = [](int i) { return static_cast<float>(i % 3); };
  write({{"", [&](int i) { return first(i) + second(i) + third(i); }},
         {"lighting", first},
         {"GI", second},
         {"reflection", third},
         {"diffuseFilter", first}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"GI", "lighting", "reflection"}));
}

TEST_F(AdditiveLayers, Redshifts) {
  write({{"", both}, {"DiffuseLighting", first}, {"GI", second}, {"DiffuseLightingRaw", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"DiffuseLighting", "GI"}));
}

TEST_F(AdditiveLayers, BlendersWithTheirColours) {
  const auto colour = [](int i) { return i % 5 == 0 ? 0.0f : 0.2f * static_cast<float>(i % 5); };
  const auto direct = [&](int i) { return colour(i) == 0.0f ? 0.0f : first(i); };
  write({{"V.Combined", [&](int i) { return (direct(i) + second(i)) * colour(i) + first(i); }},
         {"V.DiffDir", direct},
         {"V.DiffInd", second},
         {"V.DiffCol", colour},
         {"V.Emit", first}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"V.DiffDir", "V.DiffInd", "V.Emit"}));
  const Planes before = read_planes(path_);
  denoise();
  EXPECT_EQ(read_planes(result_).at("V.DiffCol.R"), before.at("V.DiffCol.R"));
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const float sum = (result("V.DiffDir.R", i) + result("V.DiffInd.R", i)) * result("V.DiffCol.R", i) +
                      result("V.Emit.R", i);
    EXPECT_NEAR(sum, result("V.Combined.R", i), 2e-3f * sum + 1e-6f) << i;
  }
}

TEST_F(AdditiveLayers, BlendersEnvironmentBehindATransparentFilmIsNoSummand) {
  write({{"V.Combined", [](int i) { return first(i) + second(i); }},
         {"V.DiffDir", first},
         {"V.Emit", second},
         {"V.Env", first}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"V.DiffDir", "V.Emit"}));
  EXPECT_EQ(sets().size(), 1u) << "nothing is told of the set with the environment";
  write({{"V.Combined", [](int i) { return 3.0f * first(i); }},
         {"V.DiffDir", first},
         {"V.Emit", first},
         {"V.Env", first}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"V.DiffDir", "V.Emit", "V.Env"}));
}

TEST_F(AdditiveLayers, LossyCompressionMayLeaveASumApart) {
  const auto apart = [](int i) { return 1.08f * (first(i) + second(i)); };
  write({{"", apart}, {"diffuse", first}, {"specular", second}});
  EXPECT_TRUE(choose_additive("auto", sets()).empty());
  for (const Imf::Compression lossy : {Imf::B44_COMPRESSION, Imf::DWAB_COMPRESSION}) {
    write({{"", apart}, {"diffuse", first}, {"specular", second}}, lossy);
    EXPECT_EQ(choose_additive("auto", sets()), (Names{"diffuse", "specular"})) << lossy;
    write({{"", first}, {"diffuse", first}, {"specular", second}}, lossy);
    EXPECT_TRUE(choose_additive("auto", sets()).empty()) << lossy;
  }
}

TEST(ColouredLight, LeaksOntoDarkSurfacesAreNotDividedByNextToNothing) {
  Image colour(40, 40, 3, 0.5f);
  Image came(40, 40, 3, 1.0f);  // light of 2
  for (int c = 0; c < 3; ++c) {
    colour.at(3, 3, c) = 1e-4f;
    came.at(3, 3, c) = 1e-4f;
    colour.at(38, 38, c) = 0.0f;
    came.at(20, 3, c) = -2.5f;  // in the next block
  }
  Image product = came;
  for (int c = 0; c < 3; ++c) product.at(3, 3, c) = 0.02f;
  const Image light = light_without_colour(product, colour, came);
  EXPECT_EQ(light.at(0, 0, 0), 2.0f);
  EXPECT_EQ(light.at(20, 3, 1), -5.0f);
  EXPECT_EQ(light.at(3, 3, 2), 5.0f) << "not 200";
  EXPECT_EQ(light.at(38, 38, 0), 0.0f);
}

TEST(ColouredLight, QuotientsThatOverflowAreLimitedAndOnlyInfinityThatCameIsPassedOn) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Image colour(8, 1, 3, 0.5f);
  Image came(8, 1, 3, 1.0f);  // light of 2
  Image product = came;
  colour.at(1, 0, 0) = came.at(1, 0, 0) = 1e-9f;
  product.at(1, 0, 0) = 1e30f;
  colour.at(2, 0, 0) = came.at(2, 0, 0) = 1e-39f;
  came.at(3, 0, 0) = product.at(3, 0, 0) = infinity;
  came.at(4, 0, 0) = infinity;
  product.at(4, 0, 0) = 10.0f;
  product.at(5, 0, 0) = -infinity;
  const Image light = light_without_colour(product, colour, came);
  EXPECT_EQ(light.at(1, 0, 0), 2.0f) << "1e30 / 1e-9";
  EXPECT_EQ(light.at(2, 0, 0), 2.0f) << "1 / 1e-39";
  EXPECT_EQ(light.at(3, 0, 0), infinity) << "came so";
  EXPECT_EQ(light.at(4, 0, 0), 2.0f) << "made finite by the filter";
  EXPECT_EQ(light.at(5, 0, 0), -2.0f) << "came finite";
}

TEST_F(AdditiveLayers, DirectAndIndirectLightAreDenoisedAnyway) {
  write({{"", [](int i) { return first(i) + second(i); }}, {"direct", first}, {"indirect", second}});
  EXPECT_TRUE(sets().empty());
  write({{"", [](int i) { return 2.0f * first(i) + second(i); }},
         {"direct", first},
         {"indirect", second},
         {"emission", first}});
  EXPECT_EQ(choose_additive("auto", sets()), Names{"emission"});
}

TEST_F(AdditiveLayers, BarePartsCount) {
  write_parts({{"diffuse", first}, {"rgba", both}, {"specular", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"diffuse", "specular"}));
  denoise();
  EXPECT_FLOAT_EQ(read_value(read_planes(result_, 0), "G", 9), 2.0f * Imath::half(first(9)));
  EXPECT_FLOAT_EQ(read_value(read_planes(result_, 2), "B", 9), 2.0f * Imath::half(second(9)));
}

TEST_F(AdditiveLayers, LightGroupsMayBePartsOfTheirOwn) {
  write_parts({{"light.fill", first}, {"rgba", both}, {"light.key", second}});
  const std::vector<std::string> lines = describe_exr(path_, {}).lines();
  EXPECT_NE(std::ranges::find(lines, "  G  half   light fill.G"), lines.end());
  denoise();
  EXPECT_FLOAT_EQ(read_value(read_planes(result_, 0), "G", 9), 2.0f * Imath::half(first(9)));
  EXPECT_FLOAT_EQ(read_value(read_planes(result_, 2), "B", 9), 2.0f * Imath::half(second(9)));
}

TEST_F(AdditiveLayers, NamesOfPartsAreToldAsTheyAreWritten) {
  write_parts({{"light.Fill", first}, {"rgba", both}, {"light.Key", second}});
  const std::vector<std::string> lines = describe_exr(path_, {}).lines();
  EXPECT_NE(std::ranges::find(lines, "  G  half   light Fill.G"), lines.end());
  write_parts({{"Diffuse", first}, {"rgba", both}, {"Specular", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"Diffuse", "Specular"}));
}

TEST_F(AdditiveLayers, APartOfASummandIsNotTheBeauty) {
  write_parts(
      {{"AO", first}, {"CryptoMaterial00", first}, {"diffuse", first}, {"main", both}, {"specular", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"diffuse", "specular"}));
  write_parts({{"CryptoMaterial00", first}, {"position", first}});
  EXPECT_THROW(read_exr(path_, 1, {}, {}), Error) << "no colour";
  for (const char* ids : {"ObjectID", "id", "Material_Id", "matid", "objectId2", "ViewLayer.IndexOB",
                          "PuzzleMatte1", "WorldPosition", "Pworld"}) {
    write_parts({{ids, first}, {"main", second}});
    EXPECT_EQ(read_exr(path_, 1, {}, {}).frame.image(Aov::beauty).at(1, 0, 0), float(Imath::half(second(1))))
        << ids;
  }
  write_parts({{"AO", first}, {"position", second}});
  EXPECT_EQ(read_exr(path_, 1, {}, {}).frame.image(Aov::beauty).at(1, 0, 0), float(Imath::half(first(1))));
}

TEST_F(AdditiveLayers, ASummandOfAnotherDataWindowIsTold) {
  write_parts({{"rgba", both}, {"diffuse", first}, {"specular", second}}, {"specular"});
  EXPECT_TRUE(choose_additive("auto", sets()).empty());
  ASSERT_EQ(sets().size(), 1u);
  EXPECT_EQ(describe(sets()[0]),
            "diffuse, specular are passed on noisy, since specular has another data window than the beauty");
}

TEST_F(AdditiveLayers, LightGroupsOfAnotherDataWindowAreTold) {
  write_parts({{"rgba", both}, {"light.fill", first}, {"light.key", second}}, {"light.key"});
  EXPECT_TRUE(choose_additive("auto", sets()).empty());
  ASSERT_EQ(sets().size(), 1u);
  EXPECT_EQ(describe(sets()[0]),
            "light.key is passed on noisy, since it has another data window than the beauty");
  write_parts({{"rgba", both}, {"light.fill", first}, {"light.key", second}}, {"light.fill", "light.key"});
  ASSERT_EQ(sets().size(), 1u);
  EXPECT_EQ(describe(sets()[0]),
            "light.fill, light.key are passed on noisy, since they have another data window than the beauty");
}

TEST_F(AdditiveLayers, DirectLightOfAnotherDataWindowIsTold) {
  const std::string told = "direct is passed on noisy, since it has another data window than the beauty";
  write_parts({{"rgba", both}, {"direct", first}}, {"direct"});
  ASSERT_EQ(sets().size(), 1u);
  EXPECT_EQ(describe(sets()[0]), told);
  write_parts({{"rgba", both}, {"direct", first}, {"indirect", second}}, {"direct"});
  ASSERT_EQ(sets().size(), 1u);
  EXPECT_EQ(describe(sets()[0]), told) << "indirect light is denoised";
}

TEST_F(AdditiveLayers, ALightGroupMayHaveTheNameOfALobe) {
  write({{"", both},
         {"background", first},
         {"diffuse", second},
         {"light.background", first},
         {"light.key", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"background", "diffuse"}));
  denoise();
  for (const char* channel : {"background.G", "light.background.G"})
    EXPECT_EQ(result(channel, 9), 2.0f * Imath::half(first(9))) << channel;
  write({{"", [](int i) { return 2.0f * first(i) + second(i); }},
         {"light.background", first},
         {"light.emission", first},
         {"light.key", second}});
  EXPECT_TRUE(sets().empty()) << "they are denoised anyway";
}

TEST_F(AdditiveLayers, NamesThatDifferInCaseAloneAreTwoLayers) {
  write({{"", both}, {"RGBA_Key", first}, {"RGBA_key", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"RGBA_Key", "RGBA_key"}));
  denoise();
  EXPECT_EQ(result("RGBA_Key.G", 9), 2.0f * Imath::half(first(9)));
  EXPECT_EQ(result("RGBA_key.G", 9), 2.0f * Imath::half(second(9)));
}

TEST_F(AdditiveLayers, ACroppedLayerDecidesNothing) {
  const auto black = [](int) { return 0.0f; };
  write_parts(
      {{"rgba", black}, {"diffuse", black}, {"specular", black}, {"rgba_fill", black}, {"rgba_key", black}},
      {"rgba_fill"});
  const std::string of_black = folder_.path("black.exr");
  std::filesystem::rename(path_, of_black);
  write_parts({{"rgba", both}, {"diffuse", first}, {"specular", first}});
  EXPECT_TRUE(choose_additive("auto", find_additive_sets(Names{of_black, path_}, {})).empty());
}

TEST_F(AdditiveLayers, EachViewLayerHasItsOwn) {
  write({{"A.Combined", both},
         {"A.Emit", first},
         {"A.Env", second},
         {"B.Combined", first},
         {"B.Emit", second},
         {"B.Env", first}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"A.Emit", "A.Env"}));
  write({{"", both}, {"A.Emit", first}, {"A.Env", first}, {"B.Emit", first}, {"B.Env", second}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"B.Emit", "B.Env"})) << "a bare beauty may be of any";
}

TEST_F(AdditiveLayers, DiffuseIsLightBesideNormalsAlone) {
  write({{"", both}, {"diffuse", first}, {"specular", second}, {"normals", first}});
  EXPECT_EQ(choose_additive("auto", sets()), (Names{"diffuse", "specular"}));
  write({{"", both}, {"diffuse", first}, {"normals", first}, {"zDepth", first}});
  EXPECT_TRUE(contains(read_exr(path_, 1, AovSet().set(), {}).frame.aovs(), Aov::albedo)) << "V-Ray's";
}

TEST_F(AdditiveLayers, EachEyeHasItsOwnWhicheverViewIsNamed) {
  const std::vector<PartChannels> parts = {
      {.multi_view = {"left", "right"},
       .channels = {"R", "G", "B", "right.R", "right.G", "right.B", "left.key.R", "left.key.G", "left.key.B",
                    "right.key.R", "right.key.G", "right.key.B"}}};
  for (const std::string name : {"key", "left.key", "key.right"}) {
    const std::vector<ViewLayers> eyes = find_view_layers("file.exr", parts, {.additive = {name}});
    ASSERT_EQ(eyes.size(), 2) << name;
    EXPECT_EQ(eyes[0].lights.at("key").layer.channels.front(), "left.key.R") << name;
    EXPECT_EQ(eyes[1].lights.at("key").layer.channels.front(), "right.key.R") << name;
  }
}

TEST_F(AdditiveLayers, ALayerThatIsNotThereIsAnError) {
  write({{"", first}});
  EXPECT_THROW(read_exr(path_, 1, {}, {.additive = {"key"}}, LightGroups::read), Error);
  EXPECT_TRUE(sets().empty());
}

}  // namespace
}  // namespace becalm::io
