#include "app/audit_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

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
  if (frames.size() == 1) {
    const io::LoadedFrame only = read(frames.front());
    add(only, nullptr);
    for (const io::LoadedView& view : only.other_views) add(view, nullptr);
    if (only.other_eye) add(*only.other_eye, nullptr);
  }
  if (frames.size() < 2) return findings;
  for (const std::size_t at : std::set<std::size_t>{1, frames.size() / 2, frames.size() - 1}) {
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
