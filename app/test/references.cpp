#include "app/test/references.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <system_error>

#include "app/frame_figures.h"
#include "app/partial_files.h"
#include "app/test/layer_as_beauty.h"
#include "frame/error.h"
#include "frame/io/atomic_file.h"
#include "frame/io/exr.h"
#include "frame/io/sequence.h"
#include "frame/names_in.h"

namespace becalm::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSamplesAttribute = "becalm:reference_spp";

/// Rounds to a step of at most half the standard deviation, which adds 2 % to the variance: ZIP finds little
/// to compress in the bits of noise.
float rounded_below_noise(float value, float variance) {
  const float step = 0.5f * std::sqrt(variance);
  if (!(step > 0.0f) || !std::isfinite(step) || !std::isfinite(value)) return value;
  const float power = std::exp2(std::floor(std::log2(step)));
  return std::round(value / power) * power;
}

void round_below_noise(Frame& frame) {
  if (!frame.has(Aov::variance)) return;
  Image& beauty = frame.image(Aov::beauty);
  const Image& variance = frame.image(Aov::variance);
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        beauty.at(x, y, c) = rounded_below_noise(beauty.at(x, y, c), variance.at(x, y, c));
      }
    }
  }
}

/// A copy of the file that waits to be renamed to its place.
std::unique_ptr<io::AtomicFile> copy_of(const std::string& made, const std::string& place) {
  auto copy = std::make_unique<io::AtomicFile>(place);
  std::ifstream file(made, std::ios::binary);
  std::vector<char> bytes(std::size_t{1} << 20);
  while (file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())) || file.gcount() > 0)
    copy->write(bytes.data(), static_cast<std::size_t>(file.gcount()));
  if (!file.eof()) throw Error(ExitStatus::resource, fmt::format("{}: cannot be read", made));
  copy->finish();
  return copy;
}

/// `exact` keeps the file as it is; other judges need the beauty, and the guides where they denoise it.
void write_reference(const TestCase& test, int spp, const std::string& from, int number,
                     const std::string& to) {
  PlacedFrame placed = read_layer_as_beauty(from, number, test.layer);
  Frame& frame = placed.frame;
  const Image& beauty = frame.image(Aov::beauty);
  if (std::ranges::any_of(beauty.data(), [](float value) { return !std::isfinite(value); })) {
    throw Error(ExitStatus::bad_input,
                fmt::format("frame {} has pixels that are not finite, and would be a bad reference", number));
  }
  if (test.judges.exact) {
    copy_of(from, to)->commit();
    return;
  }
  if (test.judges.statistical && !frame.has(Aov::variance)) {
    throw Error(ExitStatus::bad_input,
                fmt::format("frame {} has no layer variance, which statistical needs of references", number));
  }
  for (const AovInfo& entry : kAovTable) {
    const bool guide = test.judges.denoised &&
                       (entry.aov == Aov::albedo || entry.aov == Aov::normal || entry.aov == Aov::depth);
    if (entry.aov != Aov::beauty && entry.aov != Aov::variance && !guide) frame.remove(entry.aov);
  }
  // What is denoised must keep the noise as the renderer makes it, and other layers have another.
  if (!test.judges.denoised && test.layer.empty()) round_below_noise(frame);
  if (!test.judges.denoised && !test.judges.statistical) frame.remove(Aov::variance);
  io::write_compact_exr(to, frame,
                        {{"becalm:version", BECALM_VERSION}, {kSamplesAttribute, std::to_string(spp)}},
                        placed.first);
}

ComparedFrame read_pair(int number, const std::string& test, const std::string& reference) {
  return {.frame = number,
          .test = io::read_exr(test, number, {}).frame.image(Aov::beauty),
          .reference = io::read_exr(reference, number, {}).frame.image(Aov::beauty),
          .reference_b = {},
          .reference_mean = {}};
}

}  // namespace

std::vector<std::string> reference_files(const TestCase& test) {
  std::vector<std::string> files;
  for (int which = 0; which < reference_count(test); ++which) {
    const io::SequencePattern pattern(test.reference_pattern(which));
    for (const int frame : test.source.frames) files.push_back(pattern.path(frame));
  }
  return files;
}

std::vector<std::string> missing_references(const TestCase& test) {
  std::vector<std::string> files = reference_files(test);
  std::erase_if(files, [](const std::string& file) { return fs::is_regular_file(file); });
  return files;
}

void check_references(const TestCase& test) {
  for (const std::string& file : reference_files(test)) io::read_exr_header(file, {}, io::CheckChunks::yes);
}

double samples_of_reference(const std::string& path) {
  const double samples = std::strtod(io::read_attribute(path, kSamplesAttribute).c_str(), nullptr);
  return samples >= 1.0 ? samples : 1.0;
}

ReferenceUpdate::ReferenceUpdate(const TestCase& test, const RunSettings& settings)
    : test_(test), settings_(settings) {}

void ReferenceUpdate::make() {
  try {
    if (!test_.judges.exact && !test_.judges.denoised) require_seed(test_);
    for (int which = 0; which < reference_count(test_); ++which) make_one(which);
  } catch (const Error& error) {
    throw Error(error.status(), message_of(error));
  }
  find_outdated();
}

/// Files of the work folder, which may be gone when the message is read, have their place in it.
std::string ReferenceUpdate::message_of(const Error& error) const {
  std::string message = error.what();
  const std::string folder = settings_.work_folder + "/";
  for (std::size_t at = message.find(folder); at != std::string::npos; at = message.find(folder, at)) {
    message.erase(at, folder.size());
  }
  return fmt::format("{}: {}", test_.full_name(), message);
}

void ReferenceUpdate::make_one(int which) {
  FrameOrder order = order_of_reference(test_, which);
  order.pattern = fmt::format("{}/reference_{}/frame.####.exr", settings_.work_folder, which);
  const MadeFrames made = make_frames(test_, order, settings_);
  if (made.interrupted) throw Error(ExitStatus::interrupted, "interrupted");
  if (!made.failure.empty()) throw Error(ExitStatus::bad_input, made.failure);
  const io::SequencePattern rendered(order.pattern);
  const io::SequencePattern place(test_.reference_pattern(which));
  for (const int frame : test_.source.frames) {
    const std::string compact = rendered.path(frame) + ".reference.exr";
    write_reference(test_, order.spp, rendered.path(frame), frame, compact);
    files_.emplace_back(compact, place.path(frame));
    bytes_ += fs::file_size(compact);
    changes_.push_back(change_of(frame, place.path(frame), compact));
  }
}

std::string ReferenceUpdate::change_of(int frame, const std::string& old_file,
                                       const std::string& new_file) const {
  const std::string size = fmt::format("{}: {:.1f} KiB", old_file, fs::file_size(new_file) / 1024.0);
  if (!fs::is_regular_file(old_file)) return size + ", new";
  try {
    const ComparedFrame pair = read_pair(frame, new_file, old_file);
    if (pair.test.width() != pair.reference.width() || pair.test.height() != pair.reference.height()) {
      return fmt::format("{}, {}x{} and {}x{} before", size, pair.test.width(), pair.test.height(),
                         pair.reference.width(), pair.reference.height());
    }
    const FrameFigures figures = measure(pair, nullptr);
    return fmt::format("{}, against the one before: relMSE {:.3e}, FLIP {:.4f}, energy {:+.3f} %", size,
                       figures.rel_mse, figures.flip, figures.energy * 100.0);
  } catch (const Error& error) {
    return fmt::format("{}, the one before cannot be read: {}", size, error.what());
  }
}

void ReferenceUpdate::accept() const {
  // All are written beside their places before the first is renamed, so that a full disk changes none.
  std::vector<std::string> places;
  for (const auto& [made, place] : files_) places.push_back(place);
  remove_abandoned_partials(places);
  std::vector<std::unique_ptr<io::AtomicFile>> copies;
  for (const auto& [made, place] : files_) copies.push_back(copy_of(made, place));
  for (const auto& copy : copies) copy->commit();
  std::error_code error;
  for (const std::string& path : outdated_) {
    if (!fs::remove(path, error) && error)
      throw Error(ExitStatus::resource, fmt::format("{}: cannot remove it: {}", path, error.message()));
  }
}

void ReferenceUpdate::find_outdated() {
  std::error_code error;
  for (const std::string& name : names_in(test_.reference_folder, error)) {
    const bool is_reference = (name.starts_with("a.") || name.starts_with("b.")) && name.ends_with(".exr");
    const auto is_here = [&](const auto& file) { return fs::path(file.second).filename() == name; };
    if (is_reference && std::ranges::none_of(files_, is_here))
      outdated_.push_back(fs::path(test_.reference_folder) / name);
  }
  std::ranges::sort(outdated_);
  for (const std::string& path : outdated_)
    changes_.push_back(path + ": removed, the case has no such frame");
}

}  // namespace becalm::app
