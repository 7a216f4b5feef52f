#include "app/compare_report.h"

#include <fmt/format.h>

#include <array>

#include "app/pictures.h"

namespace becalm::app {
namespace {

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

constexpr std::array kPictures{"reference", "test", "error"};

std::string picture_name(int frame, const char* what) {
  return fmt::format("{}.{:04}.png", what, frame);
}

}  // namespace

std::vector<ReportFile> CompareReport::pictures(const std::vector<int>& frames) const {
  std::vector<ReportFile> files;
  for (const int frame : frames) {
    for (const char* what : kPictures)
      files.push_back(file_in(folder_, picture_name(frame, what), ReportKind::compare_picture));
  }
  return files;
}

void CompareReport::add(int frame, const Image& test, const Image& reference) {
  const std::array<Picture, kPictures.size()> made{display_picture(reference), display_picture(test),
                                                   error_picture(test, reference)};
  const std::vector<ReportFile> files = pictures({frame});
  for (std::size_t i = 0; i < made.size(); ++i) {
    const std::vector<unsigned char> bytes = png_bytes(made[i]);
    write_report_file(files[i], {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
}

std::string CompareReport::page(const std::string& title, const std::vector<FrameFigures>& figures) const {
  std::string html = kHead;
  html += fmt::format(
      "<h1>{}</h1>\n<div class=\"scale\" style=\"background: linear-gradient(to right, {})\"></div>\n"
      "<p>Relative squared error of a pixel, from {:g} (left) to {:g} (right), logarithmic; cyan where a "
      "value is not finite.</p>\n",
      escape(title), error_scale_css(), kCoolestError, kHottestError);
  for (const FrameFigures& entry : figures) {
    html += fmt::format(
        "<section><h2>frame {}: relMSE {:.3e}, PSNR {:.2f} dB, SSIM {:.4f}, FLIP {:.4f}, energy {:+.3f} "
        "%</h2>\n",
        entry.frame, entry.rel_mse, entry.psnr_db, entry.ssim, entry.flip, entry.energy * 100.0);
    html += "<div class=\"row\">";
    for (const char* what : kPictures) {
      html +=
          fmt::format("<figure><img src=\"{}\" alt=\"{} of frame {}\"><figcaption>{}</figcaption></figure>",
                      picture_name(entry.frame, what), what, entry.frame, what);
    }
    html += "</div></section>\n";
  }
  return html + "</html>\n";
}

}  // namespace becalm::app
