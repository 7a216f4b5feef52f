#include "app/audit_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "app/input_frames.h"
#include "frame/io/printable.h"

namespace becalm::app {

std::string FrameFinding::text() const {
  return fmt::format("frame {}{}{}: {} ({})", frame, view.empty() ? "" : " ", io::printable(view),
                     finding.text, finding.check);
}

std::vector<FrameFinding> audit_frames(const std::vector<int>& frames,
                                       const std::function<io::LoadedFrame(int)>& read) {
  std::vector<FrameFinding> findings;
  const auto add = [&](const io::LoadedView& view, const Frame* before) {
    for (audit::Finding& finding : audit::audit({view.frame, before})) {
      const bool known = std::ranges::any_of(
          findings, [&](const FrameFinding& other) { return other.finding.check == finding.check; });
      if (!known) findings.push_back({view.frame.number(), view.view, std::move(finding)});
    }
  };
  std::vector<std::size_t> followers;  // whose frame before is there
  const int step = usual_step(frames);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (frames[i] - frames[i - 1] == step) followers.push_back(i);
  }
  if (followers.empty() && !frames.empty()) {
    const io::LoadedFrame only = read(frames.front());
    add(only, nullptr);
    for (const io::LoadedView& view : only.other_views) add(view, nullptr);
    if (only.other_eye) add(*only.other_eye, nullptr);
  }
  if (followers.empty()) return findings;
  for (const std::size_t at :
       std::set<std::size_t>{followers.front(), followers[followers.size() / 2], followers.back()}) {
    const io::LoadedFrame before = read(frames[at - 1]);
    const io::LoadedFrame frame = read(frames[at]);
    add(frame, &before.frame);
    const std::size_t views = std::min(frame.other_views.size(), before.other_views.size());
    for (std::size_t i = 0; i < views; ++i) add(frame.other_views[i], &before.other_views[i].frame);
    if (frame.other_eye && before.other_eye) add(*frame.other_eye, &before.other_eye->frame);
  }
  return findings;
}

}  // namespace becalm::app
