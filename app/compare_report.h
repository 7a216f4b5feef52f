#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/frame_figures.h"
#include "app/report_file.h"
#include "frame/image.h"

namespace becalm::app {

/// A folder for index.html with, for each frame, the reference, the test and the relative error as PNG files.
class CompareReport {
 public:
  explicit CompareReport(std::string folder) : folder_(std::move(folder)) {}

  /// The files that `add` writes of these frames, for check_report_files.
  std::vector<ReportFile> pictures(const std::vector<int>& frames) const;
  /// Throws as write_report_file.
  void add(int frame, const Image& test, const Image& reference);
  /// The text of index.html: `title` and a row for each frame that was added.
  std::string page(const std::string& title, const std::vector<FrameFigures>& figures) const;

 private:
  std::string folder_;
};

}  // namespace becalm::app
