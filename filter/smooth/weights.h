#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace becalm::filter {

/// Scales of the network: each is half as large as the one before.
constexpr std::size_t kScales = 5;
/// Channels that the network sees of a frame; shaders/smooth/inputs.comp makes them.
constexpr int kNetworkInputs = 20;
/// Pixels of a window whose weights it predicts, pixels of the coarser scale's result besides, and at the
/// finest scale those of 3x3 pixels of the frame itself, whose merged window it is.
constexpr int kWindowTaps = 25;
constexpr int kCoarseTaps = 4;
constexpr int kOwnTaps = 9;
/// Learned features of a pixel, by whose squared distances the pixels of a window count less (Isik et al.
/// 2021).
constexpr int kAffinities = 4;

/// One layer: `weight` as [output][input][row][column] of a `side` x `side` kernel, and a bias for each
/// output.
struct Layer {
  int inputs = 0;
  int outputs = 0;
  int side = 1;
  std::vector<float> weight;
  std::vector<float> bias;

  float at(int output, int input, int row = 0, int column = 0) const {
    return weight[((static_cast<std::size_t>(output) * inputs + input) * side + row) * side + column];
  }
};

/// The parameters of a trained network, as scripts/train/export.py writes them. Convolutions of 3x3
/// (`encode`, `decode`, `finish`) make features of each scale; layers of 1x1 turn a pixel's features into
/// what is done with its radiance.
struct NetworkWeights {
  std::array<int, kScales> channels{};
  std::array<Layer, kScales> encode;      ///< of the frame, then of the finer scale's maxima over 2x2 pixels
  std::array<Layer, kScales - 1> decode;  ///< of the coarser scale's features, and those of `encode`
  Layer finish;                           ///< the last one of the finest scale
  std::array<Layer, kScales> window;      ///< logits of the window's pixels, of the coarser ones, of own ones
  /// Logit of how much a pixel counts; its affinities; at the finest scale the logit of how much the frame's
  /// own counts.
  std::array<Layer, kScales> confidence;
  Layer albedo;  ///< logits of the windows that the albedo is taken from: merged, own
  Layer error;   ///< log of the squared relative error to be expected
};

/// Reads a file of export.py. Throws std::invalid_argument if it is none, or of another size.
NetworkWeights parse_weights(std::span<const std::byte> file);

/// The network that is part of the program.
const NetworkWeights& embedded_weights();

}  // namespace becalm::filter
