#pragma once

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "frame/io/additive_layers.h"
#include "frame/io/exr.h"
#include "tests/io/exr_files.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {

/// Files of 8x6 pixels with layers whose sum may be the beauty.
class AdditiveLayers : public ::testing::Test {
 protected:
  static constexpr int kWidth = 8;
  static constexpr int kHeight = 6;
  using Names = std::vector<std::string>;

  /// Half channels R, G and B of each layer, of one value a pixel.
  void write(const std::map<std::string, std::function<float(int)>>& layers,
             Imf::Compression compression = Imf::ZIP_COMPRESSION) const {
    Imf::Header header(kWidth, kHeight);
    header.compression() = compression;
    Imf::FrameBuffer buffer;
    std::map<std::string, std::vector<Imath::half>> planes;
    for (const auto& [layer, value] : layers) {
      std::vector<Imath::half>& plane = planes[layer];
      for (int i = 0; i < kWidth * kHeight; ++i) plane.emplace_back(value(i));
      for (const char* letter : {"R", "G", "B"}) {
        const std::string name = layer.empty() ? letter : layer + "." + letter;
        header.channels().insert(name, Imf::Channel(Imf::HALF));
        buffer.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(plane.data()), 2, 2 * kWidth));
      }
    }
    Imf::OutputFile file(path_.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(kHeight);
  }

  /// Parts of bare half channels R, G and B, in this order; those named in `cropped` lack the last column.
  void write_parts(const std::vector<std::pair<std::string, std::function<float(int)>>>& parts,
                   const Names& cropped = {}) const {
    std::vector<Imf::Header> headers;
    for (const auto& [name, value] : parts) {
      const bool is_cropped = std::ranges::find(cropped, name) != cropped.end();
      headers.push_back(named_part(name, layer_channels("", {"R", "G", "B"}, Imf::HALF)));
      headers.back().dataWindow() = window(0, 0, kWidth - (is_cropped ? 1 : 0), kHeight);
    }
    Imf::MultiPartOutputFile file(path_.c_str(), headers.data(), static_cast<int>(headers.size()));
    for (int part = 0; part < static_cast<int>(parts.size()); ++part) {
      std::vector<Imath::half> plane;
      for (int i = 0; i < kWidth * kHeight; ++i) plane.emplace_back(parts[part].second(i));
      Imf::FrameBuffer buffer;
      for (const char* letter : {"R", "G", "B"})
        buffer.insert(letter, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(plane.data()), 2, 2 * kWidth));
      Imf::OutputPart output(file, part);
      output.setFrameBuffer(buffer);
      output.writePixels(kHeight);
    }
  }

  std::vector<AdditiveSet> sets() const { return find_additive_sets(path_, {}); }

  /// Doubles beauty and light groups of the chosen layers, and writes them.
  void denoise() const {
    LoadedFrame loaded =
        read_exr(path_, 1, {}, {.additive = choose_additive("auto", sets())}, LightGroups::read);
    const auto twice = [](Image& image) {
      for (float& value : image.data()) value *= 2.0f;
    };
    twice(loaded.frame.image(Aov::beauty));
    for (LightGroup& group : loaded.frame.light_groups()) twice(group.radiance);
    write_denoised_exr(result_, loaded.frame, {}, loaded, {});
  }

  float result(const std::string& channel, int i) const {
    return read_value(read_planes(result_), channel, i);
  }
  static float read_value(const Planes& planes, const std::string& channel, int i) {
    Imath::half value;
    std::memcpy(&value, &planes.at(channel)[2 * static_cast<std::size_t>(i)], 2);
    return value;
  }

  static float first(int i) { return 0.1f * static_cast<float>(i % 7); }
  static float second(int i) { return 3.0f + 0.01f * static_cast<float>(i); }
  static float both(int i) { return first(i) + second(i); }

  TemporaryFolder folder_;
  const std::string path_ = folder_.path("image.exr");
  const std::string result_ = folder_.path("result.exr");
};

}  // namespace becalm::io
