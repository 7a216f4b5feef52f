// What chains compute: whole chains against the same arithmetic on the CPU, under synchronization validation.
#include "filter/gpu/chain.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "tests/gpu/support.h"

namespace becalm::gpu {
namespace {

/// scaled = gain * fine + bias of a ramp, for odd sizes and sizes around the workgroup's 8x8.
TEST(Chain, RunsAKernelOnEveryPixelOfAnyExtent) {
  for (const Extent extent : {Extent{1, 1}, Extent{8, 8}, Extent{9, 7}, Extent{7, 9}, Extent{129, 67}}) {
    Chain chain(validated_device(), "scale", test_options());
    const ImageId fine = chain.input("fine", Format::f32, extent);
    const ImageId scaled = chain.image("scaled", Format::f32, extent);
    chain.pass("kernels/scale")
        .read("fine", fine)
        .write("scaled", scaled)
        .constants(ScaleParams{extent.width, extent.height})
        .dispatch(extent);
    chain.output(scaled);
    chain.build();
    const auto values = chain.upload<float>(fine);
    ASSERT_EQ(values.size(), extent.elements());
    std::iota(values.begin(), values.end(), 1.0f);
    chain.run();
    const auto result = chain.download<float>(scaled);
    ASSERT_EQ(result.size(), extent.elements());
    for (std::size_t i = 0; i < result.size(); ++i) ASSERT_EQ(result[i], static_cast<float>(i) + 11.0f) << i;
  }
  EXPECT_TRUE(validated_device().validation_messages().empty());
}

}  // namespace
}  // namespace becalm::gpu
