#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <vector>

namespace becalm::filter {

/// Calls `body(begin, end)` for ranges of rows that cover [0, rows), on all threads.
template <class Body>
void for_rows(int rows, const Body& body) {
  constexpr int rows_a_task = 8;
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, rows_a_task),
                    [&](const tbb::blocked_range<int>& block) { body(block.begin(), block.end()); });
}

/// Calls `body(x, y, i)` for every pixel of an image and its index, on all threads.
template <class Body>
void for_each_pixel(int width, int height, const Body& body) {
  for_rows(height, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < width; ++x) body(x, y, static_cast<std::size_t>(y) * width + x);
    }
  });
}

/// Calls `body(i)` for each i in [0, count), on all threads.
template <class Body>
void for_each_in_parallel(int count, const Body& body) {
  tbb::parallel_for(0, count, body);
}

/// The sum of `of_row(y)` over all rows. Rows are computed on all threads and added in a fixed order.
template <class Sum, class OfRow>
Sum sum_of_rows(int rows, const OfRow& of_row) {
  std::vector<Sum> sums(static_cast<std::size_t>(rows));
  for_rows(rows, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) sums[static_cast<std::size_t>(y)] = of_row(y);
  });
  Sum sum{};
  for (const Sum& row : sums) sum += row;
  return sum;
}

}  // namespace becalm::filter
