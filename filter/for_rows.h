#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace becalm::filter {

/// Calls `body(begin, end)` for ranges of rows that cover [0, rows), on all threads.
template <class Body>
void for_rows(int rows, const Body& body) {
  constexpr int rows_a_task = 16;
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, rows_a_task),
                    [&](const tbb::blocked_range<int>& block) { body(block.begin(), block.end()); });
}

}  // namespace becalm::filter
