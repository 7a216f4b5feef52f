#pragma once

#include <string>
#include <vector>

#include "app/frame_figures.h"
#include "frame/image.h"

namespace becalm::app {

/// A folder for index.html with, for each frame, the reference, the test and the relative error as PNG files.
class CompareReport {
 public:
  /// Makes the folder. Throws Error(resource).
  explicit CompareReport(std::string folder);

  void add(int frame, const Image& test, const Image& reference);
  /// The text of index.html: `title` and a row for each frame that was added.
  std::string page(const std::string& title, const std::vector<FrameFigures>& figures) const;

 private:
  std::string picture(int frame, const std::string& what) const;

  std::string folder_;
};

}  // namespace becalm::app
