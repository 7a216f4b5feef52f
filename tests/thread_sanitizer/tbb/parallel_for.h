#pragma once

// Stands in for oneTBB's header in builds with the thread sanitizer. That library is not built with it, so
// the sanitizer would see none of the ways in which work is handed from thread to thread and report all of
// them; threads of the standard library it understands.

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/partitioner.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace tbb {

/// Calls body(i) for each i in [first, last) from as many threads as oneTBB would use, and from two at least.
template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
  std::atomic<Index> next{first};
  const auto work = [&] {
    for (Index i = next++; i < last; i = next++) body(i);
  };
  const std::size_t threads =
      std::max<std::size_t>(2, global_control::active_value(global_control::max_allowed_parallelism));
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  for (std::thread& thread : others) thread.join();
}

template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body, const simple_partitioner&) {
  parallel_for(first, last, body);
}

/// Calls body(range) for pieces of the grain's size.
template <class Value, class Body>
void parallel_for(const blocked_range<Value>& range, const Body& body) {
  const auto grain = static_cast<Value>(range.grainsize());
  const Value pieces = (range.end() - range.begin() + grain - 1) / grain;
  parallel_for(Value{0}, pieces, [&](Value i) {
    const Value begin = range.begin() + i * grain;
    body(blocked_range<Value>(begin, std::min(range.end(), begin + grain)));
  });
}

}  // namespace tbb
