// becalm denoise: which channels are denoised, passed on and written, and in which types.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "tests/end_to_end/denoise_fixture.h"

namespace becalm::test {
namespace {

/// Ids beside half colours, as Cryptomatte has them, and somebody else's attribute.
void write_with_ids(const std::string& path, std::vector<std::uint32_t> ids) {
  const Frame frame = noise_frame(1);
  std::vector<Imath::half> colors(3 * ids.size());
  for (std::size_t pixel = 0; pixel < ids.size(); ++pixel) {
    for (std::size_t c = 0; c < 3; ++c)
      colors[3 * pixel + c] = Imath::half(frame.image(Aov::beauty).data()[4 * pixel + c]);
  }
  Imf::Header header(kWidth, kHeight);
  header.insert("cryptomatte/name", Imf::StringAttribute("objects"));
  Imf::FrameBuffer buffer;
  const char* names[] = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::HALF));
    buffer.insert(names[c], Imf::Slice(Imf::HALF, reinterpret_cast<char*>(colors.data() + c), 6, 6 * kWidth));
  }
  header.channels().insert("crypto.id", Imf::Channel(Imf::UINT));
  buffer.insert("crypto.id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(ids.data()), 4, 4 * kWidth));
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(kHeight);
}

/// A clean disc that moves over nothing, with premultiplied noise; alpha is `alpha` instead where it is
/// given.
Frame matte_frame(int number, std::optional<float> alpha = {}) {
  Frame frame = noise_frame(number);
  Image& beauty = frame.image(Aov::beauty);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float inside = std::clamp(
          8.5f - std::hypot(static_cast<float>(x - 14 - 2 * number), static_cast<float>(y - 16)), 0.0f, 1.0f);
      for (int c = 0; c < 3; ++c) beauty.at(x, y, c) *= alpha ? 1.0f : inside;
      beauty.at(x, y, 3) = alpha.value_or(inside);
    }
  }
  return frame;
}

std::set<std::string> channels_of(const std::string& path) {
  Imf::InputFile file(path.c_str());
  std::set<std::string> names;
  for (auto it = file.header().channels().begin(); it != file.header().channels().end(); ++it)
    names.insert(it.name());
  return names;
}

/// A beauty and two layers that share it out, as Arnold names them.
void write_lobes(const std::string& path, const Frame& frame) {
  write_shares(path, frame, {{"", 1.0f}, {"diffuse.", 0.25f}, {"specular.", 0.75f}, {"rim.", 0.1f}});
}

TEST_F(Denoise, AdditiveLayersStillAddUpToTheBeauty) {
  for (const int number : {1, 2, 3}) {
    Frame frame = noise_frame(number);
    frame.add(Aov::direct);
    frame.add(Aov::indirect);
    for (const char* name : {"sun", "lamp"}) {
      frame.light_groups().push_back({name, Image(kWidth, kHeight, 3)});
    }
    for (std::size_t i = 0; i < frame.image(Aov::beauty).pixel_count(); ++i) {
      const float share = static_cast<float>(i % 7) / 8.0f;
      for (std::size_t c = 0; c < 3; ++c) {
        const float radiance = frame.image(Aov::beauty).data()[4 * i + c];
        frame.light_groups()[0].radiance.data()[3 * i + c] = share * radiance;
        frame.light_groups()[1].radiance.data()[3 * i + c] = radiance - share * radiance;
        frame.image(Aov::direct).data()[3 * i + c] = 0.25f * radiance;
        frame.image(Aov::indirect).data()[3 * i + c] = 0.75f * radiance;
      }
    }
    io::write_exr(frame_path(input_, number), frame, {}, io::PixelType::float32);
  }
  const auto read = [&](const std::string& file) {
    return io::read_exr(folder_ / file, 2, all_aovs(), {}, io::LightGroups::read).frame;
  };
  const Frame noisy = read("in.0002.exr");
  becalm_done(command("out.####.exr"));
  const Frame denoised = read("out.0002.exr");
  ASSERT_EQ(denoised.light_groups().size(), 2u);
  for (std::size_t i = 0; i < denoised.image(Aov::beauty).pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float beauty = denoised.image(Aov::beauty).data()[4 * i + c];
      const auto part = [&](const Image& image) { return image.data()[3 * i + c]; };
      ASSERT_NEAR(part(denoised.light_groups()[0].radiance) + part(denoised.light_groups()[1].radiance),
                  beauty, 1e-5f * beauty);
      ASSERT_NEAR(part(denoised.image(Aov::direct)) + part(denoised.image(Aov::indirect)), beauty,
                  1e-5f * beauty);
    }
  }
  EXPECT_FALSE(same_pixels(noisy.image(Aov::direct), denoised.image(Aov::direct)));
  becalm_done(command("passed.####.exr", {"--additive", "none"}));
  const Frame passed = read("passed.0002.exr");
  EXPECT_TRUE(same_pixels(noisy.image(Aov::direct), passed.image(Aov::direct)));
  EXPECT_TRUE(same_pixels(noisy.light_groups()[1].radiance, passed.light_groups()[1].radiance));
  becalm_done(command("named.####.exr", {"--additive", "light.sun"}));
  const Frame named = read("named.0002.exr");
  EXPECT_TRUE(same_pixels(noisy.image(Aov::direct), named.image(Aov::direct)));
  EXPECT_TRUE(same_pixels(noisy.light_groups()[0].radiance, named.light_groups()[0].radiance)) << "lamp";
  EXPECT_FALSE(same_pixels(noisy.light_groups()[1].radiance, named.light_groups()[1].radiance)) << "sun";
}

TEST_F(Denoise, LayersThatAddUpToTheBeautyStillDo) {
  for (const int number : {1, 2}) write_lobes(frame_path(input_, number), noise_frame(number));
  const std::string said = "diffuse, specular add up to the beauty and are denoised with it";
  EXPECT_NE(becalm_done({"info", input_}).out.find(said), std::string::npos);
  const std::string json = becalm_done({"info", input_, "--json"}).out;
  EXPECT_NE(json.find("\"adds_up\": true"), std::string::npos) << json;
  const std::string plan = becalm_done(command("out.####.exr", {"--dry-run"})).out;
  EXPECT_NE(plan.find(said), std::string::npos) << plan;
  const std::string more = becalm_done(command("out.####.exr", {"--dry-run", "--additive", "auto,rim"})).out;
  EXPECT_NE(more.find(said), std::string::npos) << more;
  EXPECT_NE(more.find("denoises the lights diffuse, rim, specular"), std::string::npos) << more;
  EXPECT_NE(more.find("rim is denoised with the beauty\n"), std::string::npos) << more;
  becalm_done(command("out.####.exr", {"--set", "smooth=none"}));
  EXPECT_EQ(io::read_attribute(folder_ / "out.0002.exr", "becalm:additive"), "diffuse,specular");
  const Frame denoised = io::read_exr(folder_ / "out.0002.exr", 2, {}, {.additive = {"diffuse", "specular"}},
                                      io::LightGroups::read)
                             .frame;
  ASSERT_EQ(denoised.light_groups().size(), 2u);
  for (std::size_t i = 0; i < denoised.image(Aov::beauty).pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float beauty = denoised.image(Aov::beauty).data()[4 * i + c];
      const float sum = denoised.light_groups()[0].radiance.data()[3 * i + c] +
                        denoised.light_groups()[1].radiance.data()[3 * i + c];
      ASSERT_NEAR(sum, beauty, 1e-5f * beauty);
    }
  }
}

TEST_F(Denoise, PassesOnWhatItDoesNotDenoise) {
  std::vector<std::uint32_t> ids(kWidth * kHeight);
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = 0xfff00000u + static_cast<std::uint32_t>(i * 7919);
  write_with_ids(folder_ / "in.0001.exr", ids);
  write_with_ids(folder_ / "in.0002.exr", ids);
  becalm_done(command("out.####.exr", {"--set", "patch_radius=3", "--quiet"}));

  Imf::InputFile file((folder_ / "out.0002.exr").c_str());
  ASSERT_NE(file.header().channels().findChannel("crypto.id"), nullptr);
  EXPECT_EQ(file.header().channels().findChannel("crypto.id")->type, Imf::UINT);
  EXPECT_EQ(file.header().channels().findChannel("R")->type, Imf::HALF);
  EXPECT_EQ(file.header().typedAttribute<Imf::StringAttribute>("cryptomatte/name").value(), "objects");
  std::vector<std::uint32_t> passed(ids.size());
  Imf::FrameBuffer buffer;
  buffer.insert("crypto.id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(passed.data()), 4, 4 * kWidth));
  file.setFrameBuffer(buffer);
  file.readPixels(0, kHeight - 1);
  EXPECT_EQ(passed, ids);

  EXPECT_EQ(io::read_attribute(folder_ / "out.0002.exr", "becalm:preset"), "balanced");
  EXPECT_NE(io::read_attribute(folder_ / "out.0002.exr", "becalm:settings").find("patch_radius=3"),
            std::string::npos);
  EXPECT_NE(io::read_attribute(folder_ / "out.0002.exr", "becalm:version"), "");
}

TEST_F(Denoise, ACleanMatteIsNotMoved) {
  const std::optional<float> kinds[] = {std::nullopt, 0.0f, 1.0f};
  for (const std::optional<float> kind : kinds) {
    for (const int number : {1, 2, 3, 4}) {
      io::write_exr(frame_path(input_, number), matte_frame(number, kind), {});
    }
    EXPECT_NE(becalm_done({"info", input_}).out.find("\nalpha: passed on as it is\n"), std::string::npos);
    for (const char* preset : {"draft", "balanced"}) {
      becalm_done(command("out.####.exr", {"--preset", preset, "--overwrite", "--alpha", "denoise"}));
      for (const int number : {1, 2, 3, 4}) {
        const Image before = read_frame(frame_path(input_, number)).image(Aov::beauty);
        const std::string path = frame_path(folder_ / "out.####.exr", number);
        const Image after = read_frame(path).image(Aov::beauty);
        EXPECT_EQ(io::read_attribute(path, "becalm:alpha"), "passed on");
        for (std::size_t i = 0; i < before.pixel_count(); ++i) {
          ASSERT_EQ(after.data()[4 * i + 3], before.data()[4 * i + 3]) << preset << " pixel " << i;
          if (kind || before.data()[4 * i + 3] > 0) continue;
          ASSERT_EQ(after.data()[4 * i], 0.0f) << "light that no alpha covers, pixel " << i;
        }
      }
    }
  }
}

TEST_F(Denoise, NoisyAlphaIsDenoisedOnRequest) {
  for (const int number : {1, 2, 3, 4}) {
    Frame frame = noise_frame(7);
    const Frame noise = noise_frame(number);
    for (std::size_t i = 0; i < noise.image(Aov::beauty).pixel_count(); ++i) {
      frame.image(Aov::beauty).data()[4 * i + 3] = std::min(noise.image(Aov::beauty).data()[4 * i], 1.0f);
    }
    io::write_exr(frame_path(input_, number), frame, {}, io::PixelType::float32);
  }
  EXPECT_NE(becalm_done({"info", input_}).out.find("look noisy"), std::string::npos);
  becalm_done(command("passed.####.exr"));
  becalm_done(command("out.####.exr", {"--alpha", "denoise"}));
  EXPECT_EQ(io::read_attribute(folder_ / "passed.0002.exr", "becalm:alpha"), "passed on");
  EXPECT_EQ(io::read_attribute(folder_ / "out.0002.exr", "becalm:alpha").find("denoised in "), 0u);
  // Its pixels are alike but for the noise.
  const auto mean_and_variance = [&](const char* name) {
    const Image image = read_frame(folder_ / name).image(Aov::beauty);
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 3; i < image.data().size(); i += 4) {
      const double alpha = image.data()[i];
      EXPECT_GE(alpha, 0.0);
      EXPECT_LE(alpha, 1.0);
      sum += alpha;
      squares += alpha * alpha;
    }
    const double count = static_cast<double>(image.pixel_count());
    return std::pair{sum / count, squares / count - sum / count * (sum / count)};
  };
  const auto [mean_before, variance_before] = mean_and_variance("in.0002.exr");
  const auto [mean, variance] = mean_and_variance("out.0002.exr");
  EXPECT_NEAR(mean, mean_before, 0.05 * mean_before);
  EXPECT_LT(variance, 0.1 * variance_before);
}

TEST_F(Denoise, ChannelsToWriteAreSelected) {
  for (const int number : {1, 2}) {
    Frame frame = noise_frame(number);
    for (const Aov aov : {Aov::direct, Aov::depth}) frame.add(aov, 0.5f);
    io::write_exr(frame_path(input_, number), frame, {});
  }
  const std::set<std::string> beauty{"A", "B", "G", "R"};
  const std::set<std::string> direct{"direct.B", "direct.G", "direct.R"};
  std::set<std::string> denoised = beauty;
  denoised.insert(direct.begin(), direct.end());
  const auto write = [&](const std::string& pattern, std::vector<std::string> selection) {
    selection.insert(selection.end(), {"--preset", "draft"});
    becalm_done(command(pattern, selection));
  };
  write("all.####.exr", {});
  write("beauty.####.exr", {"--only", "beauty"});
  write("denoised.####.exr", {"--only", "denoised"});
  write("named.####.exr", {"--channels", "direct,depth.Z"});
  EXPECT_EQ(channels_of(folder_ / "beauty.0002.exr"), beauty);
  EXPECT_EQ(channels_of(folder_ / "denoised.0002.exr"), denoised);
  EXPECT_EQ(channels_of(folder_ / "named.0002.exr"),
            (std::set<std::string>{"depth.Z", "direct.B", "direct.G", "direct.R"}));
  EXPECT_TRUE(same_frame("all.0002.exr", "beauty.0002.exr"));
  expect_error(becalm(command("none.####.exr", {"--channels", "beauty,nothing"})), 2, {"--channels nothing"});
  EXPECT_EQ(files_in(folder_.path()).size(), 10u) << "nothing was written";
}

TEST_F(Denoise, OfNoisyLayersThoseAreToldThatAreWritten) {
  for (const int number : {1, 2}) {
    write_shares(
        frame_path(input_, number), noise_frame(number),
        {{"V.Combined.", 1.0f}, {"V.diffuse.", 0.25f}, {"V.specular.", 0.5f}, {"W.Combined.", 1.0f}});
  }
  const auto told = [&](std::vector<std::string> options) {
    options.insert(options.end(), {"--preset", "draft", "--overwrite"});
    const std::string text = becalm_done(command("out.####.exr", options)).err;
    const auto tells_of = [&](const char* layer) { return text.find(layer) != std::string::npos; };
    return std::pair{tells_of("W.Combined is passed on noisy"), tells_of("V.diffuse")};
  };
  EXPECT_EQ(told({}), (std::pair{true, true}));
  EXPECT_EQ(told({"--only", "denoised"}), (std::pair{false, true})) << "lobes that add up would be written";
  EXPECT_EQ(told({"--only", "beauty"}), (std::pair{false, false}));
  EXPECT_EQ(told({"--channels", "beauty"}), (std::pair{false, false}));
}

TEST_F(Denoise, LayersMayBeLeftOutAndMotionTurned) {
  for (const int number : {1, 2}) {
    Frame frame = noise_frame(number);
    frame.add(Aov::motion, 0.5f);
    io::write_exr(frame_path(input_, number), frame, {}, io::PixelType::float32);
  }
  const std::vector<std::string> options{"--layers", "albedo=none", "--motion", "flip-x,scale=0.5"};
  std::vector<std::string> info{"info", input_};
  info.insert(info.end(), options.begin(), options.end());
  const std::string described = becalm_done(info).out;
  EXPECT_NE(described.find("motion.X  float  motion.X negated times 0.5"), std::string::npos) << described;
  EXPECT_NE(described.find("albedo.R  float  passed on"), std::string::npos) << described;

  std::vector<std::string> fast = options;
  fast.insert(fast.end(), {"--preset", "draft", "--set", "motion=override", "--diagnostics"});
  becalm_done(command("out.####.exr", fast));
  EXPECT_NE(io::read_attribute(folder_ / "out.0002.exr", "becalm:settings")
                .find(" layers=albedo=none motion_change=flip-x,scale=0.5"),
            std::string::npos);
  const AovSet flow = AovSet().set(static_cast<std::size_t>(Aov::flow));
  const Image motion = read_frame(folder_ / "out.0002.exr", flow).image(Aov::flow);
  EXPECT_EQ(motion.at(20, 10, 0), -0.25f);
  EXPECT_EQ(motion.at(20, 10, 1), 0.25f);
  expect_error(becalm(command("out.####.exr", {"--motion", "flip"})), 2, {"motion 'flip'", "flip-x"});
}

TEST_F(Denoise, SubsampledGuidesAreRefusedBeforeAnythingIsWritten) {
  Imf::Header header(8, 8);
  Imf::FrameBuffer buffer;
  std::vector<float> plane(64, 0.5f);
  for (const auto& [layer, sampling] : {std::pair{"", 1}, {"albedo.", 2}}) {
    for (const char letter : std::string("RGB")) {
      header.channels().insert(layer + std::string(1, letter), Imf::Channel(Imf::FLOAT, sampling, sampling));
      buffer.insert(layer + std::string(1, letter),
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()), 4, 32, sampling, sampling));
    }
  }
  {
    Imf::OutputFile file(frame_path(input_, 1).c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(8);
  }
  const std::string remedy = "--layers albedo=none leaves it out";
  expect_error(becalm(command("out/a.####.exr", {"--dry-run"})), 3, {frame_path(input_, 1), remedy});
  const Outcome info = becalm({"info", input_});
  EXPECT_EQ(info.status, 3);
  EXPECT_NE(info.err.find(remedy), std::string::npos) << info.err;
  becalm_done(command("out/a.####.exr", {"--layers", "albedo=none", "--quiet"}));
  Imf::InputFile result((folder_ / "out/a.0001.exr").c_str());
  EXPECT_EQ(result.header().channels()["albedo.R"].xSampling, 2);
}

TEST_F(Denoise, HugeDepthsMeanThatNothingIsHit) {
  const auto denoise = [&](float nothing, const std::string& pattern) {
    for (const int number : {1, 2}) {
      Frame frame = noise_frame(number);
      Image& depth = frame.add(Aov::depth);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) depth.at(x, y, 0) = 2 * x < kWidth ? nothing : 10.0f + y;
      }
      io::write_exr(frame_path(input_, number), frame, {}, io::PixelType::float32);
    }
    becalm_done(command(pattern, {"--quiet"}));
  };
  denoise(std::numeric_limits<float>::infinity(), "infinite.####.exr");
  denoise(1e10f, "blender.####.exr");
  EXPECT_TRUE(same_frame("infinite.0002.exr", "blender.0002.exr"));
}

TEST_F(Denoise, ASlateLeavesAdditiveLayersNoisy) {
  Frame slate = noise_frame(1);
  for (const Aov aov : {Aov::albedo, Aov::normal}) slate.remove(aov);
  io::write_exr(frame_path(input_, 1), slate, {}, io::PixelType::float32);
  for (const int number : {2, 3}) write_lobes(frame_path(input_, number), noise_frame(number));
  const auto said = [&](const std::string& output, std::vector<std::string> more) {
    more.insert(more.end(), {"--preset", "draft"});
    return becalm_done(command(output, more)).err;
  };
  const std::string noisy = "since frame 1 on disk lacks them";
  EXPECT_NE(said("out.####.exr", {}).find(noisy), std::string::npos);
  EXPECT_NE(said("part.####.exr", {"--frames", "2-3"}).find(noisy), std::string::npos)
      << "all jobs of a sequence choose alike";
  const Outcome told = becalm_done(
      command("told.####.exr", {"--frames", "2-3", "--additive", "diffuse,specular", "--context", "none"}));
  EXPECT_NE(told.err.find("diffuse, specular are denoised"), std::string::npos) << "as the note says";
  fs::rename(frame_path(input_, 1), frame_path(input_, 4));
  EXPECT_NE(said("last.####.exr", {}).find("since frame 4 on disk lacks them"), std::string::npos);
  fs::remove(frame_path(input_, 4));
  EXPECT_NE(said("shot.####.exr", {}).find("diffuse, specular add up"), std::string::npos);
}

TEST_F(Denoise, NonFinitePixelsStayAndAreReportedOnce) {
  Frame frame = noise_frame(1);
  frame.image(Aov::beauty).at(10, 10, 1) = std::numeric_limits<float>::quiet_NaN();
  frame.image(Aov::beauty).at(20, 10, 0) = std::numeric_limits<float>::infinity();
  io::write_exr(frame_path(input_, 1), frame, {}, io::PixelType::float32);
  write_frames({2});
  const Outcome outcome = becalm_done(command("a.####.exr", {"--quiet"}));
  EXPECT_EQ(outcome.err, "becalm: frame 1: 2 pixels with NaN or Inf stay as they came\n");
  const Frame after = read_frame(folder_ / "a.0002.exr");
  for (const float value : after.image(Aov::beauty).data()) ASSERT_TRUE(std::isfinite(value));
}

TEST_F(Denoise, TypeAndCompressionOfTheOutput) {
  write_frames({1});
  becalm_done(command("out.####.exr", {"--type", "half", "--compression", "piz", "--quiet"}));
  Imf::InputFile file((folder_ / "out.0001.exr").c_str());
  EXPECT_EQ(file.header().channels().findChannel("R")->type, Imf::HALF);
  EXPECT_EQ(file.header().channels().findChannel("albedo.R")->type, Imf::FLOAT);
  EXPECT_EQ(file.header().compression(), Imf::PIZ_COMPRESSION);
  expect_error(becalm(command("out.####.exr", {"--resume"})), 2, {"type=half"});
  expect_error(becalm(command("b.####.exr", {"--compression", "best"})), 2, {"--compression", "zip"});
}

}  // namespace
}  // namespace becalm::test
