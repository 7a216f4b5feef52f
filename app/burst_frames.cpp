#include "app/burst_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "frame/error.h"

namespace becalm::app {
namespace {

/// Frames whose exposures differ by more have too little in common.
constexpr double kMostExposureRatio = 16.0;
/// Enough for the 3x3 blocks of every level of the search and for LibRaw's demosaicing.
constexpr int kLeastSide = 24;

Error bad_input(const std::string& path, const std::string& what) {
  return {ExitStatus::bad_input, fmt::format("{}: {}", path, what)};
}

std::string camera(const raw::Info& info) {
  return info.make + " " + info.model;
}

std::string size(const raw::Info& info) {
  return fmt::format("{}x{} px", info.width, info.height);
}

/// 1 where a file does not tell one of them.
double known_ratio(double a, double b) {
  return a > 0.0 && b > 0.0 ? a / b : 1.0;
}

}  // namespace

BurstFrames::BurstFrames(std::vector<std::string> paths) : paths_(std::move(paths)) {
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::error_code error;
      if (paths_[i] == paths_[j] || std::filesystem::equivalent(paths_[i], paths_[j], error))
        throw Error(ExitStatus::usage,
                    fmt::format("{}: given twice; its noise would count as known", paths_[i]));
    }
  }
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    infos_.push_back(raw::open(paths_[i])->info());
    check(i);
  }
  if (paths_.size() < 2)
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: one file is no burst, expected two or more", paths_[0]));
}

void BurstFrames::check(std::size_t frame) const {
  const raw::Info& first = infos_.front();
  const raw::Info& here = infos_[frame];
  const auto differs = [&](const std::string& what, const std::string& value, const std::string& expected) {
    return bad_input(paths_[frame],
                     fmt::format("{} {}, expected {} as in {}", what, value, expected, paths_[0]));
  };
  if (here.width < kLeastSide || here.height < kLeastSide)
    throw bad_input(paths_[frame],
                    fmt::format("size {}, expected {} px or more a side", size(here), kLeastSide));
  if (camera(here) != camera(first)) throw differs("camera", camera(here), camera(first));
  if (here.width != first.width || here.height != first.height)
    throw differs("size", size(here), size(first));
  if (here.cfa != first.cfa) throw differs("mosaic", describe(here.cfa), describe(first.cfa));
  const double ratio = exposure(frame, 0);
  if (!(ratio <= kMostExposureRatio && ratio >= 1.0 / kMostExposureRatio))
    throw differs("exposure", describe_exposure(here),
                  fmt::format("at most {} times that ({})", kMostExposureRatio, describe_exposure(first)));
}

Mosaic BurstFrames::read(std::size_t frame) const {
  const auto file = raw::open(paths_[frame]);
  if (file->info().width != infos_[frame].width || file->info().height != infos_[frame].height)
    throw bad_input(paths_[frame], "has changed since its header was read");
  return raw::read(*file, paths_[frame]);
}

double BurstFrames::exposure(std::size_t frame, std::size_t reference) const {
  const raw::Info& a = infos_[frame];
  const raw::Info& b = infos_[reference];
  const double f_number = known_ratio(b.f_number, a.f_number);
  return known_ratio(a.shutter_s, b.shutter_s) * iso_ratio(frame, reference) * f_number * f_number;
}

double BurstFrames::iso_ratio(std::size_t frame, std::size_t reference) const {
  return known_ratio(infos_[frame].iso, infos_[reference].iso);
}

std::string describe(const CfaPattern& cfa) {
  std::string text = fmt::format("{0}x{0} ", cfa.period);
  for (int i = 0; i < cfa.period * cfa.period; ++i) text += "RGB"[cfa.colors[i]];
  return text;
}

std::string describe_exposure(const raw::Info& info) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (info.shutter_s > 0.0)
    add(info.shutter_s < 0.5 ? fmt::format("1/{:.0f} s", 1.0 / info.shutter_s)
                             : fmt::format("{:.3g} s", info.shutter_s));
  if (info.iso > 0.0) add(fmt::format("ISO {:.0f}", info.iso));
  if (info.f_number > 0.0) add(fmt::format("f/{:.3g}", info.f_number));
  return text.empty() ? "exposure unknown" : text;
}

}  // namespace becalm::app
