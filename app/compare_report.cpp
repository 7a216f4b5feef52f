#include "app/compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "frame/error.h"
#include "frame/pictures/pictures.h"

namespace becalm::app {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Color = std::array<double, 3>;

/// The heat map spans these relative squared errors, on a logarithmic scale.
constexpr double kCoolest = 1e-5;
constexpr double kHottest = 10.0;

/// Black, violet, red, amber, white: luminance rises with the error, so that it reads in grey too.
constexpr std::array<Color, 5> kHeat{
    {{0.0, 0.0, 0.02}, {0.33, 0.07, 0.43}, {0.80, 0.22, 0.26}, {0.98, 0.62, 0.10}, {1.0, 1.0, 0.90}}};
/// Where an image is not finite.
constexpr Color kNotFinite{0.0, 0.8, 1.0};

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255.0));
}

double srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

Color heat(double error) {
  const double share = std::log(std::max(error, kCoolest) / kCoolest) / std::log(kHottest / kCoolest);
  const double position = std::clamp(share, 0.0, 1.0) * (kHeat.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(position), kHeat.size() - 2);
  const double blend = position - static_cast<double>(below);
  Color color;
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = kHeat[below][c] * (1.0 - blend) + kHeat[below + 1][c] * blend;
  return color;
}

Bytes display(const Image& image) {
  Bytes bytes;
  bytes.reserve(image.pixel_count() * 3);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const double value = image.at(x, y, c);
        bytes.push_back(to_byte(std::isfinite(value) ? srgb(std::clamp(value, 0.0, 1.0)) : kNotFinite[c]));
      }
    }
  }
  return bytes;
}

/// The same expression as rel_mse, one pixel at a time.
double pixel_error(std::span<const float> test, std::span<const float> reference) {
  double sum = 0.0;
  for (int c = 0; c < 3; ++c) {
    const double difference = double(test[c]) - reference[c];
    sum += difference * difference / (double(reference[c]) * reference[c] + 0.01);
  }
  return sum / 3.0;
}

Bytes error_map(const Image& test, const Image& reference) {
  Bytes bytes;
  bytes.reserve(test.pixel_count() * 3);
  for (int y = 0; y < test.height(); ++y) {
    for (int x = 0; x < test.width(); ++x) {
      const double error = pixel_error(test.pixel(x, y), reference.pixel(x, y));
      for (const double value : std::isfinite(error) ? heat(error) : kNotFinite)
        bytes.push_back(to_byte(value));
    }
  }
  return bytes;
}

void write_png(const std::string& path, const Image& like, const Bytes& rgb) {
  pictures::Library& library = pictures::library();
  try {
    library.write(path, like.width(), like.height(), rgb);
  } catch (const std::runtime_error& error) {
    throw Error(ExitStatus::resource, fmt::format("{}: cannot write the picture: {}", path, error.what()));
  }
}

std::string escape(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '&')
      escaped += "&amp;";
    else
      escaped += c;
  }
  return escaped;
}

constexpr const char* kHead = R"(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>becalm compare</title>
<style>
  body { background: #181a1d; color: #dde; font: 15px/1.4 system-ui, sans-serif; margin: 2em; }
  h1 { font-size: 1.2em; font-weight: 600; }
  figure { margin: 0; } figcaption { color: #99a; font-size: .85em; }
  section { margin: 2em 0; } h2 { font-size: 1em; font-weight: 600; font-variant-numeric: tabular-nums; }
  .row { display: grid; grid-template-columns: repeat(3, 1fr); gap: .6em; }
  img { width: 100%; image-rendering: pixelated; display: block; }
  .scale { height: .8em; max-width: 30em; }
</style>
)";

}  // namespace

CompareReport::CompareReport(std::string folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    throw Error(ExitStatus::resource,
                fmt::format("--report {}: cannot make the folder: {}", folder_, error.message()));
  }
}

std::string CompareReport::picture(int frame, const std::string& what) const {
  return fmt::format("{}.{:04}.png", what, frame);
}

void CompareReport::add(int frame, const Image& test, const Image& reference) {
  const std::filesystem::path folder(folder_);
  write_png((folder / picture(frame, "reference")).string(), reference, display(reference));
  write_png((folder / picture(frame, "test")).string(), test, display(test));
  write_png((folder / picture(frame, "error")).string(), test, error_map(test, reference));
}

void CompareReport::finish(const std::string& title, const std::vector<FrameFigures>& figures) const {
  std::string scale;
  for (const Color& color : kHeat) {
    scale += fmt::format(", rgb({}, {}, {})", to_byte(color[0]), to_byte(color[1]), to_byte(color[2]));
  }
  std::string html = kHead;
  html += fmt::format(
      "<h1>{}</h1>\n<div class=\"scale\" style=\"background: linear-gradient(to right{})\"></div>\n"
      "<p>Relative squared error of a pixel, from {:g} (left) to {:g} (right), logarithmic; cyan where a "
      "value is not "
      "finite.</p>\n",
      escape(title), scale, kCoolest, kHottest);
  for (const FrameFigures& entry : figures) {
    html += fmt::format(
        "<section><h2>frame {}: relMSE {:.3e}, PSNR {:.2f} dB, SSIM {:.4f}, FLIP {:.4f}, energy {:+.3f} "
        "%</h2>\n",
        entry.frame, entry.rel_mse, entry.psnr_db, entry.ssim, entry.flip, entry.energy * 100.0);
    html += "<div class=\"row\">";
    for (const char* what : {"reference", "test", "error"}) {
      html +=
          fmt::format("<figure><img src=\"{}\" alt=\"{} of frame {}\"><figcaption>{}</figcaption></figure>",
                      picture(entry.frame, what), what, entry.frame, what);
    }
    html += "</div></section>\n";
  }
  html += "</html>\n";
  const std::string path = (std::filesystem::path(folder_) / "index.html").string();
  std::ofstream file(path);
  if (!(file << html) || !file.flush())
    throw Error(ExitStatus::resource, fmt::format("{}: cannot write it", path));
}

}  // namespace becalm::app
