// becalm denoise: what it passes on, what it does about gaps, and how it goes on.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 32;

class Denoise : public testing::Test {
 protected:
  void write_frames(const std::vector<int>& numbers) const {
    for (const int number : numbers) {
      io::write_exr(frame_path(input_, number), noise_frame(number), {}, io::PixelType::float32);
    }
  }
  std::vector<std::string> command(const std::string& pattern,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"denoise", input_, "-o", folder_ / pattern};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  bool same_frame(const std::string& a, const std::string& b) const {
    return same_pixels(read_frame(folder_ / a).image(Aov::beauty),
                       read_frame(folder_ / b).image(Aov::beauty));
  }

  TempFolder folder_;
  std::string input_ = folder_ / "in.####.exr";
};

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

/// A still picture with a little noise of the number inside `drawn`, black and transparent outside, in a file
/// of these windows.
void write_window(const std::string& path, int number, const Imath::Box2i& data_window,
                  const Imath::Box2i& display_window, const Imath::Box2i& drawn) {
  const Frame still = noise_frame(7);
  const Frame noise = noise_frame(number);
  Image colors(kWidth, kHeight, 4);
  for (int y = drawn.min.y; y <= drawn.max.y; ++y) {
    for (int x = drawn.min.x; x <= drawn.max.x; ++x) {
      for (int c = 0; c < 3; ++c) {
        colors.at(x, y, c) =
            still.image(Aov::beauty).at(x, y, c) + 0.1f * noise.image(Aov::beauty).at(x, y, c);
      }
      colors.at(x, y, 3) = 1.0f;
    }
  }
  Imf::Header header(display_window, data_window);
  Imf::FrameBuffer buffer;
  const char* names[] = {"R", "G", "B", "A"};
  for (std::size_t c = 0; c < 4; ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
    buffer.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(colors.data().data() + c),
                                       4 * sizeof(float), 4 * sizeof(float) * kWidth));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(data_window.max.y - data_window.min.y + 1);
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
  becalm_done(command("passed.####.exr", {"--set", "additive=0"}));
  const Frame passed = read("passed.0002.exr");
  EXPECT_TRUE(same_pixels(noisy.image(Aov::direct), passed.image(Aov::direct)));
  EXPECT_TRUE(same_pixels(noisy.light_groups()[1].radiance, passed.light_groups()[1].radiance));
}

TEST_F(Denoise, PassesOnWhatItDoesNotDenoise) {
  std::vector<std::uint32_t> ids(kWidth * kHeight);
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = 0xfff00000u + static_cast<std::uint32_t>(i * 7919);
  write_with_ids(folder_ / "in.0001.exr", ids);
  write_with_ids(folder_ / "in.0002.exr", ids);
  becalm_done(command("out.####.exr", {"--set", "max_history=8", "--quiet"}));

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
  EXPECT_NE(io::read_attribute(folder_ / "out.0002.exr", "becalm:settings").find("max_history=8"),
            std::string::npos);
  EXPECT_NE(io::read_attribute(folder_ / "out.0002.exr", "becalm:version"), "");
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

TEST_F(Denoise, ACleanMatteIsNotMoved) {
  const std::optional<float> kinds[] = {std::nullopt, 0.0f, 1.0f};
  for (const std::optional<float> kind : kinds) {
    for (const int number : {1, 2, 3, 4}) {
      io::write_exr(frame_path(input_, number), matte_frame(number, kind), {});
    }
    EXPECT_NE(becalm_done({"info", input_}).out.find("\nalpha: passed on as it is\n"), std::string::npos);
    for (const char* preset : {"draft", "balanced"}) {
      becalm_done(command("out.####.exr", {"--preset", preset, "--overwrite", "--set", "alpha=1"}));
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
  becalm_done(command("out.####.exr", {"--set", "alpha=1"}));
  EXPECT_EQ(io::read_attribute(folder_ / "passed.0002.exr", "becalm:alpha"), "passed on");
  EXPECT_EQ(io::read_attribute(folder_ / "out.0002.exr", "becalm:alpha").find("denoised in "), 0u);
  const Image after = read_frame(folder_ / "out.0002.exr").image(Aov::beauty);
  for (std::size_t i = 3; i < after.data().size(); i += 4) {
    ASSERT_GE(after.data()[i], 0.0f);
    ASSERT_LE(after.data()[i], 1.0f);
  }
}

std::set<std::string> channels_of(const std::string& path) {
  Imf::InputFile file(path.c_str());
  std::set<std::string> names;
  for (auto it = file.header().channels().begin(); it != file.header().channels().end(); ++it)
    names.insert(it.name());
  return names;
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
  becalm_done(command("all.####.exr"));
  becalm_done(command("beauty.####.exr", {"--only", "beauty"}));
  becalm_done(command("denoised.####.exr", {"--only", "denoised"}));
  becalm_done(command("named.####.exr", {"--channels", "direct,depth.Z"}));
  EXPECT_EQ(channels_of(folder_ / "beauty.0002.exr"), beauty);
  EXPECT_EQ(channels_of(folder_ / "denoised.0002.exr"), denoised);
  EXPECT_EQ(channels_of(folder_ / "named.0002.exr"),
            (std::set<std::string>{"depth.Z", "direct.B", "direct.G", "direct.R"}));
  EXPECT_TRUE(same_frame("all.0002.exr", "beauty.0002.exr"));
  expect_error(becalm(command("none.####.exr", {"--channels", "beauty,nothing"})), 2, {"--channels nothing"});
  EXPECT_EQ(files_in(folder_.path()).size(), 10u) << "nothing was written";
}

TEST_F(Denoise, HalvesBesideEachOtherAreOneSequence) {
  for (const int number : {1, 2, 3}) {
    const Frame a = noise_frame(number);
    const Frame b = noise_frame(number + 10);
    io::write_exr(frame_path(folder_ / "shot.b0.####.exr", number), a, {}, io::PixelType::float32);
    io::write_exr(frame_path(folder_ / "shot.b1.####.exr", number), b, {}, io::PixelType::float32);
    Frame whole = noise_frame(number);
    for (const Aov aov : {Aov::beauty, Aov::albedo}) {
      for (std::size_t i = 0; i < whole.image(aov).data().size(); ++i) {
        whole.image(aov).data()[i] = 0.5f * a.image(aov).data()[i] + 0.5f * b.image(aov).data()[i];
      }
    }
    for (const auto& [half, from] : {std::pair{Aov::half_a, &a}, {Aov::half_b, &b}}) {
      Image& radiance = whole.add(half);
      for (std::size_t i = 0; i < radiance.data().size(); ++i) {
        radiance.data()[i] = from->image(Aov::beauty).data()[i / 3 * 4 + i % 3];
      }
    }
    io::write_exr(frame_path(input_, number), whole, {}, io::PixelType::float32);
  }
  becalm_done(command("whole.####.exr"));
  const std::string first = folder_ / "shot.b0.####.exr";
  const std::string second = folder_ / "shot.b1.####.exr";
  EXPECT_NE(becalm_done({"denoise", first, "-o", folder_ / "found.####.exr"})
                .err.find("a half of the samples each"),
            std::string::npos);
  becalm_done({"denoise", first, second, "-o", folder_ / "given.####.exr"});
  for (const char* name : {"found.####.exr", "given.####.exr"}) {
    expect_same_beauty(folder_ / "whole.####.exr", folder_ / name, 1, 3);
  }
  EXPECT_NE(becalm_done({"info", first}).out.find("is the other half of the samples"), std::string::npos);
  fs::remove(frame_path(second, 2));
  expect_error(becalm({"denoise", first, "-o", folder_ / "gap.####.exr"}), 3, {"shot.b1.0002.exr"});
}

const Imath::Box2i kDisplay(Imath::V2i(0, 0), Imath::V2i(kWidth - 1, kHeight - 1));

/// Both eyes' beauty and albedo in one part, as OpenEXR names them.
void write_stereo(const std::string& path, const Frame& left, const Frame& right,
                  const Imath::Box2i& data_window = kDisplay) {
  Imf::Header header(kDisplay, data_window);
  Imf::addMultiView(header, {"left", "right"});
  Imf::FrameBuffer buffer;
  for (const Frame* eye : {&left, &right}) {
    for (const Aov aov : {Aov::beauty, Aov::albedo}) {
      const Image& image = eye->image(aov);
      for (int c = 0; c < image.channels(); ++c) {
        const std::string name =
            std::string(aov == Aov::albedo ? "albedo." : "") + (eye == &right ? "right." : "") + "RGBA"[c];
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        char* first = const_cast<char*>(reinterpret_cast<const char*>(image.data().data() + c));
        const std::size_t stride = sizeof(float) * static_cast<std::size_t>(image.channels());
        buffer.insert(name, Imf::Slice(Imf::FLOAT, first, stride, stride * kWidth));
      }
    }
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(data_window.max.y - data_window.min.y + 1);
}

TEST_F(Denoise, DataWindowsOfBothEyesMayMove) {
  const Imath::Box2i object(Imath::V2i(8, 5), Imath::V2i(38, 26));
  const std::vector<Imath::Box2i> windows{{{2, 3}, {40, 28}}, {{4, 3}, {42, 30}}, {{6, 1}, {44, 28}}};
  for (int number = 1; number <= 3; ++number) {
    Frame left = noise_frame(number);
    Frame right = noise_frame(number + 10);
    for (Frame* eye : {&left, &right}) {
      for (const Aov aov : {Aov::beauty, Aov::albedo}) {
        for (int y = 0; y < kHeight; ++y) {
          for (int x = 0; x < kWidth; ++x) {
            // As where nothing is hit.
            const float outside = aov == Aov::albedo ? 1.0f : 0.0f;
            if (!object.intersects(Imath::V2i(x, y))) std::ranges::fill(eye->image(aov).pixel(x, y), outside);
          }
        }
      }
    }
    const Imath::Box2i& window = windows[static_cast<std::size_t>(number - 1)];
    write_stereo(frame_path(input_, number), left, right, window);
    write_stereo(frame_path(folder_ / "padded.####.exr", number), left, right);
  }
  becalm_done(command("out.####.exr"));
  becalm_done({"denoise", folder_ / "padded.####.exr", "-o", folder_ / "whole.####.exr", "--quiet"});
  for (int number = 1; number <= 3; ++number) {
    const Imath::Box2i& window = windows[static_cast<std::size_t>(number - 1)];
    const std::string out = frame_path(folder_ / "out.####.exr", number);
    EXPECT_EQ(Imf::InputFile(out.c_str()).header().dataWindow(), window);
    const io::LoadedFrame cropped = io::read_exr(out, number, {});
    const io::LoadedFrame whole = io::read_exr(frame_path(folder_ / "whole.####.exr", number), number, {});
    ASSERT_EQ(cropped.other_views.size(), 1u);
    const auto expect_same = [&](const Image& part, const Image& image) {
      for (int y = window.min.y; y <= window.max.y; ++y) {
        for (int x = window.min.x; x <= window.max.x; ++x) {
          for (int c = 0; c < 4; ++c) {
            ASSERT_EQ(part.at(x - window.min.x, y - window.min.y, c), image.at(x, y, c)) << x << ", " << y;
          }
        }
      }
    };
    expect_same(cropped.frame.image(Aov::beauty), whole.frame.image(Aov::beauty));
    expect_same(cropped.other_views[0].frame.image(Aov::beauty),
                whole.other_views[0].frame.image(Aov::beauty));
  }
}

TEST_F(Denoise, BothEyesAreDenoisedWithTheirOwnLayers) {
  for (const int number : {1, 2, 3}) {
    Frame left = noise_frame(number);
    Frame right = noise_frame(number + 10);
    for (Frame* eye : {&left, &right}) eye->remove(Aov::normal);
    write_stereo(frame_path(input_, number), left, right);
    io::write_exr(frame_path(folder_ / "left.####.exr", number), left, {}, io::PixelType::float32);
    io::write_exr(frame_path(folder_ / "right.####.exr", number), right, {}, io::PixelType::float32);
  }
  const std::string plan = becalm_done(command("out.####.exr", {"--dry-run"})).out;
  EXPECT_NE(plan.find("right: beauty=right.R"), std::string::npos) << plan;
  becalm_done(command("out.####.exr"));
  for (const std::string eye : {"left", "right"}) {
    becalm_done({"denoise", folder_ / (eye + ".####.exr"), "-o", folder_ / (eye + ".calm.####.exr")});
  }
  const io::LoadedFrame both = io::read_exr(folder_ / "out.0002.exr", 2, {});
  ASSERT_EQ(both.other_views.size(), 1u);
  EXPECT_TRUE(same_pixels(both.frame.image(Aov::beauty),
                          read_frame(folder_ / "left.calm.0002.exr").image(Aov::beauty)));
  EXPECT_TRUE(same_pixels(both.other_views[0].frame.image(Aov::beauty),
                          read_frame(folder_ / "right.calm.0002.exr").image(Aov::beauty)));
  EXPECT_NE(io::read_attribute(folder_ / "out.0002.exr", "becalm:layers").find("right: beauty=right.R"),
            std::string::npos);
}

/// A beauty and two layers that share it out, as Arnold names them.
void write_lobes(const std::string& path, const Frame& frame) {
  Imf::Header header(kWidth, kHeight);
  Imf::FrameBuffer buffer;
  const std::map<std::string, float> shares{{"", 1.0f}, {"diffuse.", 0.25f}, {"specular.", 0.75f}};
  std::map<std::string, std::vector<float>> layers;
  for (const auto& [layer, share] : shares) {
    std::vector<float>& pixels = layers[layer];
    for (const float value : frame.image(Aov::beauty).data()) pixels.push_back(share * value);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::string name = layer + "RGB"[c];
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      buffer.insert(name,
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data() + c), 16, 16 * kWidth));
    }
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(kHeight);
}

TEST_F(Denoise, LayersThatAddUpToTheBeautyStillDo) {
  for (const int number : {1, 2}) write_lobes(frame_path(input_, number), noise_frame(number));
  const std::string said = "diffuse, specular add up to the beauty and are denoised with it";
  EXPECT_NE(becalm_done({"info", input_}).out.find(said), std::string::npos);
  const std::string json = becalm_done({"info", input_, "--json"}).out;
  EXPECT_NE(json.find("\"adds_up\": true"), std::string::npos) << json;
  const std::string plan = becalm_done(command("out.####.exr", {"--dry-run"})).out;
  EXPECT_NE(plan.find(said), std::string::npos) << plan;
  becalm_done(command("out.####.exr", {"--preset", "draft"}));
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
  fast.insert(fast.end(), {"--preset", "draft"});
  becalm_done(command("out.####.exr", fast));
  EXPECT_NE(io::read_attribute(folder_ / "out.0002.exr", "becalm:settings")
                .find(" layers=albedo=none motion=flip-x,scale=0.5"),
            std::string::npos);
  expect_error(becalm(command("out.####.exr", {"--motion", "flip"})), 2, {"motion 'flip'", "flip-x"});
}

TEST_F(Denoise, WritesEveryFrameOnDiskAndTellsOfGaps) {
  write_frames({1, 2, 5});
  const Outcome outcome = becalm_done(command("out/a.####.exr"));
  EXPECT_EQ(files_in(folder_.path() / "out"),
            (std::vector<std::string>{"a.0001.exr", "a.0002.exr", "a.0005.exr"}));
  EXPECT_NE(outcome.err.find("only frames 1,2,5 are on disk"), std::string::npos) << outcome.err;
}

TEST_F(Denoise, MissingSkipStartsAnewAfterTheGap) {
  write_frames({1, 2, 4});
  becalm_done(
      command("skip.####.exr", {"--frames", "1-4", "--missing", "skip", "--quiet", "--set", "smooth=none"}));
  EXPECT_FALSE(fs::exists(folder_ / "skip.0003.exr"));
  EXPECT_TRUE(same_frame("skip.0004.exr", "in.0004.exr")) << "without history the frame stays as it is";
}

TEST_F(Denoise, MissingHoldWritesOneOutputForEachInput) {
  write_frames({1, 2, 5});
  const Outcome outcome = becalm_done(command("hold.####.exr", {"--frames", "1-6", "--missing", "hold"}));
  EXPECT_NE(outcome.err.find("6 frames written"), std::string::npos) << outcome.err;
  EXPECT_TRUE(same_frame("hold.0003.exr", "hold.0002.exr"));
  EXPECT_TRUE(same_frame("hold.0004.exr", "hold.0002.exr"));
  EXPECT_TRUE(same_frame("hold.0006.exr", "hold.0005.exr"));
  EXPECT_EQ(io::read_attribute(folder_ / "hold.0003.exr", "becalm:held_from"), "2");
  EXPECT_EQ(io::read_attribute(folder_ / "hold.0002.exr", "becalm:held_from"), "");
  expect_error(becalm(command("b.####.exr", {"--frames", "0-2", "--missing", "hold"})), 3,
               {"frame 0", "hold"});
}

TEST_F(Denoise, ResumeGivesTheSamePixels) {
  write_frames({1, 2, 3, 4});
  becalm_done(command("whole.####.exr"));
  becalm_done(command("a.####.exr"));
  fs::remove(folder_ / "a.0002.exr");
  fs::remove(folder_ / "a.0003.exr");
  const auto first = fs::last_write_time(folder_ / "a.0001.exr");
  becalm_done(command("a.####.exr", {"--resume"}));
  EXPECT_EQ(fs::last_write_time(folder_ / "a.0001.exr"), first);
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 4);
  const Outcome again = becalm_done(command("a.####.exr", {"--resume"}));
  EXPECT_NE(again.err.find("all 4 frames are there"), std::string::npos) << again.err;

  becalm_done({"denoise", folder_ / "in.0001.exr", "-o", folder_ / "draft.exr", "--preset", "draft"});
  expect_error(becalm({"denoise", folder_ / "in.0001.exr", "-o", folder_ / "draft.exr", "--preset", "draft",
                       "--segment", "8", "--resume"}),
               2, {"draft.exr", "no segment, and this run has segment=8"});
  expect_error(becalm(command("a.####.exr", {"--resume", "--set", "patch_radius=5"})), 2,
               {"a.0001.exr", "patch_radius=5"});
  // The same frames are read for them, and the same pixels come out.
  becalm_done(command("a.####.exr", {"--resume", "--frames", "2-4"}));
  expect_error(becalm(command("a.####.exr", {"--resume", "--frames", "2-4", "--context", "none"})), 2,
               {"a.0002.exr", "context=2-4"});
}

TEST_F(Denoise, ResumeMakesAgainWhatWasMadeFromOtherFrames) {
  write_frames({1, 2, 3, 4});
  const std::vector<std::string> options{"--segment", "2", "--warmup", "0", "--resume", "--frames", "1-4"};
  const std::string out = folder_ / "a.####.exr";
  const auto times = [&] {
    std::vector<fs::file_time_type> times;
    for (const int frame : {1, 2, 3, 4}) times.push_back(fs::last_write_time(frame_path(out, frame)));
    return times;
  };
  becalm_done(command("a.####.exr", options));
  EXPECT_EQ(io::read_attribute(frame_path(out, 3), "becalm:inputs").substr(0, 4), "2,3 ");
  EXPECT_EQ(io::read_attribute(frame_path(out, 3), "becalm:layers"),
            "beauty=R,G,B,A albedo=albedo.R,albedo.G,albedo.B normal=normal.X,normal.Y,normal.Z");
  const auto before = times();

  fs::last_write_time(frame_path(input_, 1), fs::file_time_type::clock::now());
  becalm_done(command("a.####.exr", options));
  EXPECT_EQ(times(), before) << "the content counts, not the time";

  io::write_exr(frame_path(input_, 3), noise_frame(33), {}, io::PixelType::float32);
  const Outcome changed = becalm_done(command("a.####.exr", options));
  EXPECT_NE(changed.err.find("2 frames are made again"), std::string::npos) << changed.err;
  EXPECT_NE(changed.err.find("have changed: 2,3\n"), std::string::npos) << changed.err;
  const auto after = times();
  for (const std::size_t kept : {0, 3}) EXPECT_EQ(after[kept], before[kept]);
  becalm_done(command("fresh.####.exr", options));
  expect_same_beauty(folder_ / "fresh.####.exr", out, 1, 4);

  io::write_exr(frame_path(input_, 5), noise_frame(5), {}, io::PixelType::float32);
  const Outcome neighbour = becalm_done(command("a.####.exr", options));
  EXPECT_NE(neighbour.err.find("1 frame is made again"), std::string::npos) << neighbour.err;
  EXPECT_NE(neighbour.err.find("1 frame written"), std::string::npos) << neighbour.err;

  for (const int frame : {1, 2, 3, 4, 5}) {
    io::write_exr(frame_path(input_, frame), noise_frame(frame, 40, 24), {{"becalm:settings", "spp=9"}});
  }
  const Outcome other_shot = becalm_done(command("a.####.exr", options));
  EXPECT_NE(other_shot.err.find("4 frames are made again"), std::string::npos) << other_shot.err;
  for (const int frame : {1, 2, 3, 4}) EXPECT_EQ(read_frame(frame_path(out, frame)).width(), 40);
}

TEST_F(Denoise, AForwardFilterResumesToTheSamePixels) {
  write_frames({1, 2, 3, 4});
  const std::vector<std::string> draft{"--preset", "draft"};
  becalm_done(command("whole.####.exr", draft));
  becalm_done(command("a.####.exr", draft));
  fs::remove(folder_ / "a.0003.exr");
  const Outcome outcome = becalm_done(command("a.####.exr", {"--preset", "draft", "--resume"}));
  EXPECT_NE(outcome.err.find("frame 2: exists"), std::string::npos) << outcome.err;
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 4);
  // The history would begin elsewhere, and other pixels would come out.
  expect_error(becalm(command("a.####.exr", {"--preset", "draft", "--resume", "--frames", "2-4"})), 2,
               {"a.0002.exr", "first_frame=2"});
}

/// Frames first to last as one job, which must be bit for bit those of `whole`.
TEST_F(Denoise, ResultsDoNotDependOnHowASequenceIsCutIntoJobs) {
  for (int number = 1; number <= 24; ++number) write_frames({number});
  const std::vector<std::string> settings{"--segment", "8", "--warmup", "3", "--quiet"};
  const auto job = [&](const std::string& pattern, const std::string& frames) {
    std::vector<std::string> more = settings;
    if (!frames.empty()) more.insert(more.end(), {"--frames", frames});
    becalm_done(command(pattern, more));
  };
  job("whole.####.exr", "");
  for (const char* frames : {"1-7", "8-15", "16-24"}) job("chunk.####.exr", frames);
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "chunk.####.exr", 1, 24);
  for (const int frame : {1, 7, 8, 13, 24}) {
    job("single.####.exr", std::to_string(frame));
    expect_same_beauty(folder_ / "whole.####.exr", folder_ / "single.####.exr", frame, frame);
    EXPECT_EQ(io::read_attribute(frame_path(folder_ / "single.####.exr", frame), "becalm:settings"),
              io::read_attribute(frame_path(folder_ / "whole.####.exr", frame), "becalm:settings"));
  }
  EXPECT_FALSE(same_frame("whole.0001.exr", "in.0001.exr")) << "frames after the first say nothing about it";
}

TEST_F(Denoise, DefaultSegmentsMakeJobsIndependentToo) {
  for (int number = 1; number <= 96; ++number) {
    io::write_exr(frame_path(input_, number), noise_frame(number, 24, 16), {}, io::PixelType::float32);
  }
  becalm_done(command("whole.####.exr", {"--frames", "1-96", "--quiet"}));
  for (const char* frames : {"1-31", "32-63", "64-96"}) {
    becalm_done(command("chunk.####.exr", {"--frames", frames, "--quiet"}));
  }
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "chunk.####.exr", 1, 96);
}

TEST_F(Denoise, ContextLimitsWhatIsReadBesidesTheFramesThatAreWritten) {
  write_frames({1, 2, 3, 4, 5});
  becalm_done(
      command("none.####.exr", {"--frames", "3", "--context", "none", "--quiet", "--set", "smooth=none"}));
  EXPECT_TRUE(same_frame("none.0003.exr", "in.0003.exr")) << "alone, a frame stays as it is";
  becalm_done(command("some.####.exr", {"--frames", "3", "--context", "2-4", "--quiet"}));
  EXPECT_EQ(files_in(folder_.path()).size(), 7u) << "context is not written";
  fs::remove(folder_ / "in.0001.exr");
  fs::remove(folder_ / "in.0005.exr");
  becalm_done(command("all.####.exr", {"--frames", "3", "--quiet"}));
  EXPECT_TRUE(same_frame("some.0003.exr", "all.0003.exr"));
  expect_error(becalm(command("a.####.exr", {"--context", "some"})), 2, {"some"});
}

TEST_F(Denoise, NothingIsCarriedOverACut) {
  write_frames({1, 2, 3});
  for (const int number : {4, 5}) {
    Frame frame = noise_frame(number);
    for (float& v : frame.image(Aov::albedo).data()) v = 1.0f - v;
    for (float& v : frame.image(Aov::normal).data()) v = -v;
    io::write_exr(frame_path(input_, number), frame, {}, io::PixelType::float32);
  }
  const Outcome found = becalm_done(command("auto.####.exr"));
  EXPECT_NE(found.err.find("frame 4: a new shot begins"), std::string::npos) << found.err;
  EXPECT_EQ(found.err.find("shot"), found.err.rfind("shot")) << found.err;
  becalm_done(command("given.####.exr", {"--cuts", "4", "--quiet"}));
  becalm_done(command("second.####.exr", {"--frames", "4-5", "--context", "none", "--quiet"}));
  becalm_done(command("none.####.exr", {"--cuts", "none", "--quiet"}));
  expect_same_beauty(folder_ / "auto.####.exr", folder_ / "given.####.exr", 1, 5);
  expect_same_beauty(folder_ / "auto.####.exr", folder_ / "second.####.exr", 4, 5);
  EXPECT_FALSE(same_frame("auto.0003.exr", "none.0003.exr"));
}

TEST_F(Denoise, HeldFramesMayComeFromTheContext) {
  write_frames({1, 2, 4});
  becalm_done(command("whole.####.exr", {"--frames", "1-4", "--missing", "hold", "--quiet"}));
  becalm_done(command("chunk.####.exr", {"--frames", "3-4", "--missing", "hold", "--quiet"}));
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "chunk.####.exr", 3, 4);
  EXPECT_FALSE(fs::exists(folder_ / "chunk.0002.exr"));
}

TEST_F(Denoise, WhatIsHeldDoesNotDependOnTheRange) {
  write_frames({1, 2, 4});
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--preset", "draft"}, {"--context", "none"}}) {
    std::vector<std::string> options{"--frames", "3-4", "--missing", "hold", "--quiet"};
    options.insert(options.end(), more.begin(), more.end());
    becalm_done(command("out/a.####.exr", options));
    EXPECT_EQ(files_in(folder_.path() / "out"), (std::vector<std::string>{"a.0003.exr", "a.0004.exr"}));
    EXPECT_EQ(io::read_attribute(folder_ / "out/a.0003.exr", "becalm:held_from"), "2");
  }
}

TEST_F(Denoise, StepsAreNotGaps) {
  write_frames({1, 3, 5});
  const Outcome outcome = becalm_done(command("a.####.exr"));
  EXPECT_EQ(outcome.err.find("on disk"), std::string::npos) << outcome.err;
  EXPECT_FALSE(same_frame("a.0003.exr", "in.0003.exr")) << "the history was dropped";
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

TEST_F(Denoise, ProfileTellsWhereTimeAndMemoryWent) {
  write_frames({1, 2});
  const Outcome outcome = becalm_done(command("a.####.exr", {"--profile", "--quiet"}));
  for (const char* words : {"read", "filter", "write", "device time a frame", "align/", "merge/", "MiB held",
                            "peak resident memory"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << words << "\n" << outcome.err;
  }
}

TEST_F(Denoise, MemoryCutsFramesIntoTilesThatNobodySees) {
  for (const int number : {1, 2, 3}) {
    io::write_exr(frame_path(input_, number), noise_frame(number, 400, 320), {}, io::PixelType::float32);
  }
  // Without smoothing, tiles of frames this small are much smaller than they.
  std::vector<std::string> options{"--profile", "--quiet", "--set", "smooth=none"};
  const Outcome whole = becalm_done(command("whole.####.exr", options));
  EXPECT_NE(whole.err.find("1 tile of 400x320 px"), std::string::npos) << whole.err;
  options.insert(options.end(), {"--memory", "20M"});
  const Outcome tiled = becalm_done(command("tiled.####.exr", options));
  EXPECT_NE(tiled.err.find(" tiles of "), std::string::npos) << tiled.err;
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "tiled.####.exr", 1, 3);
}

TEST_F(Denoise, ImagesOfOnePixelAndWideOnes) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2048, 4}}) {
    for (const int number : {1, 2}) {
      io::write_exr(frame_path(input_, number), noise_frame(number, width, height), {},
                    io::PixelType::float32);
    }
    for (const char* preset : {"draft", "balanced"}) {
      becalm_done(command("out.####.exr", {"--preset", preset, "--quiet"}));
      const Frame frame = read_frame(folder_ / "out.0002.exr");
      ASSERT_EQ(frame.width(), width);
      ASSERT_EQ(frame.height(), height);
      for (const float v : frame.image(Aov::beauty).data()) ASSERT_TRUE(std::isfinite(v)) << preset;
    }
  }
}

TEST_F(Denoise, ASingleFileHasTheNumberOfItsName) {
  write_frames({52});
  const std::string file = folder_ / "in.0052.exr";
  becalm_done({"denoise", file, "-o", folder_ / "out.####.exr", "--quiet"});
  becalm_done({"denoise", file, "-o", folder_ / "short.#.exr", "--quiet"});
  becalm_done({"denoise", file, "-o", folder_ / "other.####.exr", "--quiet", "--frame=-7"});
  fs::rename(file, folder_ / "still.exr");
  const Outcome still = becalm_done({"denoise", folder_ / "still.exr", "-o", folder_ / "still.####.exr"});
  EXPECT_NE(still.err.find("still.exr: no frame number in the name, so this is frame 1; --frame"),
            std::string::npos)
      << still.err;
  EXPECT_EQ(files_in(folder_.path()),
            (std::vector<std::string>{"other.-007.exr", "out.0052.exr", "short.0052.exr", "still.0001.exr",
                                      "still.exr"}));
  write_frames({1, 2});
  expect_error(becalm(command("out.####.exr", {"--frame", "3"})), 2, {"--frame 3", "--frames"});
}

TEST_F(Denoise, ALoneHashOfTheOutputHasThePaddingOfTheInput) {
  write_frames({1, 2});
  becalm_done(command("out/a.#.exr", {"--quiet"}));
  EXPECT_EQ(files_in(folder_.path() / "out"), (std::vector<std::string>{"a.0001.exr", "a.0002.exr"}));
}

TEST_F(Denoise, FilesOfAnotherPaddingArePointedOut) {
  io::write_exr(folder_ / "in.1.exr", noise_frame(1), {});
  expect_error(becalm(command("out.####.exr")), 3, {"no frame", "in.1.exr is there", "in.#.exr"});
  write_frames({2});
  expect_error(becalm(command("out.####.exr", {"--frames", "1-2"})), 3, {"frame 1 of", "in.#.exr"});
}

TEST_F(Denoise, FilesThatBecalmDidNotWriteAreNotReplacedUnlessAsked) {
  write_frames({1});
  io::write_exr(folder_ / "out.0001.exr", noise_frame(9), {});
  expect_error(becalm(command("out.####.exr")), 2, {"out.0001.exr", "--overwrite"});
  EXPECT_EQ(io::read_attribute(folder_ / "out.0001.exr", "becalm:version"), "");
  becalm_done(command("out.####.exr", {"--overwrite", "--quiet"}));
  becalm_done(command("out.####.exr", {"-q"}));
}

TEST_F(Denoise, ProgressAsJson) {
  write_frames({1, 2});
  const Outcome outcome = becalm_done(command("out.####.exr", {"--progress", "json", "-v", "--profile"}));
  std::istringstream lines(outcome.err);
  std::vector<int> frames;
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json event = nlohmann::json::parse(line, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(event.is_object()) << line;
    last = event.at("event");
    if (last != "frame") continue;
    frames.push_back(event.at("frame"));
    EXPECT_EQ(event.at("state"), "written");
    EXPECT_EQ(event.at("total"), 2);
  }
  EXPECT_EQ(frames, (std::vector<int>{1, 2}));
  EXPECT_NE(outcome.err.find(R"({"event":"end","written":2,"done":2,"total":2)"), std::string::npos)
      << outcome.err;
  const Outcome failed = becalm(command("out.png", {"--progress", "json"}));
  EXPECT_EQ(failed.status, 2);
  EXPECT_EQ(failed.err.rfind(R"({"event":"error","status":2,"text":"-o )", 0), 0u) << failed.err;
}

TEST_F(Denoise, VerboseTellsLayersDeviceAndFiles) {
  write_frames({1});
  const Outcome outcome = becalm_done(command("out.####.exr", {"-v"}));
  for (const std::string& words :
       {std::string("48x32 px of beauty=R,G,B,A albedo=albedo.R"), std::string("device "),
        "reading " + folder_ / "in.0001.exr", "wrote " + folder_ / "out.0001.exr"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << words << "\n" << outcome.err;
  }
}

TEST_F(Denoise, ADryRunTellsWhatWouldBeReadAndWrittenAndWritesNothing) {
  write_frames({1, 2, 3});
  const Outcome outcome =
      becalm_done(command("out/a.####.exr", {"--dry-run", "--frames", "2-3", "--type", "half"}));
  EXPECT_EQ(outcome.err, "");
  for (const std::string& words :
       {"reads " + input_ + ": 3 frames, 1-3\n", std::string("takes 48x32 px of beauty=R,G,B,A albedo="),
        std::string("filters with preset balanced: "), std::string(" type=half\n"),
        "writes " + folder_ / "out/a.####.exr" + ": 2 frames, 2,3\n"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
  }
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  fs::remove(folder_ / "in.0002.exr");
  EXPECT_EQ(becalm(command("out/a.####.exr", {"--dry-run", "--frames", "2-3"})).status, 3);
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

TEST_F(Denoise, DataWindowsMayMove) {
  const Imath::Box2i& display = kDisplay;
  const Imath::Box2i object(Imath::V2i(8, 5), Imath::V2i(38, 26));
  const std::vector<Imath::Box2i> windows{{{2, 3}, {40, 28}}, {{4, 3}, {42, 30}}, {{6, 1}, {44, 28}}};
  for (int number = 1; number <= 3; ++number) {
    const Imath::Box2i& window = windows[static_cast<std::size_t>(number - 1)];
    write_window(frame_path(input_, number), number, window, display, object);
    write_window(frame_path(folder_ / "padded.####.exr", number), number, display, display, object);
  }
  const Outcome outcome = becalm_done(command("out.####.exr"));
  EXPECT_EQ(outcome.err.find("shot"), std::string::npos) << "a window that moves is no cut: " << outcome.err;
  becalm_done({"denoise", folder_ / "padded.####.exr", "-o", folder_ / "whole.####.exr", "--quiet"});
  for (int number = 1; number <= 3; ++number) {
    const Imath::Box2i& window = windows[static_cast<std::size_t>(number - 1)];
    const std::string out = frame_path(folder_ / "out.####.exr", number);
    const Imf::InputFile file(out.c_str());
    EXPECT_EQ(file.header().dataWindow(), window);
    EXPECT_EQ(file.header().displayWindow(), display);
    const Frame cropped = read_frame(out);
    const Frame whole = read_frame(frame_path(folder_ / "whole.####.exr", number));
    for (int y = window.min.y; y <= window.max.y; ++y) {
      for (int x = window.min.x; x <= window.max.x; ++x) {
        for (int c = 0; c < 4; ++c) {
          ASSERT_EQ(cropped.image(Aov::beauty).at(x - window.min.x, y - window.min.y, c),
                    whole.image(Aov::beauty).at(x, y, c))
              << number << ": " << x << ", " << y;
        }
      }
    }
  }
}

TEST_F(Denoise, OneFile) {
  write_frames({7});
  const Outcome outcome = becalm_done({"denoise", folder_ / "in.0007.exr", "-o", folder_ / "one.exr"});
  EXPECT_NE(outcome.err.find("\n1 frame written in"), std::string::npos) << outcome.err;
  EXPECT_FALSE(same_frame("one.exr", "in.0007.exr")) << "a frame alone is smoothed";
  becalm_done(
      {"denoise", folder_ / "in.0007.exr", "-o", folder_ / "one.exr", "--quiet", "--set", "smooth=none"});
  EXPECT_TRUE(same_frame("one.exr", "in.0007.exr")) << "and otherwise stays as it is";
}

}  // namespace
}  // namespace becalm::test
