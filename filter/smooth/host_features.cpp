#include "filter/smooth/host_features.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "filter/for_rows.h"
#include "filter/smooth/convolution.h"
#include "filter/smooth/host_convolution.h"

namespace becalm::filter {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;
using HostImages = Chain::HostImages;

namespace {

/// A framed image, as HostConvolution reads it.
struct Framed {
  Framed(Chain& chain, const std::string& name, Extent size, int channels)
      : size(size),
        channels(channels),
        image(chain.image(name, Format::f32x4, {(size.width + 2) * (channels / kPlane), size.height + 2})) {}

  std::ptrdiff_t row_floats() const { return std::ptrdiff_t{size.width + 2} * channels; }

  Extent size;
  int channels;
  ImageId image;
};

/// Repeats the pixels at both ends of a framed row.
void repeat_ends(float* row, std::ptrdiff_t floats, int channels) {
  float* const end = row + floats;
  std::copy_n(row + channels, channels, row);
  std::copy_n(end - 2 * channels, channels, end - channels);
}

/// Writes the frame around row y, whose pixels are given: repeats the pixels at both ends, and the row itself
/// above the first row and below the last.
void frame_row(const Framed& framed, int y, float* row) {
  const std::ptrdiff_t floats = framed.row_floats();
  float* const end = row + floats;
  repeat_ends(row, floats, framed.channels);
  if (y == 0) std::copy(row, end, row - floats);
  if (y == framed.size.height - 1) std::copy(row, end, end);
}

/// Copies row y of planes of four channels to a framed row.
void row_from_planes(std::span<const float> planes, Extent size, int channels, int y, float* row) {
  for (int plane = 0; plane < channels / kPlane; ++plane) {
    const float* from = planes.data() + (std::ptrdiff_t{plane} * size.height + y) * size.width * kPlane;
    float* to = row + channels + plane * kPlane;
    for (int x = 0; x < size.width; ++x) std::copy_n(from + x * kPlane, kPlane, to + x * channels);
  }
}

/// Writes the maxima over 2x2 pixels of a framed row and the next one to a framed row of half the size.
void pool_rows(const float* row, const Framed& fine, float* pooled) {
  const int channels = fine.channels;
  const float* const next_row = row + fine.row_floats();
  for (int x = 0; x < fine.size.width / 2; ++x) {
    const std::ptrdiff_t from = std::ptrdiff_t{2 * x + 1} * channels;
    for (int c = 0; c < channels; ++c) {
      const float above = std::max(row[from + c], row[from + channels + c]);
      const float below = std::max(next_row[from + c], next_row[from + channels + c]);
      pooled[(x + 1) * channels + c] = std::max(above, below);
    }
  }
}

/// A layer's convolution with the weights as they are. Runs create it, so that chains that are only planned
/// take no time.
class CurrentConvolution {
 public:
  CurrentConvolution(LayerOf layer, int upsampled_inputs, int width)
      : layer_(std::move(layer)), upsampled_inputs_(upsampled_inputs), width_(width) {}

  const HostConvolution& get(const HostWeights& weights) {
    if (!convolution_ || version_ != weights.version()) {
      convolution_ =
          std::make_shared<const HostConvolution>(layer_(weights.network()), upsampled_inputs_, width_);
      version_ = weights.version();
    }
    return *convolution_;
  }

 private:
  LayerOf layer_;
  int upsampled_inputs_;
  int width_;
  std::shared_ptr<const HostConvolution> convolution_;
  int version_ = 0;
};

struct HostLayer {
  LayerOf layer_of;
  Framed source;
  std::optional<Framed> coarse;  ///< its channels come before the source's
  Framed result;
};

void add_layer(Chain& chain, const std::shared_ptr<const HostWeights>& weights, const HostLayer& declared) {
  const int width = declared.source.size.width;
  auto pass = chain.host_pass("smooth/host_convolve");
  pass.read(declared.source.image, gpu::reach(1));
  if (declared.coarse) pass.read(declared.coarse->image, gpu::coarser(2, 1));
  pass.write(declared.result.image);
  const int upsampled_inputs = declared.coarse ? declared.coarse->channels : 0;
  pass.run([=, current = CurrentConvolution(declared.layer_of, upsampled_inputs, width)](
               const HostImages& images) mutable {
    const Framed& result = declared.result;
    const HostConvolution& convolution = current.get(*weights);
    const float* const from = images.read<float>(declared.source.image).data();
    const float* const half = declared.coarse ? images.read<float>(declared.coarse->image).data() : nullptr;
    float* const to = images.write<float>(result.image).data();
    for_rows(result.size.height, [&](int begin, int end) {
      HostConvolution::Rows rows(convolution);
      for (int y = begin; y < end; ++y) {
        float* const row = to + (y + 1) * result.row_floats();
        rows.make(y, from, half, row);
        frame_row(result, y, row);
      }
    });
  });
}

/// The layer that reads the network's inputs. Their planes are packed as framed rows, a few at a time, which
/// stay in a processor's cache.
void add_first_layer(Chain& chain, const std::shared_ptr<const HostWeights>& weights, Extent size,
                     ImageId inputs, const Framed& result) {
  constexpr int most_rows = 8;
  auto pass = chain.host_pass("smooth/host_convolve_inputs");
  pass.read(inputs, gpu::reach(1)).write(result.image);
  pass.run([=, layer = CurrentConvolution(encoder(0), 0, size.width)](const HostImages& images) mutable {
    const HostConvolution& convolution = layer.get(*weights);
    const int channels = encoder(0)(weights->network()).inputs;
    const auto planes = images.read<float>(inputs);
    const std::span<float> to = images.write<float>(result.image);
    const std::ptrdiff_t row_floats = std::ptrdiff_t{size.width + 2} * channels;
    for_rows(size.height, [&](int begin, int end) {
      HostConvolution::Rows convolved(convolution);
      thread_local std::vector<float> packed;
      packed.resize((most_rows + 2) * row_floats);
      for (int first = begin; first < end; first += most_rows) {
        const int rows = std::min(most_rows, end - first);
        for (int i = 0; i < rows + 2; ++i) {
          float* const row = &packed[i * row_floats];
          row_from_planes(planes, size, channels, std::clamp(first + i - 1, 0, size.height - 1), row);
          repeat_ends(row, row_floats, channels);
        }
        for (int i = 0; i < rows; ++i) {
          float* const framed_row = to.data() + (first + i + 1) * result.row_floats();
          convolved.make(i, packed.data(), nullptr, framed_row);
          frame_row(result, first + i, framed_row);
        }
      }
    });
  });
}

Framed add_pool(Chain& chain, const std::string& name, const Framed& fine) {
  const Extent size{fine.size.width / 2, fine.size.height / 2};
  const Framed pooled(chain, name, size, fine.channels);
  chain.host_pass("smooth/host_pool")
      .read(fine.image, gpu::block(2))
      .write(pooled.image)
      .run([=](const HostImages& images) {
        const float* const from = images.read<float>(fine.image).data() + fine.row_floats();
        float* const to = images.write<float>(pooled.image).data() + pooled.row_floats();
        for_rows(size.height, [&](int begin, int end) {
          for (int y = begin; y < end; ++y) {
            float* const row = to + y * pooled.row_floats();
            pool_rows(from + 2 * y * fine.row_floats(), fine, row);
            frame_row(pooled, y, row);
          }
        });
      });
  return pooled;
}

}  // namespace

LayerOf encoder(std::size_t scale) {
  return [scale](const NetworkWeights& weights) -> const Layer& { return weights.encode[scale]; };
}

LayerOf decoder(std::size_t scale) {
  return [scale](const NetworkWeights& weights) -> const Layer& { return weights.decode[scale]; };
}

LayerOf finisher() {
  return [](const NetworkWeights& weights) -> const Layer& { return weights.finish; };
}

std::array<ImageId, kScales> add_host_features(Chain& chain, const std::array<int, kScales>& channels,
                                               const std::shared_ptr<const HostWeights>& weights, Extent size,
                                               ImageId inputs) {
  const auto image = [&](std::string_view name, std::size_t scale) {
    return Framed(chain, fmt::format("network.{}.L{}", name, scale),
                  {size.width >> scale, size.height >> scale}, channels[scale]);
  };
  std::vector<Framed> features;
  for (std::size_t i = 0; i < kScales; ++i) {
    const Framed encoded = image("encode", i);
    if (i == 0) {
      add_first_layer(chain, weights, size, inputs, encoded);
    } else {
      const Framed pooled = add_pool(chain, fmt::format("network.pooled.L{}", i), features.back());
      add_layer(chain, weights, {encoder(i), pooled, std::nullopt, encoded});
    }
    features.push_back(encoded);
  }
  for (std::size_t i = kScales - 1; i-- > 0;) {
    const Framed decoded = image("decode", i);
    add_layer(chain, weights, {decoder(i), features[i], features[i + 1], decoded});
    features[i] = decoded;
  }
  const Framed finished = image("finish", 0);
  add_layer(chain, weights, {finisher(), features[0], std::nullopt, finished});
  features[0] = finished;
  std::array<ImageId, kScales> images;
  std::ranges::transform(features, images.begin(), &Framed::image);
  return images;
}

}  // namespace becalm::filter
