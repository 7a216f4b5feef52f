#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace becalm::filter {

/// Calls `body(begin, end)` for ranges of rows that cover [0, rows), on all threads.
template <class Body>
void for_rows(int rows, const Body& body) {
  constexpr int rows_a_task = 8;
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, rows_a_task),
                    [&](const tbb::blocked_range<int>& block) { body(block.begin(), block.end()); });
}

/// Calls `body(i)` for each i in [0, count), on all threads.
template <class Body>
void for_each_in_parallel(int count, const Body& body) {
  tbb::parallel_for(0, count, body);
}

}  // namespace becalm::filter
