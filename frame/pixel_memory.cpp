#include "frame/pixel_memory.h"

#include <algorithm>
#include <mutex>
#include <new>
#include <vector>

namespace becalm {
namespace {

constexpr std::size_t kLarge = std::size_t{1} << 20;
/// As many layers as two frames in turn give back.
constexpr std::size_t kMostKept = 12;

struct Block {
  void* memory;
  std::size_t bytes;
};

/// Blocks without an owner, the oldest first.
struct Kept {
  std::mutex mutex;
  std::vector<Block> blocks;
};

Kept& kept() {
  static Kept& blocks = *new Kept;  // never destroyed: images of static lifetime may outlive it
  return blocks;
}

}  // namespace

void* take_pixel_memory(std::size_t bytes) {
  if (bytes >= kLarge) {
    const std::scoped_lock lock(kept().mutex);
    std::vector<Block>& blocks = kept().blocks;
    const auto found = std::ranges::find(blocks.rbegin(), blocks.rend(), bytes, &Block::bytes);
    if (found != blocks.rend()) {
      void* const memory = found->memory;
      blocks.erase(std::next(found).base());
      return memory;
    }
  }
  return ::operator new(bytes);
}

void give_back_pixel_memory(void* memory, std::size_t bytes) {
  if (bytes >= kLarge) {
    const std::scoped_lock lock(kept().mutex);
    std::vector<Block>& blocks = kept().blocks;
    blocks.push_back({memory, bytes});
    if (blocks.size() <= kMostKept) return;
    memory = blocks.front().memory;
    blocks.erase(blocks.begin());
  }
  ::operator delete(memory);
}

}  // namespace becalm
