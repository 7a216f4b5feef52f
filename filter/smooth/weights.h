#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace becalm::filter {

/// Scales of the network: each is half as large as the one before.
constexpr std::size_t kScales = 5;
/// Number of input channels of the network; shaders/smooth/inputs.comp computes them.
constexpr int kNetworkInputs = 20;
/// Number of those that differ if the frame is not a merged one. The others are the unmerged frame's features
/// and grey value: in a single frame they repeat its own.
constexpr int kSingleFrameInputs = 12;
/// Number of pixels whose weights the network predicts: of a window, of the coarser scale's result and, at
/// the finest scale, of 3x3 pixels of the unmerged frame.
constexpr int kWindowTaps = 25;
constexpr int kCoarseTaps = 4;
constexpr int kOwnTaps = 9;
/// Number of learned features of a pixel; their squared distances lower the weights of a window's pixels
/// (Isik et al. 2021).
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
/// (`encode`, `decode`, `finish`) compute the features of each scale; 1x1 layers turn a pixel's features into
/// weights.
struct NetworkWeights {
  std::array<int, kScales> channels{};
  std::array<Layer, kScales> encode;      ///< reads the frame, then the finer scale's maxima over 2x2 pixels
  std::array<Layer, kScales - 1> decode;  ///< reads the coarser scale's features and those of `encode`
  Layer finish;                           ///< the last layer of the finest scale
  std::array<Layer, kScales> window;      ///< logits of the pixels of window, coarser scale, unmerged frame
  /// Logit of a pixel's confidence; its affinities; at the finest scale the logit of the confidence of the
  /// unmerged frame's pixel.
  std::array<Layer, kScales> confidence;
  Layer albedo;  ///< logits of the windows that average the albedo: merged, unmerged
  Layer error;   ///< log of the expected squared relative error
};

/// 1x1 layers that tell the frame's own share of a merged frame's result (shaders/smooth/own_share.comp), a
/// rectification after each but the last, as scripts/train/own_share.py writes them.
constexpr int kOwnShareInputs = 5;
constexpr int kOwnShareHidden = 16;
using OwnShareWeights = std::array<Layer, 3>;

/// The network for single frames: computes the same from the first kSingleFrameInputs of its inputs.
NetworkWeights of_single_frame(NetworkWeights weights);

/// What is embedded in the program: for noise that is independent from pixel to pixel, and the same network
/// trained further on noise that neighbouring pixels share.
const NetworkWeights& embedded_weights();
const NetworkWeights& embedded_shared_noise_weights();
const NetworkWeights& embedded_albedo_weights();
const OwnShareWeights& embedded_own_share();

/// The parameters at `share` of the way from one network to another of its shape.
NetworkWeights between(const NetworkWeights& from, const NetworkWeights& to, float share);

}  // namespace becalm::filter
