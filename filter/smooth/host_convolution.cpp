#include "filter/smooth/host_convolution.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <dnnl.hpp>

#include "filter/gpu/device.h"

// From libgomp, which Debian's oneDNN uses for its threads. Not included from omp.h, since each compiler has
// its own.
extern "C" void omp_set_num_threads(int threads);
extern "C" int omp_get_max_threads();

namespace becalm::filter {
namespace {

using dnnl::memory;
using Dims = memory::dims;

const dnnl::engine& processor() {
  static const dnnl::engine engine(dnnl::engine::kind::cpu, 0);
  return engine;
}

memory::desc rows_of(int channels, int rows, int width) {
  return {Dims{1, channels, rows, width}, memory::data_type::f32, memory::format_tag::nhwc};
}

/// A oneDNN convolution without padding that computes a single row.
class RowConvolution {
 public:
  /// `weight` is ordered [output][input][row][column]. `bias` may be empty; if it is not, the result is
  /// rectified. `onto` adds to the result's previous values.
  RowConvolution(int inputs, int outputs, int side, int width, std::vector<float> weight,
                 std::vector<float> bias, bool onto)
      : source_(rows_of(inputs, side, width + side - 1)), result_(rows_of(outputs, 1, width)) {
    const memory::desc any_weights(Dims{outputs, inputs, side, side}, memory::data_type::f32,
                                   memory::format_tag::any);
    const memory::desc biases(Dims{outputs}, memory::data_type::f32, memory::format_tag::x);
    dnnl::post_ops after;
    if (onto) after.append_sum();
    if (!bias.empty()) after.append_eltwise(1.0f, dnnl::algorithm::eltwise_relu, 0.0f, 0.0f);
    dnnl::primitive_attr attributes;
    attributes.set_post_ops(after);
    attributes.set_scratchpad_mode(
        dnnl::scratchpad_mode::user);  // the library's own scratchpad is shared by all threads
    using Convolution = dnnl::convolution_forward;
    const Dims ones{1, 1};
    const Dims zeros{0, 0};
    constexpr auto inference = dnnl::prop_kind::forward_inference;
    constexpr auto direct = dnnl::algorithm::convolution_direct;
    const auto declared =
        bias.empty()
            ? Convolution::desc(inference, direct, source_, any_weights, result_, ones, zeros, zeros)
            : Convolution::desc(inference, direct, source_, any_weights, biases, result_, ones, zeros, zeros);
    const Convolution::primitive_desc chosen(declared, attributes, processor());
    primitive_ = Convolution(chosen);
    scratch_ = chosen.scratchpad_desc();

    dnnl::stream stream(processor());
    memory as_given({Dims{outputs, inputs, side, side}, memory::data_type::f32, memory::format_tag::oihw},
                    processor(), weight.data());
    memory packed(chosen.weights_desc(), processor());
    dnnl::reorder(as_given, packed).execute(stream, as_given, packed);
    constants_.emplace(DNNL_ARG_WEIGHTS, packed);
    if (!bias.empty()) {
      memory values(biases, processor());
      std::copy(bias.begin(), bias.end(), static_cast<float*>(values.get_data_handle()));
      constants_.emplace(DNNL_ARG_BIAS, values);
    }
    stream.wait();
  }

  /// What runs of one thread need besides the pixels.
  class Run {
   public:
    explicit Run(const RowConvolution& of)
        : primitive_(of.primitive_),
          source_(of.source_, processor(), DNNL_MEMORY_NONE),
          result_(of.result_, processor(), DNNL_MEMORY_NONE),
          arguments_(of.constants_),
          stream_(processor()) {
      arguments_.emplace(DNNL_ARG_SRC, source_);
      arguments_.emplace(DNNL_ARG_DST, result_);
      arguments_.emplace(DNNL_ARG_SCRATCHPAD, memory(of.scratch_, processor()));
    }

    /// `source` is the first source row, `result` the first pixel of the result.
    void row(const float* source, float* result) {
      source_.set_data_handle(const_cast<float*>(source));
      result_.set_data_handle(result);
      primitive_.execute(stream_, arguments_);
      stream_.wait();
    }

   private:
    const dnnl::primitive& primitive_;
    memory source_;
    memory result_;
    std::unordered_map<int, memory> arguments_;
    dnnl::stream stream_;
  };

 private:
  memory::desc source_;
  memory::desc result_;
  memory::desc scratch_;
  dnnl::primitive primitive_;
  std::unordered_map<int, memory> constants_;
};

std::vector<float> direct_weights(const Layer& layer, int first_input) {
  std::vector<float> values;
  for (int o = 0; o < layer.outputs; ++o) {
    for (int i = first_input; i < layer.inputs; ++i) {
      for (int t = 0; t < 9; ++t) values.push_back(layer.at(o, i, t / 3, t % 3));
    }
  }
  return values;
}

/// Weights that replace the nine taps on an image of half the size. In framed images, all taps of pixels 2n
/// and 2n + 1 of a row fall on pixels n and n + 1 of half the size, and likewise for rows. `odd_row` is the
/// parity of the computed row. Pixels are computed in pairs, whose outputs are consecutive.
std::vector<float> upsampled_weights(const Layer& layer, int inputs, int odd_row) {
  std::vector<float> values;
  for (int odd_column = 0; odd_column < 2; ++odd_column) {
    for (int o = 0; o < layer.outputs; ++o) {
      for (int i = 0; i < inputs; ++i) {
        std::array<double, 4> sums{};
        for (int row = 0; row < 3; ++row) {
          for (int column = 0; column < 3; ++column) {
            sums[2 * ((odd_row + row) / 2) + (odd_column + column) / 2] += layer.at(o, i, row, column);
          }
        }
        values.insert(values.end(), sums.begin(), sums.end());
      }
    }
  }
  return values;
}

/// One thread of oneDNN's, the calling one, as long as this lives: this program's threads compute the rows.
class OneThread {
 public:
  OneThread() { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  const int before_ = omp_get_max_threads();
};

/// Errors of `action` become gpu::DeviceError.
template <class Action>
void with_device_errors(const Action& action) {
  try {
    action();
  } catch (const dnnl::error& error) {
    throw gpu::DeviceError(std::string("oneDNN: ") + error.what());
  }
}

}  // namespace

struct HostConvolution::Impl {
  Impl(const Layer& layer, int upsampled_inputs, int width)
      : direct(layer.inputs - upsampled_inputs, layer.outputs, 3, width,
               direct_weights(layer, upsampled_inputs), layer.bias, upsampled_inputs > 0),
        source_row((width + 2) * (layer.inputs - upsampled_inputs)),
        coarse_row((width / 2 + 2) * upsampled_inputs),
        outputs(layer.outputs) {
    if (upsampled_inputs == 0) return;
    assert(width % 2 == 0);
    for (int odd_row = 0; odd_row < 2; ++odd_row) {
      upsampled[odd_row].emplace(upsampled_inputs, 2 * layer.outputs, 2, width / 2 + 1,
                                 upsampled_weights(layer, upsampled_inputs, odd_row), std::vector<float>(),
                                 false);
    }
  }

  RowConvolution direct;
  std::array<std::optional<RowConvolution>, 2>
      upsampled;              // for even and odd framed rows; empty without upsampled inputs
  std::ptrdiff_t source_row;  // floats per framed row
  std::ptrdiff_t coarse_row;
  int outputs;
};

HostConvolution::HostConvolution(const Layer& layer, int upsampled_inputs, int width) {
  const OneThread one_thread;
  with_device_errors([&] { impl_ = std::make_unique<Impl>(layer, upsampled_inputs, width); });
}

HostConvolution::~HostConvolution() = default;

struct HostConvolution::Rows::Impl {
  explicit Impl(const HostConvolution::Impl& of) : of(of), direct(of.direct) {
    for (std::size_t i = 0; i < upsampled.size(); ++i) {
      if (of.upsampled[i]) upsampled[i].emplace(*of.upsampled[i]);
    }
  }

  const OneThread one_thread;
  const HostConvolution::Impl& of;
  RowConvolution::Run direct;
  std::array<std::optional<RowConvolution::Run>, 2> upsampled;
};

HostConvolution::Rows::Rows(const HostConvolution& convolution) {
  with_device_errors([&] { impl_ = std::make_unique<Impl>(*convolution.impl_); });
}

HostConvolution::Rows::~Rows() = default;

void HostConvolution::Rows::make(int y, const float* source, const float* coarse, float* result) {
  const HostConvolution::Impl& of = impl_->of;
  const int framed_row = y + 1;
  with_device_errors([&] {
    if (auto& upsampled = impl_->upsampled[framed_row % 2])
      upsampled->row(coarse + framed_row / 2 * of.coarse_row, result);
    impl_->direct.row(source + y * of.source_row, result + of.outputs);
  });
}

}  // namespace becalm::filter
