// Checks that synchronization validation reports a missing barrier, also between images that share memory.
// The other tests rely on it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "filter/gpu/device_impl.h"
#include "tests/gpu/support.h"

namespace becalm::gpu {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kBytes = 1024;

/// Two buffers on the same memory, a third apart, and a command buffer that is being recorded.
struct Recording {
  Recording() : device({.select = "", .validation = true}) {
    const Device::Impl& d = device.impl();
    using Usage = vk::BufferUsageFlagBits;
    const vk::BufferCreateInfo create({}, kBytes, Usage::eTransferSrc | Usage::eTransferDst);
    for (vk::raii::Buffer* buffer : {&one, &alias_of_one, &apart}) *buffer = {d.device, create};
    const auto needs = one.getMemoryRequirements();
    const auto type = d.memory_type(needs.memoryTypeBits, {}, vk::MemoryPropertyFlagBits::eDeviceLocal);
    for (vk::raii::DeviceMemory* memory : {&shared_memory, &other_memory}) {
      *memory = {d.device, vk::MemoryAllocateInfo(needs.size, type)};
    }
    one.bindMemory(*shared_memory, 0);
    alias_of_one.bindMemory(*shared_memory, 0);
    apart.bindMemory(*other_memory, 0);
    pool = {d.device, vk::CommandPoolCreateInfo({}, d.queue_family)};
    auto allocated = d.device.allocateCommandBuffers({*pool, vk::CommandBufferLevel::ePrimary, 1});
    commands = std::move(allocated[0]);
    commands.begin(vk::CommandBufferBeginInfo());
  }
  void copy(const vk::raii::Buffer& from, const vk::raii::Buffer& to) const {
    commands.copyBuffer(*from, *to, vk::BufferCopy(0, 0, kBytes));
  }
  void barrier() const {
    const vk::MemoryBarrier2 memory(vk::PipelineStageFlagBits2::eCopy, vk::AccessFlagBits2::eTransferWrite,
                                    vk::PipelineStageFlagBits2::eCopy,
                                    vk::AccessFlagBits2::eTransferRead | vk::AccessFlagBits2::eTransferWrite);
    commands.pipelineBarrier2(vk::DependencyInfo({}, memory));
  }
  Device device;
  vk::raii::DeviceMemory shared_memory = nullptr;
  vk::raii::DeviceMemory other_memory = nullptr;
  vk::raii::Buffer one = nullptr;
  vk::raii::Buffer alias_of_one = nullptr;
  vk::raii::Buffer apart = nullptr;
  vk::raii::CommandPool pool = nullptr;
  vk::raii::CommandBuffer commands = nullptr;
};

TEST(Synchronization, MessagesComeForAMissingBarrier) {
  const Recording r;
  r.copy(r.one, r.apart);
  r.copy(r.apart, r.one);
  ASSERT_FALSE(r.device.validation_messages().empty());
  EXPECT_THAT(r.device.validation_messages()[0], HasSubstr("SYNC-HAZARD"));
  try {
    r.device.impl().check_validation("chain 'broken'");
    FAIL() << "no error";
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("chain 'broken': validation: "));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(Synchronization, MessagesComeForAMissingBarrierBetweenImagesThatShareMemory) {
  const Recording r;
  r.copy(r.apart, r.one);
  r.copy(r.alias_of_one, r.apart);
  ASSERT_FALSE(r.device.validation_messages().empty());
  EXPECT_THAT(r.device.validation_messages()[0], HasSubstr("SYNC-HAZARD"));
}

TEST(Synchronization, NoMessagesComeWithTheBarrier) {
  const Recording r;
  r.copy(r.apart, r.one);
  r.barrier();
  r.copy(r.alias_of_one, r.apart);
  EXPECT_THAT(r.device.validation_messages(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace becalm::gpu
