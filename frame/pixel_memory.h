#pragma once

#include <cstddef>
#include <new>

namespace becalm {

/// Memory for the pixels of an image or of a file's channel. Blocks of 256 KiB and more that are given back
/// are kept for the next of the same size: the system hands out fresh memory page by page, which takes longer
/// than filling it. The memory is not cleared. Throws std::bad_alloc. May be called from any thread; `bytes`
/// is the same in both calls.
void* take_pixel_memory(std::size_t bytes);
void give_back_pixel_memory(void* memory, std::size_t bytes);

template <class T>
struct PixelAllocator {
  using value_type = T;
  PixelAllocator() = default;
  template <class Other>
  PixelAllocator(const PixelAllocator<Other>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(take_pixel_memory(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) { give_back_pixel_memory(memory, count * sizeof(T)); }
  /// Without a value, pixels are what the memory holds.
  void construct(T* pixel) { ::new (pixel) T; }
  void construct(T* pixel, T value) { ::new (pixel) T(value); }
  bool operator==(const PixelAllocator&) const = default;
};

}  // namespace becalm
