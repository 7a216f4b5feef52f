#include "app/frame_problems.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/console.h"
#include "frame/error.h"
#include "frame/io/frame_range.h"

namespace becalm::app {

void FrameProblems::add(int frame, std::string problem) {
  const std::string path = pattern_.path(frame) + ": ";
  if (problem.starts_with(path)) problem.erase(0, path.size());
  auto known = std::ranges::find(problems_, problem, [](const auto& entry) { return entry.first; });
  if (known == problems_.end()) known = problems_.insert(known, {problem, {}});
  known->second.push_back(frame);
}

void FrameProblems::fail(std::size_t total, std::string_view consequence) const {
  if (problems_.size() == 1) {
    const auto& [problem, frames] = problems_.front();
    throw Error(ExitStatus::bad_input, fmt::format("{}: {}", frames_text(frames), problem));
  }
  std::size_t count = 0;
  for (const auto& [problem, frames] : problems_) {
    warn(fmt::format("{}: {}", frames_text(frames), problem));
    count += frames.size();
  }
  throw Error(ExitStatus::bad_input, fmt::format("{}: {} of {} frames cannot be used{}", pattern_.text(),
                                                 count, total, consequence));
}

std::string FrameProblems::frames_text(const std::vector<int>& frames) const {
  if (frames.size() == 1) return pattern_.path(frames.front());
  return fmt::format("{}: frames {}", pattern_.text(), io::format_frame_range(frames, step_));
}

}  // namespace becalm::app
