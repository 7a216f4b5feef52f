#include "frame/io/layers.h"

#include <gtest/gtest.h>

#include "frame/error.h"
#include "tests/error_of.h"

namespace becalm::io {
namespace {

using Names = std::vector<std::string>;

constexpr std::array<float, 4> kAsItIs{1.0f, 1.0f, 1.0f, 1.0f};
constexpr std::array<float, 4> kUpwards{1.0f, -1.0f, 1.0f, 1.0f};

LayerMap find(const Names& channels, const LayerOverrides& overrides = {}) {
  return find_layers("file.exr", {{.channels = channels}}, {.layers = overrides});
}

const std::optional<LayerSource>& source(const LayerMap& map, Aov aov) {
  return map[static_cast<std::size_t>(aov)];
}

Names channels_of(const LayerMap& map, Aov aov) {
  return source(map, aov) ? source(map, aov)->channels : Names{"not found"};
}

const Names kBlender = {"Composite.Combined.A",
                        "Composite.Combined.B",
                        "Composite.Combined.G",
                        "Composite.Combined.R",
                        "ViewLayer.Combined.A",
                        "ViewLayer.Combined.B",
                        "ViewLayer.Combined.G",
                        "ViewLayer.Combined.R",
                        "ViewLayer.CryptoObject00.A",
                        "ViewLayer.CryptoObject00.B",
                        "ViewLayer.CryptoObject00.G",
                        "ViewLayer.CryptoObject00.R",
                        "ViewLayer.Denoising Albedo.B",
                        "ViewLayer.Denoising Albedo.G",
                        "ViewLayer.Denoising Albedo.R",
                        "ViewLayer.Denoising Depth.Z",
                        "ViewLayer.Denoising Normal.X",
                        "ViewLayer.Denoising Normal.Y",
                        "ViewLayer.Denoising Normal.Z",
                        "ViewLayer.Depth.Z",
                        "ViewLayer.Normal.X",
                        "ViewLayer.Normal.Y",
                        "ViewLayer.Normal.Z",
                        "ViewLayer.Vector.W",
                        "ViewLayer.Vector.X",
                        "ViewLayer.Vector.Y",
                        "ViewLayer.Vector.Z"};

TEST(Layers, BareColour) {
  const LayerMap map = find({"A", "B", "G", "R", "Z"});
  EXPECT_EQ(channels_of(map, Aov::beauty), (Names{"R", "G", "B", "A"}));
  EXPECT_EQ(channels_of(map, Aov::depth), Names{"Z"});
  EXPECT_FALSE(source(map, Aov::albedo));
  EXPECT_FALSE(source(map, Aov::variance));
}

TEST(Layers, MissingAlphaIsAnEmptyName) {
  EXPECT_EQ(channels_of(find({"B", "G", "R"}), Aov::beauty), (Names{"R", "G", "B", ""}));
}

TEST(Layers, BecalmsOwnNames) {
  Names all;
  for (const AovInfo& entry : kAovTable) {
    for (char c : entry.channels)
      all.push_back((entry.name.empty() ? "" : std::string(entry.name) + ".") + c);
  }
  const LayerMap map = find(all);
  for (const AovInfo& entry : kAovTable) {
    ASSERT_TRUE(source(map, entry.aov)) << entry.name;
    EXPECT_EQ(source(map, entry.aov)->scale, kAsItIs);
    for (std::size_t c = 0; c < entry.channels.size(); ++c) {
      EXPECT_EQ(channels_of(map, entry.aov)[c],
                (entry.name.empty() ? "" : std::string(entry.name) + ".") + entry.channels[c]);
    }
  }
}

TEST(Layers, BlendersViewLayer) {
  const LayerMap map = find(kBlender);
  EXPECT_EQ(channels_of(map, Aov::beauty), (Names{"ViewLayer.Combined.R", "ViewLayer.Combined.G",
                                                  "ViewLayer.Combined.B", "ViewLayer.Combined.A"}));
  EXPECT_EQ(channels_of(map, Aov::albedo),
            (Names{"ViewLayer.Denoising Albedo.R", "ViewLayer.Denoising Albedo.G",
                   "ViewLayer.Denoising Albedo.B"}));
  EXPECT_EQ(channels_of(map, Aov::normal),
            (Names{"ViewLayer.Denoising Normal.X", "ViewLayer.Denoising Normal.Y",
                   "ViewLayer.Denoising Normal.Z"}));
  EXPECT_EQ(channels_of(map, Aov::depth), Names{"ViewLayer.Depth.Z"});
  EXPECT_EQ(channels_of(map, Aov::motion), (Names{"ViewLayer.Vector.X", "ViewLayer.Vector.Y"}));
  EXPECT_EQ(source(map, Aov::motion)->scale, kUpwards);
  EXPECT_FALSE(source(map, Aov::half_a));
}

TEST(Layers, BeautiesOfOtherViewLayersAreFound) {
  std::vector<PartChannels> parts(1);
  for (const char* layer :
       {"ViewLayer.Combined", "ViewLayer.Noisy Image", "fg.Combined", "Composite.Combined"}) {
    for (const char* letter : {".R", ".G", ".B"}) parts[0].channels.push_back(std::string(layer) + letter);
  }
  const LayerSource beauty{.part = 0, .channels = {"ViewLayer.Combined.R"}};
  EXPECT_EQ(find_other_beauties(parts, beauty, ""), Names{"fg.Combined"});
  const LayerSource other{.part = 0, .channels = {"fg.Combined.R"}};
  EXPECT_EQ(find_other_beauties(parts, other, ""), Names{"ViewLayer.Combined"});
  EXPECT_TRUE(find_other_beauties({{.channels = {"R", "G", "B"}}}, {.channels = {"R"}}, "").empty());
}

TEST(Layers, LuminanceIsToldFromMissingColour) {
  const auto error_of = [](const Names& channels) {
    try {
      find(channels);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(error_of({"BY", "RY", "Y"}).find("luminance and chroma must be converted"), std::string::npos);
  EXPECT_NE(error_of({"Y"}).find("Y alone is one channel"), std::string::npos) << error_of({"Y"});
  EXPECT_EQ(error_of({"X"}).find("luminance"), std::string::npos) << error_of({"X"});
}

TEST(Layers, TheCompositeIsTheLastChoice) {
  const LayerMap map =
      find({"Composite.Combined.A", "Composite.Combined.B", "Composite.Combined.G", "Composite.Combined.R"});
  EXPECT_EQ(channels_of(map, Aov::beauty)[0], "Composite.Combined.R");
}

TEST(Layers, NoisyImageIsABeautyToo) {
  EXPECT_EQ(channels_of(find({"V.Noisy Image.B", "V.Noisy Image.G", "V.Noisy Image.R"}), Aov::beauty),
            (Names{"V.Noisy Image.R", "V.Noisy Image.G", "V.Noisy Image.B", ""}));
}

TEST(Layers, KarmasColourIsCAndItsLobesAreNone) {
  EXPECT_EQ(channels_of(find({"C.A", "C.B", "C.G", "C.R"}), Aov::beauty)[0], "C.R");
  for (const char* other :
       {"combineddiffuse", "glossyreflection", "beautyunshadowed", "denoised", "VRayDenoiser"}) {
    const std::vector<PartChannels> parts{{.name = other, .channels = {"B", "G", "R"}},
                                          {.name = "noisy", .channels = {"B", "G", "R"}}};
    EXPECT_EQ(source(find_layers("f", parts, {}), Aov::beauty)->part, 1) << other;
  }
}

TEST(Layers, NamesAreParsedFromTheRight) {
  const LayerMap map = find({"My.v2 Layer.Combined.B", "My.v2 Layer.Combined.G", "My.v2 Layer.Combined.R",
                             "My.v2 Layer.Denoising Albedo.B", "My.v2 Layer.Denoising Albedo.G",
                             "My.v2 Layer.Denoising Albedo.R"});
  EXPECT_EQ(channels_of(map, Aov::beauty)[0], "My.v2 Layer.Combined.R");
  EXPECT_EQ(channels_of(map, Aov::albedo)[2], "My.v2 Layer.Denoising Albedo.B");
}

TEST(Layers, AovsComeFromTheBeautysViewLayer) {
  const LayerMap map = find({"Back.Denoising Albedo.B", "Back.Denoising Albedo.G", "Back.Denoising Albedo.R",
                             "Front.Combined.B", "Front.Combined.G", "Front.Combined.R", "depth.Z"});
  EXPECT_EQ(channels_of(map, Aov::beauty)[0], "Front.Combined.R");
  EXPECT_FALSE(source(map, Aov::albedo));
  EXPECT_EQ(channels_of(map, Aov::depth), Names{"depth.Z"});
}

TEST(Layers, AnyViewLayerGoesWithABareBeauty) {
  const LayerMap map =
      find({"B", "G", "R", "V.Denoising Albedo.B", "V.Denoising Albedo.G", "V.Denoising Albedo.R"});
  EXPECT_EQ(channels_of(map, Aov::beauty)[0], "R");
  EXPECT_EQ(channels_of(map, Aov::albedo)[0], "V.Denoising Albedo.R");
}

TEST(Layers, CaseAndSpelledOutSuffixesCount) {
  const LayerMap map = find({"alpha", "blue", "green", "red", "ALBEDO.Blue", "ALBEDO.Green", "ALBEDO.Red",
                             "normal.x", "normal.y", "normal.z", "z"});
  EXPECT_EQ(channels_of(map, Aov::beauty), (Names{"red", "green", "blue", "alpha"}));
  EXPECT_EQ(channels_of(map, Aov::albedo), (Names{"ALBEDO.Red", "ALBEDO.Green", "ALBEDO.Blue"}));
  EXPECT_EQ(channels_of(map, Aov::normal), (Names{"normal.x", "normal.y", "normal.z"}));
  EXPECT_EQ(channels_of(map, Aov::depth), Names{"z"});
}

TEST(Layers, NormalsMayBeColoursAndDepthAnyLetter) {
  const LayerMap map = find({"R", "G", "B", "normal.R", "normal.G", "normal.B", "depth.V"});
  EXPECT_EQ(channels_of(map, Aov::normal), (Names{"normal.R", "normal.G", "normal.B"}));
  EXPECT_EQ(channels_of(map, Aov::depth), Names{"depth.V"});
  EXPECT_EQ(channels_of(find({"R", "G", "B", "Depth"}), Aov::depth), Names{"Depth"});
}

TEST(Layers, IncompleteLayersAreNotTaken) {
  const LayerMap map = find({"R", "G", "B", "albedo.R", "albedo.G", "motion.X"});
  EXPECT_FALSE(source(map, Aov::albedo));
  EXPECT_FALSE(source(map, Aov::motion));
}

TEST(Layers, PartsAreTold) {
  const LayerMap map = find_layers("file.exr",
                                   {{.channels = {"Z"}},
                                    {.channels = {"R", "G", "B"}},
                                    {.channels = {"albedo.R", "albedo.G", "albedo.B"}}},
                                   {});
  EXPECT_EQ(source(map, Aov::depth)->part, 0);
  EXPECT_EQ(source(map, Aov::beauty)->part, 1);
  EXPECT_EQ(source(map, Aov::albedo)->part, 2);
}

TEST(Layers, ALayerIsNotPutTogetherFromTwoParts) {
  const std::string told = error_of(ExitStatus::bad_input, [] {
    find_layers("file.exr", {{.channels = {"R", "G"}}, {.channels = {"B"}}}, {});
  });
  EXPECT_TRUE(told.ends_with("channels found: R, G, B; R, G and B must lie in one part")) << told;
}

TEST(Layers, SummandsMayLieInPartsOfTheBeautysSizeThatHoldNoOtherPicture) {
  const Names rgb{"R", "G", "B"};
  const Names key{"light.key.R", "light.key.G", "light.key.B"};
  std::vector<PartChannels> parts = {{.name = "light.fill", .channels = {"R", "G", "B", "A"}},
                                     {.name = "rgba", .channels = rgb},
                                     {.name = "lights", .channels = key},
                                     {.name = "direct", .channels = rgb},
                                     {.name = "indirect", .channels = rgb}};
  const auto find_all = [&] { return find_view_layers("file.exr", parts, {}).front(); };
  const auto names_of = [](const ViewLayers& view) {
    Names names;
    for (const auto& [name, light] : view.lights) names.push_back(name);
    return names;
  };
  ViewLayers view = find_all();
  EXPECT_EQ(source(view.layers, Aov::beauty)->part, 1);
  EXPECT_EQ(names_of(view), (Names{"fill", "key"}));
  EXPECT_EQ(view.lights.at("fill").layer.part, 0);
  EXPECT_EQ(source(view.layers, Aov::direct)->part, 3);
  parts[1].name = "main";
  EXPECT_EQ(source(find_all().layers, Aov::beauty)->part, 1) << "no light group";
  parts[0].data_window.max.x = parts[4].data_window.max.x = 7;
  view = find_all();
  EXPECT_EQ(names_of(view), Names{"key"});
  EXPECT_TRUE(source(view.layers, Aov::direct));
  EXPECT_FALSE(source(view.layers, Aov::indirect));
  parts[2].channels.insert(parts[2].channels.end(), rgb.begin(), rgb.end());
  EXPECT_EQ(names_of(find_all()), Names()) << "of another picture";
}

TEST(Layers, DepthIsNeverTheZOfAPositionOrNormal) {
  const std::vector<PartChannels> parts = {{.name = "RGBA", .channels = {"R", "G", "B"}},
                                           {.name = "Position", .channels = {"X", "Y", "Z"}},
                                           {.name = "ViewLayer.Normal", .channels = {"X", "Y", "Z"}}};
  const LayerMap map = find_layers("file.exr", parts, {});
  EXPECT_FALSE(source(map, Aov::depth));
  EXPECT_EQ(source(map, Aov::normal)->part, 2);
  EXPECT_FALSE(source(find({"R", "G", "B", "X", "Y", "Z"}), Aov::depth));
  EXPECT_FALSE(source(find({"R", "G", "B", "P.X", "P.Y", "P.Z"}), Aov::depth));
}

TEST(Layers, ABareZIsThatOfTheBeautysPart) {
  const std::vector<PartChannels> parts = {{.name = "shadow", .channels = {"Z"}},
                                           {.name = "rgba", .channels = {"R", "G", "B", "Z"}}};
  EXPECT_EQ(source(find_layers("file.exr", parts, {}), Aov::depth)->part, 1);
}

TEST(Layers, PartsNameTheirBareChannels) {
  const std::vector<PartChannels> parts = {{.name = "albedo", .channels = {"R", "G", "B"}},
                                           {.name = "V.Combined", .channels = {"A", "R", "G", "B"}},
                                           {.name = "V.Depth", .channels = {"V"}},
                                           {.name = "W.Vector", .channels = {"W", "X", "Y", "Z"}},
                                           {.name = "V.Vector", .channels = {"W", "X", "Y", "Z"}}};
  const LayerMap map = find_layers("file.exr", parts, {});
  EXPECT_EQ(source(map, Aov::beauty)->part, 1);
  EXPECT_EQ(source(map, Aov::albedo)->part, 0);
  EXPECT_EQ(source(map, Aov::depth)->part, 2);
  EXPECT_EQ(source(map, Aov::motion)->part, 4);
  EXPECT_EQ(source(map, Aov::motion)->scale, kUpwards);
}

TEST(Layers, ABeautyMayLieInAPartOfAnyName) {
  const std::vector<PartChannels> parts = {{.name = "N", .channels = {"R", "G", "B"}},
                                           {.name = "shot 7", .channels = {"R", "G", "B"}}};
  const LayerMap map = find_layers("file.exr", parts, {});
  EXPECT_EQ(source(map, Aov::beauty)->part, 1);
  EXPECT_EQ(source(map, Aov::normal)->part, 0);
}

TEST(Layers, OverridesAddressParts) {
  const std::vector<PartChannels> parts = {
      {.name = "main", .channels = {"R", "G", "B", "Z"}},
      {.name = "first", .channels = {"R", "G", "B", "x.R", "x.G", "x.B", "Z"}},
      {.name = "a/b", .channels = {"x.R", "x.G", "x.B"}}};
  const auto part_of = [&](Aov aov, const std::string& name) {
    return source(find_layers("file.exr", parts, {.layers = {{aov, name}}}), aov)->part;
  };
  EXPECT_EQ(part_of(Aov::albedo, "first"), 1);
  EXPECT_EQ(part_of(Aov::albedo, "first/x"), 1);
  EXPECT_EQ(part_of(Aov::albedo, "A/B/X"), 2);
  EXPECT_EQ(part_of(Aov::depth, "first/Z"), 1);
  EXPECT_EQ(part_of(Aov::depth, "Z"), 0);
  EXPECT_THROW(part_of(Aov::albedo, "main/x"), Error);
}

TEST(Layers, NoneLeavesALayerOut) {
  const LayerMap map = find(kBlender, {{Aov::albedo, "none"}, {Aov::motion, "None"}});
  EXPECT_FALSE(source(map, Aov::albedo));
  EXPECT_FALSE(source(map, Aov::motion));
  EXPECT_TRUE(source(map, Aov::normal));
}

TEST(Layers, MotionIsChangedAfterTheTablesConvention) {
  const auto motion = [](const std::string& change) {
    const LayerOptions options{.motion = parse_motion_change(change)};
    return *source(find_layers("file.exr", {{.channels = kBlender}}, options), Aov::motion);
  };
  EXPECT_EQ(motion("").scale, kUpwards);
  EXPECT_EQ(motion("flip-x,flip-y,scale=0.5").scale, (std::array<float, 4>{-0.5f, 0.5f, 1.0f, 1.0f}));
  EXPECT_EQ(motion("swap").channels, (Names{"ViewLayer.Vector.Y", "ViewLayer.Vector.X"}));
  EXPECT_EQ(motion("swap").scale, kUpwards) << "the axes' signs stay at the axes";
}

TEST(Layers, AnEyeHasItsOwnAovs) {
  const std::vector<PartChannels> one_part = {
      {.multi_view = {"left", "right"},
       .channels = {"A", "B", "G", "R", "Z", "albedo.B", "albedo.G", "albedo.R", "right.A", "right.B",
                    "right.G", "right.R", "right.Z", "albedo.right.R", "albedo.right.G", "albedo.right.B",
                    "N.X", "N.Y", "N.Z"}}};
  EXPECT_EQ(find_views(one_part), (Names{"left", "right"}));
  const LayerMap left = find_layers("file.exr", one_part, {}, "left");
  EXPECT_EQ(channels_of(left, Aov::beauty), (Names{"R", "G", "B", "A"}));
  EXPECT_EQ(channels_of(left, Aov::depth), Names{"Z"});
  EXPECT_EQ(channels_of(left, Aov::albedo)[0], "albedo.R");
  EXPECT_TRUE(source(left, Aov::normal));
  const LayerMap right = find_layers("file.exr", one_part, {}, "right");
  EXPECT_EQ(channels_of(right, Aov::beauty), (Names{"right.R", "right.G", "right.B", "right.A"}));
  EXPECT_EQ(channels_of(right, Aov::depth), Names{"right.Z"});
  EXPECT_EQ(channels_of(right, Aov::albedo)[2], "albedo.right.B");
  EXPECT_FALSE(source(right, Aov::normal)) << "those of the left eye are of other surfaces";
}

TEST(Layers, APartMayBeAnEyes) {
  const std::vector<PartChannels> parts = {
      {.name = "left", .view = "left", .channels = {"R", "G", "B"}},
      {.name = "left.depth", .view = "left", .channels = {"Z"}},
      {.name = "right", .view = "right", .channels = {"R", "G", "B"}},
      {.name = "albedo.right", .view = "right", .channels = {"R", "G", "B"}}};
  EXPECT_EQ(find_views(parts), (Names{"left", "right"}));
  const LayerMap left = find_layers("file.exr", parts, {}, "left");
  const LayerMap right = find_layers("file.exr", parts, {}, "right");
  EXPECT_EQ(source(left, Aov::beauty)->part, 0);
  EXPECT_EQ(source(left, Aov::depth)->part, 1);
  EXPECT_FALSE(source(left, Aov::albedo));
  EXPECT_EQ(source(right, Aov::beauty)->part, 2);
  EXPECT_EQ(source(right, Aov::albedo)->part, 3);
  EXPECT_FALSE(source(right, Aov::depth));
}

TEST(Layers, OverridesMayHaveTheNameOfAView) {
  const std::vector<PartChannels> one_part = {
      {.multi_view = {"left", "right"},
       .channels = {"R", "G", "B", "right.R", "right.G", "right.B", "Z", "right.Z", "left.c.R", "left.c.G",
                    "left.c.B", "c.right.R", "c.right.G", "c.right.B"}}};
  for (const std::string name : {"c", "left.c", "c.right", "Right.C"}) {
    for (const std::string view : {"left", "right"}) {
      const LayerMap map = find_layers("file.exr", one_part, {.layers = {{Aov::albedo, name}}}, view);
      EXPECT_EQ(channels_of(map, Aov::albedo)[0], view == "left" ? "left.c.R" : "c.right.R") << name;
    }
  }
  for (const std::string name : {"Z", "right.Z", "left.Z"}) {
    for (const std::string view : {"left", "right"}) {
      const LayerMap map = find_layers("file.exr", one_part, {.layers = {{Aov::depth, name}}}, view);
      EXPECT_EQ(channels_of(map, Aov::depth), Names{view == "left" ? "Z" : "right.Z"}) << name;
    }
  }
  const std::vector<PartChannels> parts = {
      {.name = "rgb.left", .view = "left", .channels = {"R", "G", "B"}},
      {.name = "rgb.right", .view = "right", .channels = {"R", "G", "B"}},
      {.name = "c.left", .view = "left", .channels = {"R", "G", "B", "x.R", "x.G", "x.B"}},
      {.name = "c.right", .view = "right", .channels = {"R", "G", "B", "x.R", "x.G", "x.B"}}};
  for (const std::string name : {"c", "c.left", "c.right", "c.left/x", "c.right/x", "c/x"}) {
    for (const std::string view : {"left", "right"}) {
      const LayerMap map = find_layers("file.exr", parts, {.layers = {{Aov::albedo, name}}}, view);
      EXPECT_EQ(source(map, Aov::albedo)->part, view == "left" ? 2 : 3) << name;
      EXPECT_EQ(channels_of(map, Aov::albedo)[0], name.ends_with('x') ? "x.R" : "R") << name;
    }
  }
}

TEST(Layers, NoColourListsTheChannels) {
  EXPECT_EQ(error_of(ExitStatus::bad_input,
                     [] {
                       find({"Z", "id.U"});
                     }),
            "file.exr: no colour: expected channels R G B or LAYER.Combined.R G B, or --layers beauty=NAME; "
            "channels found: Z, id.U");
  EXPECT_NE(error_of(ExitStatus::bad_input, [] { find_layers("f.exr", {PartChannels()}, {}); })
                .find("channels found: none"),
            std::string::npos);
  const std::string many = error_of(ExitStatus::bad_input, [] { find(Names(100, "x.Y")); });
  EXPECT_NE(many.find("and 40 more"), std::string::npos);
}

TEST(Layers, OverridesNameWholeLayersOrTheirEnds) {
  const LayerMap map = find(
      kBlender,
      {{Aov::normal, "ViewLayer.Normal"}, {Aov::depth, "denoising depth"}, {Aov::albedo, "CryptoObject00"}});
  EXPECT_EQ(channels_of(map, Aov::normal)[0], "ViewLayer.Normal.X");
  EXPECT_EQ(channels_of(map, Aov::depth), Names{"ViewLayer.Denoising Depth.Z"});
  EXPECT_EQ(channels_of(map, Aov::albedo)[0], "ViewLayer.CryptoObject00.R");
  EXPECT_EQ(channels_of(map, Aov::motion)[0], "ViewLayer.Vector.X");
}

TEST(Layers, AnOverriddenBeautyChoosesTheViewLayer) {
  const LayerMap map = find({"A.Combined.B", "A.Combined.G", "A.Combined.R", "A.Depth.Z", "B.Combined.B",
                             "B.Combined.G", "B.Combined.R", "B.Depth.Z"},
                            {{Aov::beauty, "B.Combined"}});
  EXPECT_EQ(channels_of(map, Aov::beauty)[0], "B.Combined.R");
  EXPECT_EQ(channels_of(map, Aov::depth), Names{"B.Depth.Z"});
}

TEST(Layers, OverridesKeepTheTablesConvention) {
  EXPECT_EQ(source(find(kBlender, {{Aov::motion, "Vector"}}), Aov::motion)->scale, kUpwards);
  const LayerMap own = find({"R", "G", "B", "mv.X", "mv.Y"}, {{Aov::motion, "mv"}});
  EXPECT_EQ(source(own, Aov::motion)->scale, kAsItIs);
  EXPECT_EQ(channels_of(find({"R", "G", "B", "Z"}, {{Aov::depth, "Z"}}), Aov::depth), Names{"Z"});
}

TEST(Layers, AnOverrideThatIsNotThereNamesFileAndLayer) {
  EXPECT_EQ(error_of(ExitStatus::bad_input,
                     [] {
                       find({"R", "G", "B"}, {{Aov::albedo, "diffuse"}});
                     }),
            "file.exr: no layer 'diffuse' with channels for albedo (RGB); channels found: R, G, B");
  EXPECT_EQ(error_of(ExitStatus::bad_input,
                     [] {
                       find_layers("file.exr",
                                   {{.name = "rgba", .channels = {"R", "G", "B"}},
                                    {.name = "N", .channels = {"N.X"}}},
                                   {.layers = {{Aov::albedo, "diffuse"}}});
                     }),
            "file.exr: no layer 'diffuse' with channels for albedo (RGB); channels found: rgba/R, rgba/G, "
            "rgba/B, N/N.X");
}

TEST(Layers, LightGroupsThatDifferInCaseAloneAreTwo) {
  const std::vector<PartChannels> parts{
      {.channels = {"B", "G", "R", "light.Key.B", "light.Key.G", "light.Key.R", "light.key.B", "light.key.G",
                    "light.key.R"}}};
  const ViewLayers view = find_view_layers("file.exr", parts, {}).front();
  ASSERT_EQ(view.lights.size(), 2u);
  EXPECT_EQ(view.lights.at("Key").layer.channels[0], "light.Key.R");
  EXPECT_EQ(view.lights.at("key").layer.channels[0], "light.key.R");
}

}  // namespace
}  // namespace becalm::io
