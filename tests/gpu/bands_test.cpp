// Passes that write more than a storage buffer holds: made in bands of rows, with the results of one
// dispatch.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/gpu/device_impl.h"
#include "tests/gpu/device_error_of.h"
#include "tests/gpu/support.h"

namespace becalm::gpu {
namespace {

using ::testing::StartsWith;

struct SpreadParams {
  std::int32_t factor;
};

/// What kernels/spread makes of a ramp.
struct Spread {
  std::vector<float> wide, sum, copy;
};

class BandsTest : public ::testing::Test {
 protected:
  /// A device of its own, so that its limits may be changed.
  BandsTest() : device_({.select = "", .validation = true}) {}
  void TearDown() override { EXPECT_TRUE(device_.validation_messages().empty()); }

  void set_limit(std::uint64_t bytes) {
    device_.impl().limits.maxStorageBufferRange = static_cast<std::uint32_t>(bytes);
  }
  Spread spread(Extent extent, bool has_copy) {
    Chain chain(device_, "bands", test_options());
    const ImageId narrow = chain.input("narrow", Format::f32, extent);
    const ImageId wide = chain.image("wide", Format::f32x4, extent);
    const ImageId sum = chain.image("sum", Format::f32x2, extent);
    std::optional<ImageId> copy;
    if (has_copy) copy = chain.image("copy", Format::f32, extent);
    chain.fill(sum, 0.5f);
    chain.pass("kernels/spread")
        .read("narrow", narrow, reach(0, 1))
        .write("wide", wide)
        .read_write("sum", sum)
        .write("copy", copy)
        .specialize("has_copy", has_copy ? 1 : 0)
        .constants(SpreadParams{.factor = 3})
        .dispatch(extent);
    chain.output(wide);
    chain.output(sum);
    if (copy) chain.output(*copy);
    chain.build();
    std::ranges::generate(chain.upload<float>(narrow), [i = 0]() mutable { return float(i++ % 4099); });
    chain.run();
    const auto values = [&](ImageId image) {
      const auto made = chain.download<float>(image);
      return std::vector<float>(made.begin(), made.end());
    };
    return {values(wide), values(sum), copy ? values(*copy) : std::vector<float>()};
  }
  static void expect_spread(const Spread& made, Extent extent, bool has_copy) {
    const auto x = [&](int row, int column) {
      return 3.0f * static_cast<float>((row * extent.width + column) % 4099);
    };
    ASSERT_EQ(made.wide.size(), 4 * extent.elements());
    ASSERT_EQ(made.copy.size(), has_copy ? extent.elements() : 0);
    std::size_t i = 0;
    for (int row = 0; row < extent.height; ++row) {
      for (int column = 0; column < extent.width; ++column, ++i) {
        const float here = x(row, column);
        const std::array wide{here, 2.0f * here, 3.0f * here,
                              x(std::min(row + 1, extent.height - 1), column)};
        ASSERT_TRUE(
            std::equal(wide.begin(), wide.end(), made.wide.begin() + static_cast<std::ptrdiff_t>(4 * i)))
            << "row " << row << ", column " << column;
        ASSERT_EQ(made.sum[2 * i], 0.5f + here) << "row " << row << ", column " << column;
        ASSERT_EQ(made.sum[2 * i + 1], 0.5f - here) << "row " << row << ", column " << column;
        if (has_copy) {
          ASSERT_EQ(made.copy[i], here) << "row " << row << ", column " << column;
        }
      }
    }
  }
  Device device_;
};

TEST_F(BandsTest, MakeEveryRowOnce) {
  constexpr int width = 37;
  for (const int rows : {64, 127, 128, 200}) {  // that fit in a storage buffer
    set_limit(std::uint64_t{16} * width * static_cast<std::uint64_t>(rows));
    for (const int height : {1, 64, 65, 128, 129, 191, 200, 201, 320}) {
      for (const bool has_copy : {false, true}) {
        SCOPED_TRACE(std::to_string(height) + " rows, " + std::to_string(rows) + " at once");
        expect_spread(spread({width, height}, has_copy), {width, height}, has_copy);
      }
    }
  }
}

TEST_F(BandsTest, WriteImagesLargerThanAnyStorageBuffer) {
  const std::uint64_t limit = device_.info().max_storage_buffer_bytes;
  if (limit > std::uint64_t{1} << 30) {
    GTEST_SKIP() << "a storage buffer may hold " << limit
                 << " bytes: a larger image exceeds other limits first";
  }
  const Extent extent{1021, static_cast<int>(limit / (16 * 1021)) + 1};
  expect_spread(spread(extent, false), extent, false);
}

TEST_F(BandsTest, FailIfTheFewestRowsAreTooLarge) {
  constexpr int width = 37;
  set_limit(16 * width * 64 - 1);
  EXPECT_THAT(
      device_error_of([&] {
        spread({width, 65}, false);
      }),
      StartsWith("chain 'bands': pass 1 'kernels/spread': binding 'wide': image 'wide' of 37x65 vec4 "));
}

TEST_F(BandsTest, WantImagesOfTheDispatchesSize) {
  for (const Extent other : {Extent{8, 9}, Extent{8, 8, 2}}) {
    Chain chain(device_, "bands", test_options());
    const ImageId narrow = chain.input("narrow", Format::f32, {8, 8});
    const ImageId wide = chain.image("wide", Format::f32x4, other);
    const ImageId sum = chain.image("sum", Format::f32x2, {8, 8});
    chain.fill(sum, 0.0f);
    chain.pass("kernels/spread")
        .read("narrow", narrow, reach(0, 1))
        .write("wide", wide)
        .read_write("sum", sum)
        .write("copy", std::nullopt)
        .constants(SpreadParams{.factor = 3})
        .dispatch({8, 8});
    EXPECT_EQ(
        device_error_of([&] { chain.plan(); }),
        "chain 'bands': pass 1 'kernels/spread': image 'wide' is written row by row, and is not one plane "
        "of the dispatch's size");
  }
}

}  // namespace
}  // namespace becalm::gpu
