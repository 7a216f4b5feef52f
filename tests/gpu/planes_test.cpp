// Passes that write some planes each of an image that a storage buffer does not hold as a whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/gpu/device_impl.h"
#include "tests/gpu/device_error_of.h"
#include "tests/gpu/support.h"

namespace becalm::gpu {
namespace {

/// 256 bytes of floats a plane: every device can bind from each on.
constexpr Extent kPlane{8, 8};
constexpr Extent kImage{8, 8, 3};

class PlanesTest : public ::testing::Test {
 protected:
  /// A device of its own, so that its limits may be changed.
  PlanesTest()
      : device_({.select = "", .validation = true}),
        chain_(device_, "planes", test_options()),
        fine_(chain_.input("fine", Format::f32, kPlane)),
        scaled_(chain_.image("scaled", Format::f32, kImage)) {}
  void TearDown() override { EXPECT_TRUE(device_.validation_messages().empty()); }

  void write(Planes planes, int gain) {
    chain_.pass("kernels/scale")
        .read("fine", fine_)
        .write("scaled", scaled_, planes)
        .specialize("gain", gain)
        .constants(ScaleParams{kPlane.width, kPlane.height})
        .dispatch(kPlane);
  }
  std::string error() {
    chain_.output(scaled_);
    return device_error_of([&] { chain_.build(); });
  }

  Device device_;
  Chain chain_;
  ImageId fine_, scaled_;
};

TEST_F(PlanesTest, ArePartsOfOneImage) {
  const auto plane_bytes = static_cast<std::uint32_t>(kPlane.elements() * sizeof(float));
  device_.impl().limits.maxStorageBufferRange = plane_bytes;
  for (const int plane : {0, 1, 2}) write({plane, 1}, plane + 1);
  ASSERT_EQ(error(), "no error");
  std::ranges::fill(chain_.upload<float>(fine_), 0.5f);
  chain_.run();
  std::vector<float> expected;
  for (const int gain : {1, 2, 3}) expected.insert(expected.end(), kPlane.elements(), 10.0f + 0.5f * gain);
  const auto made = chain_.download<float>(scaled_);
  EXPECT_EQ(std::vector<float>(made.begin(), made.end()), expected);
}

TEST_F(PlanesTest, LeaveNoGap) {
  write({0, 1}, 1);
  write({2, 1}, 1);
  EXPECT_EQ(error(),
            "chain 'planes': pass 1 'kernels/scale': binding 'scaled': image 'scaled' of 8x8x3 is written at "
            "planes 2 to 2, after 1 planes");
}

TEST_F(PlanesTest, EndWithTheImage) {
  write({0, 2}, 1);
  write({2, 2}, 1);
  EXPECT_EQ(error(),
            "chain 'planes': pass 1 'kernels/scale': binding 'scaled': image 'scaled' of 8x8x3 is written at "
            "planes 2 to 3, after 2 planes");
}

TEST_F(PlanesTest, AreAllWritten) {
  write({0, 1}, 1);
  write({1, 1}, 1);
  EXPECT_EQ(error(), "chain 'planes': image 'scaled' is an output, but no pass writes it");
}

TEST_F(PlanesTest, BeginWhereTheDeviceCanBindThem) {
  device_.impl().limits.minStorageBufferOffsetAlignment = 512;
  write({0, 1}, 1);
  write({1, 2}, 1);
  EXPECT_EQ(error(),
            "chain 'planes': pass 1 'kernels/scale': binding 'scaled': image 'scaled' of 8x8x3 is written at "
            "planes 1 to 2, which do not begin where the device can bind them");
}

}  // namespace
}  // namespace becalm::gpu
