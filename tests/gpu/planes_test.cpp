// Images that a storage buffer does not hold as a whole, written plane by plane.
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

  void write(int plane, int gain = 1) {
    chain_.pass("kernels/scale")
        .read("fine", fine_)
        .write_plane("scaled", scaled_, plane)
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
  for (const int plane : {0, 1, 2}) write(plane, plane + 1);
  ASSERT_EQ(error(), "no error");
  std::ranges::fill(chain_.upload<float>(fine_), 0.5f);
  chain_.run();
  std::vector<float> expected;
  for (const int gain : {1, 2, 3}) expected.insert(expected.end(), kPlane.elements(), 10.0f + 0.5f * gain);
  const auto made = chain_.download<float>(scaled_);
  EXPECT_EQ(std::vector<float>(made.begin(), made.end()), expected);
}

TEST_F(PlanesTest, LeaveNoGap) {
  write(0);
  write(2);
  EXPECT_EQ(error(),
            "chain 'planes': pass 1 'kernels/scale': binding 'scaled': plane 2 of image 'scaled' of 8x8x3 is "
            "written after 1 planes");
}

TEST_F(PlanesTest, EndWithTheImage) {
  for (const int plane : {0, 1, 2, 3}) write(plane);
  EXPECT_EQ(
      error(),
      "chain 'planes': pass 3 'kernels/scale': binding 'scaled': plane 3 of image 'scaled' of 8x8x3 does "
      "not exist");
}

TEST_F(PlanesTest, AreAllWritten) {
  write(0);
  write(1);
  EXPECT_EQ(error(), "chain 'planes': image 'scaled' is an output, but no pass writes it");
}

TEST_F(PlanesTest, BeginWhereTheDeviceCanBindThem) {
  device_.impl().limits.minStorageBufferOffsetAlignment = 512;
  write(0);
  write(1);
  EXPECT_EQ(error(),
            "chain 'planes': pass 0 'kernels/scale': binding 'scaled': plane 0 of image 'scaled' of 8x8x3 "
            "begins where the device cannot bind it");
}

}  // namespace
}  // namespace becalm::gpu
