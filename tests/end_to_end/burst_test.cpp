// becalm burst: from DNG files to pictures and mosaics, and what it refuses.

#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "frame/raw/dng.h"
#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

CfaPattern x_trans() {
  CfaPattern cfa{.period = 6, .colors = {}};
  const std::string_view letters = "GRGGBGBGBRGRGRGGBGGBGGRGRGRBGBGBGGRG";
  for (std::size_t i = 0; i < letters.size(); ++i)
    cfa.colors[i] = letters[i] == 'R' ? 0 : letters[i] == 'G' ? 1 : 2;
  return cfa;
}

raw::Info camera(const CfaPattern& cfa = {}, int width = 64, int height = 48) {
  raw::Info info;
  info.make = "becalm";
  info.model = "camera";
  info.width = width;
  info.height = height;
  info.cfa = cfa;
  info.shutter_s = 1.0 / 60.0;
  info.iso = 800;
  info.f_number = 4.0;
  info.white_balance = {2.0f, 1.0f, 1.5f};
  // Rec. 709's own colours.
  info.xyz_to_camera = {1.6202f, -0.7686f, -0.2493f, -0.9693f, 1.8760f, 0.0416f, 0.0371f, -0.1360f, 0.7048f};
  return info;
}

/// A grey ramp under white light, `exposure` times as bright, that moves by a pixel a frame.
Mosaic grey(const raw::Info& info, int number, double exposure = 1.0) {
  std::mt19937 random(static_cast<unsigned>(number));
  std::normal_distribution<double> normal;
  Mosaic mosaic{Image(info.width, info.height, 1), info.cfa};
  for (int y = 0; y < info.height; ++y) {
    for (int x = 0; x < info.width; ++x) {
      const double light = 0.2 + 0.1 * std::sin(0.2 * (x + number)) * std::cos(0.25 * y);
      const double value = exposure * light / info.white_balance[info.cfa.color(x, y)];
      mosaic.samples.at(x, y, 0) = static_cast<float>(value + 0.01 * normal(random));
    }
  }
  return mosaic;
}

class Burst : public testing::Test {
 protected:
  std::string write(int number, const raw::Info& info, double exposure = 1.0) const {
    std::string path = folder_ / ("in" + std::to_string(number) + ".dng");
    raw::write_dng(path, grey(info, number, exposure), info);
    return path;
  }
  std::vector<std::string> write_burst(const raw::Info& info = camera()) const {
    return {write(1, info), write(2, info), write(3, info)};
  }
  static std::vector<std::string> command(std::vector<std::string> inputs, const std::string& output,
                                          const std::vector<std::string>& more = {}) {
    inputs.insert(inputs.begin(), "burst");
    inputs.insert(inputs.end(), {"-o", output});
    inputs.insert(inputs.end(), more.begin(), more.end());
    return inputs;
  }

  TempFolder folder_;
};

/// RMSE of the first channel against the scene of `grey`, 8 px from the border.
double error_of(const Image& image, int number) {
  double sum = 0.0, count = 0.0;
  for (int y = 8; y < image.height() - 8; ++y) {
    for (int x = 8; x < image.width() - 8; ++x, ++count) {
      const double light = 0.2 + 0.1 * std::sin(0.2 * (x + number)) * std::cos(0.25 * y);
      sum += (image.at(x, y, 1) - light) * (image.at(x, y, 1) - light);
    }
  }
  return std::sqrt(sum / count);
}

TEST_F(Burst, SpeaksToFarmManagers) {
  const Outcome outcome = becalm_done(command(write_burst(), folder_ / "out.exr", {"--progress", "json"}));
  std::istringstream lines(outcome.err);
  nlohmann::json event;
  for (std::string line; std::getline(lines, line);) {
    event = nlohmann::json::parse(line, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(event.is_object()) << line;
  }
  EXPECT_EQ(event.at("event"), "end");
  EXPECT_EQ(event.at("written"), 1);
}

TEST_F(Burst, WritesADemosaicedPicture) {
  for (const CfaPattern& cfa : {CfaPattern{}, x_trans()}) {
    const auto inputs = write_burst(camera(cfa));
    const std::string output = folder_ / "out.exr";
    const Outcome outcome = becalm_done(command(inputs, output, {"--reference", "2", "--validate"}));
    EXPECT_NE(outcome.err.find("ISO 800"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("(fitted)"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("3 of 3"), std::string::npos) << outcome.err;
    const Image picture = read_frame(output).image(Aov::beauty);
    ASSERT_EQ(picture.width(), 64);
    ASSERT_EQ(picture.height(), 48);
    EXPECT_LT(error_of(picture, 2), 0.008) << "less than a single frame's noise";
    double red = 0.0, green = 0.0, blue = 0.0;
    for (int i = 0; i < 64 * 48; ++i) {
      red += picture.data()[picture.channels() * i];
      green += picture.data()[picture.channels() * i + 1];
      blue += picture.data()[picture.channels() * i + 2];
    }
    EXPECT_NEAR(red / green, 1.0, 0.01) << "grey under white light is grey";
    EXPECT_NEAR(blue / green, 1.0, 0.01);
    EXPECT_EQ(io::read_attribute(output, "becalm:burst").find("frames=3 reference=2"), 0u);
  }
}

TEST_F(Burst, WritesMosaics) {
  const auto inputs = write_burst();
  const std::string exr = folder_ / "out.exr", dng = folder_ / "out.dng";
  becalm_done(command(inputs, exr, {"--mosaic", "--reference", "first", "-q"}));
  EXPECT_EQ(io::read_attribute(exr, "becalm:mosaic"), "2x2 RGGB");
  becalm_done(command(inputs, dng, {"--reference", "first", "-q"}));
  const auto file = raw::open(dng);
  EXPECT_EQ(file->info().width, 64);
  EXPECT_NEAR(file->info().white_balance[0], 2.0f, 1e-3f);
  const Mosaic merged = raw::read(*file, dng);
  const Mosaic first = grey(camera(), 1);
  double difference = 0.0;
  for (std::size_t i = 0; i < first.samples.pixel_count(); ++i)
    difference += std::abs(merged.samples.data()[i] - first.samples.data()[i]);
  EXPECT_LT(difference / (64 * 48), 0.01) << "is the first frame, but for noise";
  EXPECT_GT(difference / (64 * 48), 0.002);
}

TEST_F(Burst, TurnsPicturesUpright) {
  raw::Info info = camera();
  info.flip = 6;
  const std::string output = folder_ / "out.exr";
  becalm_done(command(write_burst(info), output, {"-q"}));
  const Frame frame = read_frame(output);
  EXPECT_EQ(frame.width(), 48);
  EXPECT_EQ(frame.height(), 64);
}

TEST_F(Burst, ScalesOtherExposures) {
  raw::Info longer = camera();
  longer.shutter_s = 1.0 / 30.0;
  const std::string output = folder_ / "out.exr";
  const Outcome outcome =
      becalm_done(command({write(1, camera()), write(2, longer, 2.0)}, output, {"--reference", "first"}));
  EXPECT_NE(outcome.err.find("scaled to the reference's"), std::string::npos) << outcome.err;
  EXPECT_LT(error_of(read_frame(output).image(Aov::beauty), 1), 0.01);
}

TEST_F(Burst, TakesTheNoiseThatItIsTold) {
  raw::Info info = camera();
  info.noise = NoiseModel{.a = 1e-4, .b = 1e-4};
  const auto inputs = write_burst(info);
  const std::string output = folder_ / "out.exr";
  const Outcome told = becalm_done(command(inputs, output));
  EXPECT_NE(told.err.find("1.000e-04,1.000e-04 (as the file tells)"), std::string::npos) << told.err;
  const Outcome given = becalm_done(command(inputs, output, {"--noise", "2e-4,3e-5"}));
  EXPECT_NE(given.err.find("2.000e-04,3.000e-05 (as given)"), std::string::npos) << given.err;
}

TEST_F(Burst, ADarkFrameIsNoReferenceForItsNoise) {
  for (int first = 1; first <= 9; first += 4) {
    std::vector<std::string> inputs;
    for (int i = 0; i < 4; ++i) {
      raw::Info info = camera({}, 192, 144);
      const bool dark = i == 3;
      if (dark) info.shutter_s /= 4.0;
      Mosaic mosaic = grey(info, first + i, dark ? 0.25 : 1.0);
      if (dark) {  // blurred: without waves
        const Mosaic even = grey(info, first + i, 0.0);
        for (std::size_t k = 0; k < mosaic.samples.pixel_count(); ++k) {
          const auto x = static_cast<int>(k % 192), y = static_cast<int>(k / 192);
          mosaic.samples.data()[k] =
              even.samples.data()[k] + 0.05f / info.white_balance[info.cfa.color(x, y)];
        }
      }
      inputs.push_back(folder_ / ("in" + std::to_string(first + i) + ".dng"));
      raw::write_dng(inputs.back(), mosaic, info);
    }
    const std::string output = folder_ / ("out" + std::to_string(first) + ".exr");
    becalm_done(command(inputs, output, {"--mosaic", "-q"}));
    EXPECT_EQ(io::read_attribute(output, "becalm:burst").find("reference=4"), std::string::npos) << first;
  }
}

TEST_F(Burst, AModelWithoutReadNoiseDoesNotOutweighTheOthers) {
  constexpr int left = 60, right = 100, top = 40, bottom = 70;
  const double of_read = 6e-5, of_light = 2e-3;
  std::vector<std::string> inputs;
  for (const int gain : {1, 2}) {
    raw::Info info = camera({}, 192, 144);
    info.iso *= gain;
    info.noise = NoiseModel{.a = of_light * gain, .b = gain == 1 ? of_read : 0.0};
    std::mt19937 random(static_cast<unsigned>(gain));
    std::normal_distribution<double> normal;
    Mosaic mosaic{Image(info.width, info.height, 1), info.cfa};
    for (int y = 0; y < info.height; ++y) {
      for (int x = 0; x < info.width; ++x) {
        const bool black = x >= left && x < right && y >= top && y < bottom;
        const double light = black ? 0.0 : 0.07 + 0.03 * std::sin(0.2 * x) * std::cos(0.25 * y);
        const double noise = std::sqrt(of_light * light + of_read) * normal(random);
        mosaic.samples.at(x, y, 0) = static_cast<float>(gain * (light + noise));
      }
    }
    inputs.push_back(folder_ / ("in" + std::to_string(gain) + ".dng"));
    raw::write_dng(inputs.back(), mosaic, info);
  }
  const std::string output = folder_ / "out.exr";
  becalm_done(command(inputs, output, {"--mosaic", "--reference", "first", "-q"}));
  const std::string told = io::read_attribute(output, "becalm:burst");
  const double weight = std::stod(told.substr(told.find("weight=") + 7));
  EXPECT_GT(weight, 1.0);
  EXPECT_LT(1.0 / std::sqrt(weight), 2.0 * std::sqrt(0.5)) << "two frames of equal noise: " << told;
  EXPECT_GT(1.0 / std::sqrt(weight), 0.5 * std::sqrt(0.5)) << "two frames of equal noise: " << told;
}

TEST_F(Burst, ASignalLeavesNothingHalfWritten) {
  std::vector<std::string> inputs;
  for (int number = 1; number <= 16; ++number) inputs.push_back(write(number, camera({}, 96, 72)));
  const fs::path outputs = folder_.path() / "outputs";
  fs::create_directory(outputs);
  const std::string output = (outputs / "out.exr").string();
  const std::vector<std::string> merges = command(inputs, output, {"--reference", "first"});
  Process process(merges);
  ASSERT_TRUE(process.wait_for("merged, 2 of 16"));
  process.signal(SIGINT);
  const Outcome stopped = process.wait();
  EXPECT_EQ(stopped.status, 130) << stopped.err;
  EXPECT_NE(stopped.err.find("interrupted: " + output + " was not written\n"), std::string::npos)
      << stopped.err;
  EXPECT_EQ(files_in(outputs), std::vector<std::string>{});
  write_text(output + ".partial.99999999.0", "half a file of a run that was killed");
  becalm_done(merges);
  EXPECT_EQ(files_in(outputs), std::vector<std::string>{"out.exr"});
  EXPECT_LT(error_of(read_frame(output).image(Aov::beauty), 1), 0.005) << "of 16 frames";
}

/// Gives a tag of a little-endian TIFF file's first directory another value of 32 bits.
void change_tag(const std::string& path, std::uint16_t tag, std::uint32_t value) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  const auto read = [&](std::streamoff at, std::size_t bytes) {
    std::uint32_t number = 0;
    file.seekg(at);
    for (std::size_t i = 0; i < bytes; ++i) number |= static_cast<std::uint32_t>(file.get()) << 8 * i;
    return number;
  };
  const std::streamoff directory = read(4, 4);
  for (std::uint32_t i = 0; i < read(directory, 2); ++i) {
    const std::streamoff entry = directory + 2 + 12 * static_cast<std::streamoff>(i);
    if (read(entry, 2) != tag) continue;
    file.seekp(entry + 8);
    for (int byte = 0; byte < 4; ++byte) file.put(static_cast<char>(value >> 8 * byte));
    return;
  }
  FAIL() << path << " has no tag " << tag;
}

TEST_F(Burst, RefusesSizesThatTheFileDoesNotHold) {
  constexpr std::uint16_t width = 256, height = 257;
  const raw::Info info = camera();
  for (const std::uint32_t claimed : {4000u, 65535u}) {
    const std::vector<std::string> files{write(1, info), write(2, info)};
    for (const std::string& file : files) {
      change_tag(file, width, claimed);
      change_tag(file, height, claimed);
    }
    expect_error(becalm(command(files, folder_ / "out.exr")), 3, {"in1.dng"});
  }
}

TEST_F(Burst, RefusesAPatternThatIsNotOfItsSize) {
  const std::string file = write(1, camera(x_trans()));
  change_tag(file, 33421, 0x00020002);  // LibRaw 0.20 would write past the pattern's end
  expect_error(becalm(command({file, write(2, camera(x_trans()))}, folder_ / "out.exr")), 3,
               {"in1.dng", "CFARepeatPatternDim"});
}

TEST_F(Burst, RefusesWhatIsNoBurst) {
  const auto inputs = write_burst();
  const std::string output = folder_ / "out.exr";
  const auto fails = [&](std::vector<std::string> files, const std::vector<std::string>& more, int status,
                         const std::vector<std::string>& words) {
    expect_error(becalm(command(std::move(files), output, more)), status, words);
    EXPECT_FALSE(fs::exists(output));
  };
  fails({inputs[0]}, {}, 3, {"in1.dng", "two or more"});
  fails({inputs[0], folder_ / "none.dng"}, {}, 3, {"none.dng", "no such file"});
  fails({inputs[0], inputs[0]}, {}, 2, {"in1.dng", "twice"});
  write_text(folder_ / "text.dng", "no raw file");
  fails({inputs[0], folder_ / "text.dng"}, {}, 3, {"text.dng", "raw file"});
  fails({inputs[0], write(4, camera({}, 96, 48))}, {}, 3, {"in4.dng", "96x48", "64x48"});
  raw::Info other = camera();
  other.model = "another";
  fails({inputs[0], write(5, other)}, {}, 3, {"in5.dng", "another"});
  other = camera();
  other.shutter_s = 2.0;
  fails({inputs[0], write(6, other)}, {}, 3, {"in6.dng", "exposure"});
  fails(inputs, {"--reference", "4"}, 2, {"--reference 4", "1 to 3"});
  fails(inputs, {"--noise", "1"}, 2, {"--noise 1", "A,B"});
  fails(inputs, {"--set", "smooth=none"}, 2, {"smooth", "blur_radius"});
  expect_error(becalm(command(inputs, folder_ / "out.jpg")), 2, {"out.jpg", ".dng"});
  expect_error(becalm(command(inputs, inputs[1])), 2, {"overwrite an input"});
  const std::string frame = folder_ / "frame.0001.exr";
  io::write_exr(frame, noise_frame(1, 4, 4), {{"becalm:version", "1"}});
  expect_error(becalm(command(inputs, frame)), 2, {frame, "becalm burst did not write it", "--overwrite"});
  expect_error(becalm(command(inputs, inputs[1] + "/out.dng")), 4, {"cannot write there"});
  fs::create_directory(folder_ / "folder.dng");
  expect_error(becalm(command(inputs, folder_ / "folder.dng")), 2, {"is a folder"});
  expect_error(becalm(command({inputs[0], folder_ / (std::string(300, 'a') + ".dng")}, folder_ / "out.dng")),
               3, {"no such file"});
  {  // cut short
    std::ofstream(folder_ / "short.dng", std::ios::binary)
        << std::string(std::istreambuf_iterator<char>(std::ifstream(inputs[0], std::ios::binary).rdbuf()), {})
               .substr(0, 2000);
  }
  expect_error(becalm(command({inputs[0], folder_ / "short.dng"}, output)), 3,
               {"short.dng: it is truncated, or cannot be read"});
}

}  // namespace
}  // namespace becalm::test
