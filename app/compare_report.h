#pragma once

#include <string>
#include <vector>

#include "frame/image.h"

namespace becalm::app {

/// The figures of one frame; NaN where there is none, such as the temporal error of the first frame.
struct FrameFigures {
  int frame = 0;
  double rel_mse = 0.0;
  double psnr_db = 0.0;
  double ssim = 0.0;
  double flip = 0.0;
  double temporal = 0.0;
  double energy = 0.0;
  std::size_t skipped = 0;  ///< pixels that are not finite in one of the images
};

/// A folder with index.html and, for each frame, the reference, the test and the relative error as PNG files.
class CompareReport {
 public:
  /// Makes the folder. Throws Error(resource).
  explicit CompareReport(std::string folder);

  void add(int frame, const Image& test, const Image& reference);
  /// Writes index.html: `title` and a row for each frame that was added.
  void finish(const std::string& title, const std::vector<FrameFigures>& figures) const;

 private:
  std::string picture(int frame, const std::string& what) const;

  std::string folder_;
};

}  // namespace becalm::app
