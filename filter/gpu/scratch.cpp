#include "filter/gpu/scratch.h"

#include <algorithm>

namespace becalm::gpu {

std::shared_ptr<const Scratch::Sizes> Scratch::reserve(const vk::raii::Device& device,
                                                       std::uint32_t memory_type, bool is_mapped,
                                                       Sizes bytes) {
  auto reservation = std::make_shared<const Sizes>(std::move(bytes));
  pools_[{memory_type, is_mapped}].reservations.emplace_back(reservation);
  arenas(device, memory_type, is_mapped);
  return reservation;
}

const Scratch::Arenas& Scratch::arenas(const vk::raii::Device& device, std::uint32_t memory_type,
                                       bool is_mapped) {
  Pool& pool = pools_[{memory_type, is_mapped}];
  std::erase_if(pool.reservations, [](const auto& reservation) { return reservation.expired(); });
  Sizes needed;
  for (const auto& reservation : pool.reservations) {
    const std::shared_ptr<const Sizes> sizes = reservation.lock();
    needed.resize(std::max(needed.size(), sizes->size()));
    for (std::size_t i = 0; i < sizes->size(); ++i) needed[i] = std::max(needed[i], (*sizes)[i]);
  }
  std::vector<Arena>& list = pool.arenas.list;
  needed.resize(std::max(needed.size(), list.size()));
  list.resize(needed.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].bytes == needed[i]) continue;
    list[i] = {};
    user = nullptr;
  }
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].bytes == needed[i]) continue;
    ++pool.arenas.version;
    list[i].memory = {device, vk::MemoryAllocateInfo(needed[i], memory_type)};
    if (is_mapped) list[i].mapped = static_cast<std::byte*>(list[i].memory.mapMemory(0, VK_WHOLE_SIZE));
    list[i].bytes = needed[i];
  }
  return pool.arenas;
}

}  // namespace becalm::gpu
