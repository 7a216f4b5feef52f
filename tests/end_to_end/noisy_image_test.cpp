// becalm denoise: of what the renderer has denoised itself, the noisy image is denoised.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "tests/end_to_end/denoise_fixture.h"

namespace becalm::test {
namespace {

TEST_F(Denoise, WhatTheRendererDenoisedIsNotDenoisedAgain) {
  struct Names {
    std::string denoised;  // for --layers
    std::string denoised_channels;
    std::string noisy;
  };
  for (const Names& of : {Names{"V.Combined", "V.Combined.", "V.Noisy Image"},
                          {"Beauty", "Beauty.", "Beauty_Noisy"},
                          {"RGBA", "", "Beauty_Noisy"}}) {
    SCOPED_TRACE(of.denoised);
    const auto denoise = [&](float noisy, float denoised, const std::vector<std::string>& more) {
      for (const int number : {1, 2}) {
        Frame frame = noise_frame(number);
        frame.image(Aov::beauty).at(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
        const float shown = number == 1 ? 0.0f : 1.0f;
        write_shares(frame_path(input_, number), frame,
                     {{of.denoised_channels, shown * denoised}, {of.noisy + '.', shown * noisy}});
      }
      std::vector<std::string> options{"--overwrite"};
      options.insert(options.end(), more.begin(), more.end());
      return becalm_done(command("out.####.exr", options)).err;
    };
    const auto is_changed = [&](const std::string& layer) {
      const auto beauty = [&](const std::string& path) {
        return io::read_exr(path, 2, {}, {.layers = {{Aov::beauty, layer}}}).frame.image(Aov::beauty);
      };
      return !same_pixels(beauty(frame_path(input_, 2)), beauty(folder_ / "out.0002.exr"));
    };
    const std::string told = of.denoised + " is denoised already and passed on: " + of.noisy;
    // The first frame is black and decides nothing.
    EXPECT_NE(denoise(1.0f, 0.5f, {"-q"}).find(told), std::string::npos);
    EXPECT_TRUE(is_changed(of.noisy));
    EXPECT_FALSE(is_changed(of.denoised));
    EXPECT_NE(becalm_done({"info", input_}).out.find(told), std::string::npos);

    EXPECT_EQ(denoise(1.0f, 1.0f, {}).find(told), std::string::npos) << "both are noisy";
    EXPECT_FALSE(is_changed(of.noisy));
    EXPECT_TRUE(is_changed(of.denoised));

    EXPECT_EQ(denoise(1.0f, 0.5f, {"--layers", "beauty=" + of.denoised}).find(told), std::string::npos);
    EXPECT_TRUE(is_changed(of.denoised));
  }
}

TEST_F(Denoise, WhatTheRendererDenoisedOfTwoEyesIsNotDenoisedAgain) {
  std::map<std::string, float> shares;
  for (const std::string eye : {"left", "right"}) {
    shares["V.Combined." + eye + '.'] = 0.5f;
    shares["V.Noisy Image." + eye + '.'] = eye == "left" ? 1.0f : 0.9f;
  }
  const std::vector<std::string> views{"left", "right"};
  write_shares(frame_path(input_, 1), noise_frame(1), shares, views);
  const Outcome outcome = becalm_done(command("out.####.exr"));
  EXPECT_NE(outcome.err.find("V.Noisy Image is the beauty"), std::string::npos) << outcome.err;
  for (const auto& [layer, is_kept] : {std::pair{"V.Combined", true}, {"V.Noisy Image", false}}) {
    const auto read = [&, layer = layer](const std::string& path) {
      return io::read_exr(path, 1, {}, {.layers = {{Aov::beauty, layer}}});
    };
    const io::LoadedFrame in = read(frame_path(input_, 1)), out = read(folder_ / "out.0001.exr");
    const Frame &in_right = in.other_views.at(0).frame, &out_right = out.other_views.at(0).frame;
    EXPECT_EQ(same_pixels(in.frame.image(Aov::beauty), out.frame.image(Aov::beauty)), is_kept) << layer;
    EXPECT_EQ(same_pixels(in_right.image(Aov::beauty), out_right.image(Aov::beauty)), is_kept) << layer;
  }
}

TEST_F(Denoise, ANoisyImageIsComparedInItsPlace) {
  for (const int number : {1, 2}) {
    Frame frame = noise_frame(number);
    std::vector<Imf::Header> headers;
    for (const char* name : {"V.Combined", "V.Noisy Image"}) {
      Imf::Header& header = headers.emplace_back(kWidth, kHeight);
      header.setName(name);
      header.setType(Imf::SCANLINEIMAGE);
      for (const char* letter : {"R", "G", "B"}) header.channels().insert(letter, Imf::Channel(Imf::FLOAT));
    }
    headers[1].dataWindow().min.x = 1;  // the same pixels but for the first column
    Imf::MultiPartOutputFile file(frame_path(input_, number).c_str(), headers.data(), 2);
    char* const pixels = reinterpret_cast<char*>(frame.image(Aov::beauty).data().data());
    for (int part = 0; part < 2; ++part) {
      Imf::FrameBuffer buffer;
      for (int c = 0; c < 3; ++c) {
        buffer.insert(std::string(1, "RGB"[c]),
                      Imf::Slice(Imf::FLOAT, pixels + 4 * c, 16, std::size_t{16} * kWidth));
      }
      Imf::OutputPart out(file, part);
      out.setFrameBuffer(buffer);
      out.writePixels(kHeight);
    }
  }
  const std::string told = becalm_done(command("out.####.exr", {"--preset", "draft"})).err;
  EXPECT_EQ(told.find("denoised already"), std::string::npos) << told;
}

}  // namespace
}  // namespace becalm::test
