// Every mistake in a chain's declaration gives one line that names the pass and what is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "filter/gpu/chain.h"
#include "filter/gpu/device_impl.h"
#include "tests/gpu/device_error_of.h"
#include "tests/gpu/support.h"

namespace becalm::gpu {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr Extent kExtent{16, 16};

/// A chain with one correct pass of kernels/scale, in which each test makes one mistake.
class ChainErrors : public ::testing::Test {
 protected:
  ChainErrors() : chain_(validated_device(), "wrong", test_options()) {
    fine_ = chain_.input("fine", Format::f32, kExtent);
    scaled_ = chain_.image("scaled", Format::f32, kExtent);
  }
  Chain::Pass scale(ImageId fine, ImageId scaled) {
    auto pass = chain_.pass("kernels/scale");
    pass.read("fine", fine).write("scaled", scaled).constants(ScaleParams{16, 16});
    return pass;
  }
  void expect_build_error(const std::string& message) {
    EXPECT_EQ(device_error_of([&] { chain_.build(); }), "chain 'wrong': " + message);
  }
  Chain chain_;
  ImageId fine_;
  ImageId scaled_;
};

TEST_F(ChainErrors, AreNotThrownForACorrectChain) {
  scale(fine_, scaled_).dispatch(kExtent);
  EXPECT_EQ(device_error_of([&] { chain_.build(); }), "no error");
}

TEST_F(ChainErrors, NameAnUnknownKernel) {
  chain_.pass("kernels/scael").dispatch(kExtent);
  expect_build_error("pass 0 'kernels/scael': there is no such kernel");
}

TEST_F(ChainErrors, NameABindingTheKernelDoesNotHave) {
  auto pass = chain_.pass("kernels/scale");
  pass.read("coarse", fine_).write("scaled", scaled_).constants(ScaleParams{}).dispatch(kExtent);
  expect_build_error(
      "pass 0 'kernels/scale': binding 'coarse': the kernel has no such binding; it has: scaled, fine");
}

TEST_F(ChainErrors, NameABindingWithoutAnImage) {
  chain_.pass("kernels/scale").write("scaled", scaled_).constants(ScaleParams{}).dispatch(kExtent);
  expect_build_error("pass 0 'kernels/scale': binding 'fine' has no image");
}

TEST_F(ChainErrors, NameABindingThatIsLeftWithoutAnImageAndCannotBe) {
  scale(fine_, scaled_).read("fine", std::nullopt).dispatch(kExtent);
  expect_build_error("pass 0 'kernels/scale': binding 'fine' is both given an image and left without one");
}

TEST_F(ChainErrors, NameAnUnknownBindingThatIsLeftWithoutAnImage) {
  scale(fine_, scaled_).read("coarse", std::nullopt).dispatch(kExtent);
  expect_build_error(
      "pass 0 'kernels/scale': binding 'coarse' is left without an image, and the kernel has no such "
      "binding");
}

TEST_F(ChainErrors, NameAnImageFilledThatIsAnInput) {
  chain_.fill(fine_, 0.0f);
  expect_build_error("pass 0 'fill': image 'fine' is an input and cannot be written");
}

TEST_F(ChainErrors, NameABindingGivenTwice) {
  scale(fine_, scaled_).read("fine", fine_).dispatch(kExtent);
  expect_build_error("pass 0 'kernels/scale': binding 'fine' is given twice");
}

TEST_F(ChainErrors, NameBothFormatsThatDoNotMatch) {
  const ImageId color = chain_.input("color", Format::f32x4, kExtent);
  scale(color, scaled_).dispatch(kExtent);
  expect_build_error(
      "pass 0 'kernels/scale': binding 'fine': the kernel's elements are float, those of image 'color' vec4");
}

TEST_F(ChainErrors, NameAccessThatDoesNotMatch) {
  auto pass = chain_.pass("kernels/scale");
  pass.read("fine", fine_).read_write("scaled", scaled_).constants(ScaleParams{}).dispatch(kExtent);
  expect_build_error(
      "pass 0 'kernels/scale': binding 'scaled': the kernel's access is write, the pass declares read_write");
}

TEST_F(ChainErrors, NameAnImageReadBeforeItIsWritten) {
  const ImageId other = chain_.image("other", Format::f32, kExtent);
  scale(other, scaled_).dispatch(kExtent);
  scale(fine_, other).dispatch(kExtent);
  expect_build_error(
      "pass 0 'kernels/scale': binding 'fine': image 'other' is read before any pass writes it");
}

TEST_F(ChainErrors, NameAHistoryReadBeforeItIsWritten) {
  const History history = chain_.history("total", Format::f32, kExtent);
  scale(history.next, scaled_).dispatch(kExtent);
  expect_build_error(
      "pass 0 'kernels/scale': binding 'fine': image 'total.next' is read before any pass writes it");
}

TEST_F(ChainErrors, NameAnInputThatIsWritten) {
  const ImageId other = chain_.input("other", Format::f32, kExtent);
  scale(fine_, other).dispatch(kExtent);
  expect_build_error(
      "pass 0 'kernels/scale': binding 'scaled': image 'other' is an input and cannot be written");
}

TEST_F(ChainErrors, NameAPreviousFrameThatIsWritten) {
  const History history = chain_.history("total", Format::f32, kExtent);
  scale(fine_, history.previous).dispatch(kExtent);
  expect_build_error(
      "pass 0 'kernels/scale': binding 'scaled': image 'total.prev' is the previous frame's and cannot be "
      "written");
}

TEST_F(ChainErrors, NameAHistoryThatNobodyWrites) {
  const History history = chain_.history("total", Format::f32, kExtent);
  scale(history.previous, scaled_).dispatch(kExtent);
  expect_build_error("image 'total.next' is a history's, but no pass writes it");
}

TEST_F(ChainErrors, NameAnOutputThatNobodyWrites) {
  scale(fine_, scaled_).dispatch(kExtent);
  chain_.output(chain_.image("lost", Format::f32, kExtent));
  expect_build_error("image 'lost' is an output, but no pass writes it");
}

TEST_F(ChainErrors, NameAnImageReadAndWrittenAtOnce) {
  scale(fine_, scaled_).dispatch(kExtent);
  scale(scaled_, scaled_).dispatch(kExtent);
  expect_build_error(
      "pass 1 'kernels/scale': image 'scaled' is written as 'scaled' and used as 'fine' at once");
}

TEST_F(ChainErrors, NameTheSizesOfConstants) {
  scale(fine_, scaled_).constants(MixParams{}).dispatch(kExtent);
  expect_build_error("pass 0 'kernels/scale': the constants take 24 bytes, the kernel's take 8");
}

TEST_F(ChainErrors, NameAnUnknownSpecializationConstant) {
  scale(fine_, scaled_).specialize("radius", 1).dispatch(kExtent);
  expect_build_error("pass 0 'kernels/scale': the kernel has no specialization constant 'radius'");
}

TEST_F(ChainErrors, NameASpecializationConstantGivenTwice) {
  scale(fine_, scaled_).specialize("bias", 1).specialize("bias", 2).dispatch(kExtent);
  expect_build_error("pass 0 'kernels/scale': specialization constant 'bias' is given twice");
}

TEST_F(ChainErrors, NameAPassThatIsNeverDispatched) {
  static_cast<void>(scale(fine_, scaled_));
  expect_build_error("pass 0 'kernels/scale': is never dispatched");
}

TEST_F(ChainErrors, NameAnEmptyDispatch) {
  scale(fine_, scaled_).dispatch({16, 0});
  expect_build_error("pass 0 'kernels/scale': the dispatch of 16x0 is empty");
}

TEST_F(ChainErrors, NameADispatchBeyondTheDevicesLimit) {
  scale(fine_, scaled_).dispatch({16, 2'000'000'000});
  EXPECT_THAT(
      device_error_of([&] { chain_.build(); }),
      StartsWith("chain 'wrong': pass 0 'kernels/scale': the dispatch of 16x2000000000 takes 250000000 "
                 "workgroups along axis 1, the device's limit is "));
}

TEST_F(ChainErrors, NameAnImageLargerThanTheDeviceCanBind) {
  const ImageId huge = chain_.input("huge", Format::f32x4, {200'000, 200'000});
  chain_.pass("kernels/split").read("color", huge).dispatch(kExtent);
  EXPECT_THAT(
      device_error_of([&] { chain_.build(); }),
      StartsWith("chain 'wrong': image 'huge' of 200000x200000 vec4 takes 610351.6 MiB, more than the "));
}

TEST_F(ChainErrors, NameAnImageThatIsTooLargeForAStorageBuffer) {
  // Images that are only read as texels may be larger. On devices that allow storage buffers of gigabytes, a
  // larger image would exceed other limits first. Mesa's software device, which CI uses, allows less.
  const std::uint64_t limit = validated_device().info().max_storage_buffer_bytes;
  if (limit > std::uint64_t{1} << 30)
    GTEST_SKIP() << "a storage buffer may hold " << limit
                 << " bytes: a larger image exceeds other limits first";
  const Extent large{1024, static_cast<int>(limit / 4096) + 1};
  const ImageId a = chain_.input("a", Format::f32, kExtent);
  const ImageId texels = chain_.input("texels", Format::f32, large);
  const ImageId result = chain_.image("result", Format::f32, kExtent);
  chain_.pass("kernels/mix")
      .read("a", a)
      .read("b", texels)
      .write("result", result)
      .constants(MixParams{})
      .dispatch(kExtent);
  const ImageId written = chain_.image("written", Format::f32, large);
  scale(fine_, written).dispatch(kExtent);
  EXPECT_THAT(
      device_error_of([&] { chain_.plan(); }),
      StartsWith("chain 'wrong': pass 1 'kernels/scale': binding 'scaled': image 'written' of 1024x"));
}

TEST_F(ChainErrors, NameAnImageThatIsTooLargeOnlyOnceItIsAligned) {
  Device device;
  device.impl().max_allocation_bytes = 17 * sizeof(float);
  ChainOptions options = test_options();
  options.transfers = Transfers::staged;
  Chain chain(device, "narrow", options);
  const ImageId fine = chain.input("fine", Format::f32, {17, 1});
  const ImageId scaled = chain.image("scaled", Format::f32, {17, 1});
  chain.pass("kernels/scale")
      .read("fine", fine)
      .write("scaled", scaled)
      .constants(ScaleParams{17, 1})
      .dispatch({17, 1});
  chain.output(scaled);
  EXPECT_THROW(chain.plan(), DeviceLimitError);
}

TEST_F(ChainErrors, NameAWorkgroupBeyondTheDevicesLimit) {
  Device device;
  device.impl().limits.maxComputeWorkGroupSize[0] = 1;
  Chain chain(device, "wide", test_options());
  const ImageId fine = chain.input("fine", Format::f32, kExtent);
  const ImageId scaled = chain.image("scaled", Format::f32, kExtent);
  chain.pass("kernels/scale")
      .read("fine", fine)
      .write("scaled", scaled)
      .constants(ScaleParams{16, 16})
      .dispatch(kExtent);
  EXPECT_THAT(device_error_of([&] { chain.plan(); }), HasSubstr("along axis 0, the device's limit is 1"));
}

TEST_F(ChainErrors, TellMissingMemoryFromOthers) {
  EXPECT_THROW(guarded("it", [] { throw vk::OutOfDeviceMemoryError("refused"); }), DeviceMemoryError);
  EXPECT_EQ(device_error_of([] { guarded("it", [] { throw vk::OutOfHostMemoryError("refused"); }); }),
            "it: the host's memory is used up; other programs may hold it");
  EXPECT_EQ(
      device_error_of([] { guarded("it", [] { throw vk::InitializationFailedError("no"); }); }).substr(0, 6),
      "it: no");
}

TEST_F(ChainErrors, NameAnImageOfAnotherChain) {
  scale({77}, scaled_).dispatch(kExtent);
  expect_build_error("image id 77 is not of this chain");
}

TEST_F(ChainErrors, NameAnEmptyChain) {
  expect_build_error("has no passes");
}

TEST_F(ChainErrors, ComeAtOnceForImpossibleImages) {
  EXPECT_EQ(device_error_of([&] {
              chain_.image("flat", Format::f32, {4, 0});
            }),
            "chain 'wrong': image 'flat': width, height and planes must be positive, not 4x0x1");
  EXPECT_EQ(device_error_of([&] { chain_.image("fine", Format::f32, kExtent); }),
            "chain 'wrong': image 'fine': is declared twice");
}

TEST_F(ChainErrors, ComeForUseOutOfOrder) {
  scale(fine_, scaled_).dispatch(kExtent);
  EXPECT_EQ(device_error_of([&] { chain_.run(); }), "chain 'wrong': cannot run before it is built");
  EXPECT_EQ(device_error_of([&] { chain_.upload<float>(fine_); }),
            "chain 'wrong': upload of 'fine': the chain is not built yet");
  EXPECT_EQ(device_error_of([&] { static_cast<void>(chain_.download<float>(scaled_)); }),
            "chain 'wrong': download of 'scaled': it is not an output");
  chain_.output(scaled_);
  chain_.build();
  EXPECT_EQ(device_error_of([&] { chain_.upload<float>(scaled_); }),
            "chain 'wrong': upload of 'scaled': it is not an input");
  EXPECT_EQ(device_error_of([&] { static_cast<void>(chain_.download<float>(scaled_)); }),
            "chain 'wrong': download of 'scaled': the chain has not run yet");
  EXPECT_EQ(device_error_of([&] { chain_.run(); }),
            "chain 'wrong': input 'fine' was not uploaded for this run");
  EXPECT_THAT(device_error_of([&] { chain_.pass("kernels/scale"); }), HasSubstr("is built already"));
  EXPECT_THAT(device_error_of([&] { chain_.build(); }), HasSubstr("is built already"));
}

}  // namespace
}  // namespace becalm::gpu
