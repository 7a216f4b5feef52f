#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frame/mosaic.h"
#include "frame/raw/raw.h"

namespace becalm::app {

/// The frames of a burst as files. Their headers are read and compared at once, their samples when asked for.
class BurstFrames {
 public:
  /// Throws Error(usage) for a file given twice, Error(bad_input) for a single one, and naming the file that
  /// cannot be read, or whose camera, size, pattern or exposure does not go with the first's.
  explicit BurstFrames(std::vector<std::string> paths);

  std::size_t count() const { return paths_.size(); }
  const std::string& path(std::size_t frame) const { return paths_[frame]; }
  const raw::Info& info(std::size_t frame) const { return infos_[frame]; }

  /// Reads a frame's samples.
  Mosaic read(std::size_t frame) const;
  /// How many times more light counts in a frame than in the reference, by shutter, ISO and aperture; what
  /// one of the files does not tell counts as equal.
  double exposure(std::size_t frame, std::size_t reference) const;
  /// 1 where one of the files does not tell its ISO.
  double iso_ratio(std::size_t frame, std::size_t reference) const;

 private:
  void check(std::size_t frame) const;

  std::vector<std::string> paths_;
  std::vector<raw::Info> infos_;
};

/// `2x2 RGGB`, or for X-Trans `6x6` and its 36 letters.
std::string describe(const CfaPattern& cfa);

/// `1/60 s, ISO 800, f/2.8`, as far as it is known.
std::string describe_exposure(const raw::Info& info);

}  // namespace becalm::app
