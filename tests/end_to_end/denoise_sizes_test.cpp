// becalm denoise: data windows, images of one pixel and wide ones, tiles, and both eyes of a stereo pair.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/end_to_end/denoise_fixture.h"

namespace becalm::test {
namespace {

const Imath::Box2i kDisplay(Imath::V2i(0, 0), Imath::V2i(kWidth - 1, kHeight - 1));

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

/// R, G and B of one value.
void write_even(const std::string& path, float value, const Imath::Box2i& data_window,
                const Imath::Box2i& display_window = kDisplay) {
  const Imath::V2i size = data_window.size() + Imath::V2i(1);
  std::vector<float> values(static_cast<std::size_t>(size.x) * size.y, value);
  Imf::Header header(display_window, data_window);
  Imf::FrameBuffer buffer;
  for (const char* name : {"R", "G", "B"}) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), data_window));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(size.y);
}

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

TEST_F(Denoise, WhatLiesBeyondAnOpaqueDataWindowDarkensNothing) {
  const Imath::Box2i overscan(Imath::V2i(-6, -6), Imath::V2i(kWidth + 5, kHeight + 5));
  for (int number = 1; number <= 3; ++number) {
    const Imath::Box2i window = number == 2 ? overscan : kDisplay;
    write_even(frame_path(input_, number), 0.5f, window);
  }
  const Outcome outcome = becalm_done(command("out.####.exr"));
  EXPECT_EQ(outcome.err.find("NaN"), std::string::npos) << outcome.err;
  for (int number = 1; number <= 3; ++number) {
    const Frame result = read_frame(frame_path(folder_ / "out.####.exr", number));
    for (int y = 0; y < result.height(); ++y) {
      for (int x = 0; x < result.width(); ++x)
        ASSERT_NEAR(result.image(Aov::beauty).at(x, y, 0), 0.5f, 1e-3f) << number << ": " << x << ", " << y;
    }
  }
  EXPECT_EQ(becalm_done({"info", input_, "--audit"}).out.find("NaN"), std::string::npos);
}

TEST_F(Denoise, HalvesOfDifferentWindowsAreRefused) {
  write_even(folder_ / "shot.b0.0001.exr", 0.5f, kDisplay);
  write_even(folder_ / "shot.b1.0001.exr", 0.5f, {kDisplay.min, kDisplay.max - Imath::V2i(4)});
  expect_error(becalm({"denoise", folder_ / "shot.b0.####.exr", "-o", folder_ / "out.####.exr"}), 3,
               {"shot.b1.0001.exr", "windows"});
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
  becalm_done(command("out.####.exr", {"--no-stereo"}));
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

TEST_F(Denoise, AStrayDataWindowIsTold) {
  const Imath::Box2i small({3, 4}, {19, 12});
  for (const int stray : {1, 2}) {
    for (int number = 1; number <= 3; ++number) write_even(frame_path(input_, number), 0.5f, small);
    write_even(frame_path(input_, stray), 0.5f, {{200000, 200000}, {200016, 200008}});
    expect_error(becalm(command("out.####.exr", {"--dry-run"})), 3,
                 {frame_path(input_, stray), "data window 17x9 at (200000, 200000)", "display window 48x32",
                  "at most 65536 a side"});
  }
}

TEST_F(Denoise, AntialiasTellsTheLargestFramesThatADeviceTakes) {
  // No device binds 8 bytes for each of so many pixels at once. The files hold few of them.
  const Imath::Box2i huge({0, 0}, {29999, 29999});
  write_even(frame_path(input_, 1), 0.5f, {{0, 0}, {3, 3}}, huge);
  write_even(frame_path(input_, 2), 0.5f, {{1, 0}, {4, 3}}, huge);
  for (const bool dry : {true, false}) {
    std::vector<std::string> words{"antialias", input_, "-o", folder_ / "out.####.exr"};
    if (dry) words.push_back("--dry-run");
    expect_error(
        becalm(words), 4,
        {frame_path(input_, 1), "whole frames, here of 30000x30000 px", "at most", "pixels on device"});
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
  options.insert(options.end(), {"--memory", "11M"});
  const Outcome tiled = becalm_done(command("tiled.####.exr", options));
  EXPECT_NE(tiled.err.find(" tiles of "), std::string::npos) << tiled.err;
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "tiled.####.exr", 1, 3);

  const auto tiles_of = [&](const char* file) { return io::read_attribute(folder_ / file, "becalm:tiles"); };
  EXPECT_EQ(tiles_of("whole.0002.exr"), "1");
  EXPECT_EQ(tiles_of("tiled.0002.exr").find("merge 2x"), 0u) << tiles_of("tiled.0002.exr");
  const std::string info = becalm_done({"info", folder_ / "tiled.0002.exr"}).out;
  EXPECT_NE(info.find("; tiles " + tiles_of("tiled.0002.exr") + "; "), std::string::npos) << info;
  // The results are the same, so that another plan may go on with them.
  fs::remove(folder_ / "whole.0003.exr");
  options.insert(options.end(), {"--resume", "-v"});
  std::erase(options, "--quiet");
  const Outcome resumed = becalm_done(command("whole.####.exr", options));
  EXPECT_NE(resumed.err.find("tiles merge 2x"), std::string::npos) << resumed.err;
  EXPECT_NE(resumed.err.find("2 were there already"), std::string::npos) << resumed.err;
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "tiled.####.exr", 3, 3);
}

TEST_F(Denoise, AnAuditComparesWhatLiesInOnePlace) {
  // The same picture in every frame: only its crop moves.
  for (int number = 1; number <= 3; ++number) {
    write_window(frame_path(input_, number), 5, {{2 + 2 * number, 3}, {30 + 2 * number, 28}}, kDisplay,
                 {{10, 5}, {28, 26}});
  }
  const std::string told = becalm_done({"info", input_, "--audit"}).out;
  EXPECT_NE(told.find("duplicate"), std::string::npos) << told;
}

}  // namespace
}  // namespace becalm::test
