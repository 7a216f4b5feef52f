#pragma once

#include "filter/task.h"

namespace becalm::filter {

/// A task for frames with a variance and no other AOV, or also with half-buffers.
inline FilterTask task_with_variance(const Settings& settings, gpu::Extent full, bool halves = false) {
  FilterTask task{.settings = settings, .full = full, .used = {}, .diagnostics = {}, .guides = {}};
  task.used.set(static_cast<std::size_t>(Aov::variance));
  for (const Aov aov : {Aov::half_a, Aov::half_b}) task.used.set(static_cast<std::size_t>(aov), halves);
  return task;
}

}  // namespace becalm::filter
