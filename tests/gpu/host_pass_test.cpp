// Host passes: the values that they read, their order, and errors in their declaration. random_chain_test.cpp
// mixes them with other passes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include "filter/gpu/chain.h"
#include "tests/gpu/device_error_of.h"
#include "tests/gpu/support.h"

namespace becalm::gpu {
namespace {

using HostImages = Chain::HostImages;

constexpr Extent kExtent{19, 5};

class HostPassTest : public ::testing::Test {
 protected:
  HostPassTest() : chain_(validated_device(), "host", test_options()) {
    input_ = chain_.input("input", Format::f32, kExtent);
    made_ = chain_.image("made", Format::f32, kExtent);
  }
  void SetUp() override {
    if (!validated_device().info().is_processor)
      GTEST_SKIP() << "host passes read the memory of software devices only";
  }
  void TearDown() override { EXPECT_TRUE(validated_device().validation_messages().empty()); }

  /// 2 x + 10, by the device.
  void add_scale(ImageId from, ImageId to) {
    chain_.pass("kernels/scale")
        .read("fine", from)
        .write("scaled", to)
        .constants(ScaleParams{kExtent.width, kExtent.height})
        .specialize("gain", 2)
        .dispatch(kExtent);
  }
  /// x + `term`, by the host.
  void add_term(ImageId from, ImageId to, float term) {
    chain_.host_pass("add").read(from).write(to).run([=](const HostImages& host) {
      std::ranges::transform(host.read<float>(from), host.write<float>(to).begin(),
                             [&](float x) { return x + term; });
    });
  }
  float run(ImageId output, float value) {
    std::ranges::fill(chain_.upload<float>(input_), value);
    chain_.run();
    const auto result = chain_.download<float>(output);
    EXPECT_EQ(result.size(), kExtent.elements());
    EXPECT_TRUE(std::ranges::all_of(result, [&](float r) { return r == result[0]; }));
    return result[0];
  }

  Chain chain_;
  ImageId input_;
  ImageId made_;
};

TEST_F(HostPassTest, RunsBetweenThePassesAroundIt) {
  const ImageId scaled = chain_.image("scaled", Format::f32, kExtent);
  const ImageId added = chain_.image("added", Format::f32, kExtent);
  add_scale(input_, scaled);
  add_term(scaled, added, 5.0f);
  add_scale(added, made_);
  chain_.output(made_);
  chain_.build();
  for (const float x : {1.0f, 4.0f, 2.0f}) EXPECT_EQ(run(made_, x), 2 * (2 * x + 15) + 10);
}

TEST_F(HostPassTest, ReadsInputsAndWritesOutputsInChainsWithoutKernels) {
  const ImageId between = chain_.image("between", Format::f32, kExtent);
  add_term(input_, between, 5.0f);
  add_term(between, made_, 7.0f);
  chain_.output(between);
  chain_.output(made_);
  chain_.build();
  for (const float x : {1.0f, 4.0f}) {
    EXPECT_EQ(run(made_, x), x + 12);
    EXPECT_EQ(chain_.download<float>(between)[0], x + 5);
  }
}

TEST_F(HostPassTest, HandsAHistoryFromFrameToFrame) {
  const History sum = chain_.history("sum", Format::f32, kExtent);
  chain_.host_pass("sum")
      .read(input_)
      .read(sum.previous)
      .write(sum.next)
      .run([=, this](const HostImages& host) {
        std::ranges::transform(host.read<float>(input_), host.read<float>(sum.previous),
                               host.write<float>(sum.next).begin(), std::plus<>());
      });
  chain_.output(sum.next);
  chain_.build();
  EXPECT_EQ(run(sum.next, 1), 1);
  EXPECT_EQ(run(sum.next, 2), 3);
  EXPECT_EQ(run(sum.next, 4), 7);
  chain_.reset_history();
  EXPECT_EQ(run(sum.next, 8), 8);
}

TEST_F(HostPassTest, SharesMemoryAsOtherPassesDo) {
  ImageId last = input_;
  float expected = 1.0f;
  for (int i = 0; i < 12; ++i) {
    const ImageId next = chain_.image("L" + std::to_string(i), Format::f32, kExtent);
    i % 2 == 0 ? add_scale(last, next) : add_term(last, next, 1.0f);
    expected = i % 2 == 0 ? 2.0f * expected + 10.0f : expected + 1.0f;
    last = next;
  }
  chain_.output(last);
  chain_.build();
  EXPECT_LT(chain_.device_bytes().total(), chain_.device_bytes_unaliased() / 3);
  EXPECT_EQ(run(last, 1), expected);
}

TEST_F(HostPassTest, IsTimedAndNamed) {
  add_scale(input_, made_);
  chain_.host_pass("sleep").read(made_).run(
      [](const HostImages&) { std::this_thread::sleep_for(std::chrono::milliseconds(20)); });
  chain_.build();
  std::ranges::fill(chain_.upload<float>(input_), 1.0f);
  chain_.run();
  ASSERT_EQ(chain_.times().size(), 2u);
  EXPECT_EQ(chain_.times()[1].name, "sleep");
  EXPECT_GE(chain_.times()[1].milliseconds, 20.0);
  EXPECT_EQ(chain_.times()[1].image_bytes, kExtent.elements() * sizeof(float));
}

TEST_F(HostPassTest, ThrowsAndMayRunAgain) {
  bool fails = true;
  chain_.host_pass("fail").read(input_).write(made_).run([&](const HostImages& host) {
    if (fails) throw std::runtime_error("failed");
    std::ranges::copy(host.read<float>(input_), host.write<float>(made_).begin());
  });
  chain_.output(made_);
  chain_.build();
  std::ranges::fill(chain_.upload<float>(input_), 1.0f);
  EXPECT_THROW(chain_.run(), std::runtime_error);
  fails = false;
  EXPECT_EQ(run(made_, 3.0f), 3.0f);
}

TEST_F(HostPassTest, DoesNotGoOnWithAHistoryThatAFailedRunOverwrote) {
  bool fails = false;
  const History sum = chain_.history("sum", Format::f32, kExtent);
  const ImageId added = chain_.image("added", Format::f32, kExtent);
  chain_.host_pass("add").read(input_).read(sum.previous).write(added).run([=, this](const HostImages& host) {
    std::ranges::transform(host.read<float>(input_), host.read<float>(sum.previous),
                           host.write<float>(added).begin(), std::plus<>());
  });
  chain_.host_pass("keep").read(added).write(sum.next).run([&, sum, added](const HostImages& host) {
    std::ranges::copy(host.read<float>(added), host.write<float>(sum.next).begin());
    if (fails) throw std::runtime_error("failed");
  });
  chain_.output(sum.next);
  chain_.build();
  EXPECT_EQ(run(sum.next, 1), 1);
  EXPECT_EQ(run(sum.next, 2), 3);
  fails = true;
  EXPECT_THROW(run(sum.next, 4), std::runtime_error);
  EXPECT_THROW(static_cast<void>(chain_.download<float>(sum.next)), DeviceError);
  fails = false;
  EXPECT_NE(device_error_of([&] { run(sum.next, 4); }).find("has overwritten its history"),
            std::string::npos);
  chain_.reset_history();
  EXPECT_EQ(run(sum.next, 8), 8);
}

TEST_F(HostPassTest, MistakesAreNamed) {
  const auto build_error = [](const std::function<void(Chain&, ImageId, ImageId)>& declare) {
    Chain chain(validated_device(), "wrong", test_options());
    const ImageId input = chain.input("input", Format::f32, kExtent);
    const ImageId made = chain.image("made", Format::f32, kExtent);
    declare(chain, input, made);
    return device_error_of([&] { chain.build(); });
  };
  const auto nothing = [](const HostImages&) {};
  const std::string where = "chain 'wrong': pass 0 'work': ";
  EXPECT_EQ(build_error([&](Chain& chain, ImageId input, ImageId) { chain.host_pass("work").read(input); }),
            where + "is never given its work");
  EXPECT_EQ(build_error([&](Chain& chain, ImageId, ImageId made) {
              chain.host_pass("work").read(made).run(nothing);
            }),
            where + "image 'made' is read before any pass writes it");
  EXPECT_EQ(build_error([&](Chain& chain, ImageId input, ImageId) {
              chain.host_pass("work").write(input).run(nothing);
            }),
            where + "image 'input' is an input and cannot be written");
  EXPECT_EQ(build_error([&](Chain& chain, ImageId, ImageId made) {
              chain.host_pass("work").write(made).read(made).run(nothing);
            }),
            where + "image 'made' is written and used at once");
}

TEST_F(HostPassTest, SeesOnlyWhatItDeclared) {
  bool has_run = false;
  chain_.host_pass("write").write(made_).run([&](const HostImages& host) {
    has_run = true;
    EXPECT_EQ(device_error_of([&] { static_cast<void>(host.read<float>(input_)); }),
              "chain 'host': pass 0 'write': image 'input' is not declared to be read");
    EXPECT_EQ(device_error_of([&] { static_cast<void>(host.read<float>(made_)); }),
              "chain 'host': pass 0 'write': image 'made' is not declared to be read");
  });
  chain_.build();
  std::ranges::fill(chain_.upload<float>(input_), 1.0f);
  chain_.run();
  EXPECT_TRUE(has_run);
}

}  // namespace
}  // namespace becalm::gpu
