#include "frame/pixel_memory.h"

#include <algorithm>
#include <mutex>
#include <new>
#include <vector>

namespace becalm {
namespace {

/// 256 lines of 512 halves, as channels are read and written.
constexpr std::size_t kLarge = std::size_t{1} << 18;
/// More than the channels of a file with many lobes and mattes, which would push the layers out.
constexpr std::size_t kMostKept = 1024;
/// Layers of 4 channels of floats of 1920x1080 pixels are 32 MiB each.
constexpr std::size_t kMostKeptBytes = std::size_t{1} << 30;

struct Block {
  void* memory;
  std::size_t bytes;
};

/// Blocks without an owner, the oldest first.
struct Kept {
  // So that giving memory back needs none.
  Kept() { blocks.reserve(kMostKept + 1); }
  std::mutex mutex;
  std::vector<Block> blocks;
  std::size_t bytes = 0;
};

Kept& kept() {
  static Kept& blocks = *new Kept;  // never destroyed: images of static lifetime may outlive it
  return blocks;
}

/// Gives the oldest blocks back to the system until no more than so many, of so many bytes, are left.
void shrink(Kept& kept, std::size_t most, std::size_t most_bytes) {
  while (kept.blocks.size() > most || kept.bytes > most_bytes) {
    ::operator delete(kept.blocks.front().memory);
    kept.bytes -= kept.blocks.front().bytes;
    kept.blocks.erase(kept.blocks.begin());
  }
}

}  // namespace

void* take_pixel_memory(std::size_t bytes) {
  if (bytes < kLarge) return ::operator new(bytes);
  const std::scoped_lock lock(kept().mutex);
  std::vector<Block>& blocks = kept().blocks;
  const auto found = std::ranges::find(blocks.rbegin(), blocks.rend(), bytes, &Block::bytes);
  if (found != blocks.rend()) {
    void* const memory = found->memory;
    kept().bytes -= bytes;
    blocks.erase(std::next(found).base());
    return memory;
  }
  if (void* const memory = ::operator new(bytes, std::nothrow)) return memory;
  shrink(kept(), 0, 0);
  return ::operator new(bytes);
}

void give_back_pixel_memory(void* memory, std::size_t bytes) {
  if (bytes < kLarge) {
    ::operator delete(memory);
    return;
  }
  const std::scoped_lock lock(kept().mutex);
  kept().blocks.push_back({memory, bytes});
  kept().bytes += bytes;
  shrink(kept(), kMostKept, kMostKeptBytes);
}

}  // namespace becalm
