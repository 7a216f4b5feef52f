// Random chains, with many images that share memory, against the same arithmetic on the CPU. If the device is
// a processor, some or all passes may be host passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "filter/gpu/chain.h"
#include "tests/gpu/support.h"

namespace becalm::gpu {
namespace {

struct MixPass {
  std::size_t a;
  std::size_t b;
  std::size_t result;
  std::int32_t salt;
};

/// Image numbers: inputs first, then the histories' `previous`, then the images that passes write. The last
/// of these are the histories' `next`, in the same order.
struct Program {
  std::vector<Extent> extents;
  std::size_t inputs = 0;
  std::size_t histories = 0;
  std::vector<MixPass> passes;
  std::vector<std::size_t> outputs;
};

Program random_program(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return random() % n; };
  const auto salt = [&] { return static_cast<std::int32_t>(below(kMixModulus)); };
  const auto extent = [&] {
    return Extent{1 + static_cast<int>(below(60)), 1 + static_cast<int>(below(40)),
                  1 + static_cast<int>(below(3))};
  };
  Program program;
  program.inputs = 1 + below(3);
  program.histories = below(3);
  for (std::size_t i = 0; i < program.inputs + program.histories; ++i) program.extents.push_back(extent());
  const std::size_t written = program.histories + 6 + below(15);
  for (std::size_t i = 0; i < written; ++i) {
    const std::size_t history =
        i + program.histories - written;  // wraps to a large number before the last ones
    const bool is_next = i + program.histories >= written;
    // Recent images are read more often, so that lifetimes are short and memory is shared.
    const std::size_t known = program.extents.size();
    const std::size_t recent = std::min<std::size_t>(known, 4);
    const std::size_t a = known - 1 - below(recent);
    const std::size_t b = below(3) == 0 ? below(known) : known - 1 - below(recent);
    program.extents.push_back(is_next ? program.extents[program.inputs + history] : extent());
    program.passes.push_back({a, b, known, salt()});
    // Half of an image may be written again later in the chain: written after it was read.
    if (below(4) == 0) program.passes.push_back({b, a, known, salt()});
    if (below(5) == 0 || i + 1 == written) program.outputs.push_back(known);
  }
  return program;
}

/// Whole numbers below kMixModulus.
using Values = std::vector<std::vector<float>>;

void mix(std::span<const float> a, std::span<const float> b, std::int32_t salt, std::span<float> result) {
  for (std::size_t i = 0; i < result.size(); ++i) {
    const int of_a = static_cast<int>(a[(i + 7) % a.size()]);
    const int of_b = static_cast<int>(b[(i + 31) % b.size()]);
    result[i] = static_cast<float>((3 * of_a + 5 * of_b + salt) % kMixModulus);
  }
}

float input_value(std::size_t image, std::size_t element, int frame) {
  const std::size_t value = image * 1'000'003 + element * 17 + static_cast<std::size_t>(frame) * 7919 + 1;
  return static_cast<float>(value % kMixModulus);
}

/// The outputs of three frames, computed on the CPU.
Values expected_outputs(const Program& program) {
  Values results;
  Values images;
  for (const Extent& extent : program.extents) images.emplace_back(extent.elements(), 0.0f);
  for (int frame = 0; frame < 3; ++frame) {
    for (std::size_t i = 0; i < program.inputs; ++i) {
      for (std::size_t e = 0; e < images[i].size(); ++e) images[i][e] = input_value(i, e, frame);
    }
    for (const MixPass& pass : program.passes) {
      mix(images[pass.a], images[pass.b], pass.salt, images[pass.result]);
    }
    for (const std::size_t output : program.outputs) results.push_back(images[output]);
    for (std::size_t h = 0; h < program.histories; ++h) {
      images[program.inputs + h] = images[images.size() - program.histories + h];
    }
  }
  return results;
}

/// One in `host_share` passes, chosen by its salt, is a host pass; 0: none.
Values chain_outputs(const Program& program, const ChainOptions& options, unsigned host_share = 0) {
  Chain chain(validated_device(), "random", options);
  std::vector<ImageId> images;
  std::vector<ImageId> next;
  const std::size_t first_written = program.inputs + program.histories;
  for (std::size_t i = 0; i < program.extents.size(); ++i) {
    const std::string name = "image " + std::to_string(i);
    const Extent extent = program.extents[i];
    if (i < program.inputs) {
      images.push_back(chain.input(name, Format::f32, extent));
    } else if (i < first_written) {
      const History history = chain.history(name, Format::f32, extent);
      images.push_back(history.previous);
      next.push_back(history.next);
    } else if (i + program.histories >= program.extents.size()) {
      images.push_back(next[i + program.histories - program.extents.size()]);
    } else {
      images.push_back(chain.image(name, Format::f32, extent));
    }
  }
  for (const MixPass& pass : program.passes) {
    const Extent extent = program.extents[pass.result];
    if (host_share > 0 && static_cast<unsigned>(pass.salt) % host_share == 0) {
      const std::array<ImageId, 3> used{images[pass.a], images[pass.b], images[pass.result]};
      chain.host_pass("mix").read(used[0]).read(used[1]).write(used[2]).run(
          [used, salt = pass.salt](const Chain::HostImages& host) {
            mix(host.read<float>(used[0]), host.read<float>(used[1]), salt, host.write<float>(used[2]));
          });
      continue;
    }
    chain.pass("kernels/mix")
        .read("a", images[pass.a])
        .read("b", images[pass.b])
        .write("result", images[pass.result])
        .constants(MixParams{extent.width, extent.height, extent.planes,
                             static_cast<std::int32_t>(program.extents[pass.a].elements()),
                             static_cast<std::int32_t>(program.extents[pass.b].elements()), pass.salt})
        .dispatch(extent);
  }
  for (const std::size_t output : program.outputs) chain.output(images[output]);
  chain.build();
  EXPECT_LE(chain.device_bytes().total(), chain.device_bytes_unaliased());

  Values results;
  for (int frame = 0; frame < 3; ++frame) {
    for (std::size_t i = 0; i < program.inputs; ++i) {
      const auto values = chain.upload<float>(images[i]);
      for (std::size_t e = 0; e < values.size(); ++e) values[e] = input_value(i, e, frame);
    }
    chain.run();
    for (const std::size_t output : program.outputs) {
      const auto values = chain.download<float>(images[output]);
      results.emplace_back(values.begin(), values.end());
    }
  }
  return results;
}

TEST(RandomChain, ComputesTheSameAsTheCpuHoweverItsMemoryIsLaidOut) {
  ChainOptions several_arenas = test_options(true);
  several_arenas.max_arena_bytes = 20'000;
  ChainOptions staged = test_options(true);
  staged.transfers = Transfers::staged;
  for (unsigned seed = 0; seed < 25; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Program program = random_program(seed);
    const Values expected = expected_outputs(program);
    ASSERT_EQ(chain_outputs(program, test_options(true)), expected);
    ASSERT_EQ(chain_outputs(program, test_options(false)), expected);
    ASSERT_EQ(chain_outputs(program, several_arenas), expected);
    ASSERT_EQ(chain_outputs(program, staged), expected);
    if (!validated_device().info().is_processor) continue;
    for (const unsigned host_share : {1, 2, 5}) {
      ASSERT_EQ(chain_outputs(program, test_options(true), host_share), expected);
      ASSERT_EQ(chain_outputs(program, several_arenas, host_share), expected);
      ASSERT_EQ(chain_outputs(program, staged, host_share), expected);
    }
  }
  EXPECT_TRUE(validated_device().validation_messages().empty());
}

}  // namespace
}  // namespace becalm::gpu
