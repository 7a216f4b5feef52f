#include "filter/smooth/weights.h"

#include <half.h>

#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string_view>

extern "C" {
extern const std::byte becalm_standard_weights[];
extern const std::byte becalm_standard_weights_end[];
extern const std::byte becalm_shared_noise_weights[];
extern const std::byte becalm_shared_noise_weights_end[];
extern const std::byte becalm_albedo_weights[];
extern const std::byte becalm_albedo_weights_end[];
extern const std::byte becalm_own_share_weights[];
extern const std::byte becalm_own_share_weights_end[];
}

namespace becalm::filter {
namespace {

constexpr std::string_view kNetworkMagic = "becalmNW";
constexpr std::string_view kOwnShareMagic = "becalmOS";

class Reader {
 public:
  Reader(std::span<const std::byte> file, std::string_view magic) : rest_(file) {
    for (const char c : magic) {
      if (take<char>() != c) throw std::invalid_argument("network weights: not a file of scripts/train/");
    }
  }

  template <class T>
  T take() {
    if (rest_.size() < sizeof(T)) throw std::invalid_argument("network weights: the file is too short");
    T value;
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_ = rest_.subspan(sizeof(T));
    return value;
  }

  std::vector<float> take_halves(std::size_t count) {
    std::vector<float> values(count);
    for (float& value : values) value = imath_half_to_float(take<std::uint16_t>());
    return values;
  }

  Layer take_layer(int inputs, int outputs, int side) {
    Layer layer{.inputs = inputs, .outputs = outputs, .side = side, .weight = {}, .bias = {}};
    layer.weight = take_halves(static_cast<std::size_t>(outputs) * inputs * side * side);
    layer.bias = take_halves(outputs);
    return layer;
  }

  void expect_end() const {
    if (!rest_.empty()) throw std::invalid_argument("network weights: the file is too long");
  }

 private:
  std::span<const std::byte> rest_;
};

/// A file of export.py. Throws std::invalid_argument if it is not one or has another size.
NetworkWeights parse_weights(std::span<const std::byte> file) {
  Reader reader(file, kNetworkMagic);
  if (reader.take<std::uint32_t>() != kNetworkInputs) {
    throw std::invalid_argument("network weights: trained for other inputs");
  }
  NetworkWeights weights;
  for (int& count : weights.channels) {
    count = static_cast<int>(reader.take<std::uint32_t>());
    if (count < 8 || count > 256 || count % 8 != 0) {
      throw std::invalid_argument("network weights: channels come in eights, 8 to 256 of them");
    }
  }
  const std::array<int, kScales>& c = weights.channels;
  for (std::size_t i = 0; i < kScales; ++i) {
    weights.encode[i] = reader.take_layer(i == 0 ? kNetworkInputs : c[i - 1], c[i], 3);
  }
  for (std::size_t i = 0; i + 1 < kScales; ++i) {
    weights.decode[i] = reader.take_layer(c[i + 1] + c[i], c[i], 3);
  }
  weights.finish = reader.take_layer(c[0], c[0], 3);
  for (std::size_t i = 0; i < kScales; ++i) {
    const int coarse = i + 1 < kScales ? kCoarseTaps : 0;
    const int own = i == 0 ? kOwnTaps : 0;
    weights.window[i] = reader.take_layer(c[i], kWindowTaps + coarse + own, 1);
  }
  for (std::size_t i = 0; i < kScales; ++i) {
    weights.confidence[i] = reader.take_layer(c[i], 1 + kAffinities + (i == 0 ? 1 : 0), 1);
  }
  weights.albedo = reader.take_layer(c[0], 2 * kWindowTaps, 1);
  weights.error = reader.take_layer(c[0], 1, 1);
  reader.expect_end();
  return weights;
}

/// A file of own_share.py. Throws as parse_weights does.
OwnShareWeights parse_own_share(std::span<const std::byte> file) {
  Reader reader(file, kOwnShareMagic);
  OwnShareWeights layers{reader.take_layer(kOwnShareInputs, kOwnShareHidden, 1),
                         reader.take_layer(kOwnShareHidden, kOwnShareHidden, 1),
                         reader.take_layer(kOwnShareHidden, 1, 1)};
  reader.expect_end();
  return layers;
}

std::vector<Layer*> layers_of(NetworkWeights& weights) {
  std::vector<Layer*> layers{&weights.finish, &weights.albedo, &weights.error};
  const auto add = [&](auto& scales) {
    for (Layer& layer : scales) layers.push_back(&layer);
  };
  add(weights.encode);
  add(weights.decode);
  add(weights.window);
  add(weights.confidence);
  return layers;
}

/// Moves the weights of inputs that repeat others to those. Inputs 12 to 18 repeat 3 to 9 (albedo, normal,
/// depth); input 19, the grey value, is the mean of 0 to 2 (shaders/smooth/inputs.comp, own_inputs.comp).
Layer without_repeated_inputs(const Layer& layer) {
  assert(layer.inputs == kNetworkInputs);
  constexpr int grey = kNetworkInputs - 1;
  constexpr int first_feature = 3;
  Layer result{.inputs = kSingleFrameInputs,
               .outputs = layer.outputs,
               .side = layer.side,
               .weight = {},
               .bias = layer.bias};
  for (int o = 0; o < layer.outputs; ++o) {
    for (int i = 0; i < kSingleFrameInputs; ++i) {
      const int repeated = i - first_feature + kSingleFrameInputs;
      for (int t = 0; t < layer.side * layer.side; ++t) {
        const auto weight = [&](int input) { return layer.at(o, input, t / layer.side, t % layer.side); };
        float sum = weight(i);
        if (i < first_feature) sum += weight(grey) / first_feature;
        if (i >= first_feature && repeated < grey) sum += weight(repeated);
        result.weight.push_back(sum);
      }
    }
  }
  return result;
}

}  // namespace

NetworkWeights of_single_frame(NetworkWeights weights) {
  weights.encode[0] = without_repeated_inputs(weights.encode[0]);
  return weights;
}

const NetworkWeights& embedded_weights() {
  static const NetworkWeights weights = parse_weights({becalm_standard_weights, becalm_standard_weights_end});
  return weights;
}

const NetworkWeights& embedded_shared_noise_weights() {
  static const NetworkWeights weights =
      parse_weights({becalm_shared_noise_weights, becalm_shared_noise_weights_end});
  return weights;
}

const NetworkWeights& embedded_albedo_weights() {
  static const NetworkWeights weights = parse_weights({becalm_albedo_weights, becalm_albedo_weights_end});
  return weights;
}

const OwnShareWeights& embedded_own_share() {
  static const OwnShareWeights weights =
      parse_own_share({becalm_own_share_weights, becalm_own_share_weights_end});
  return weights;
}

NetworkWeights between(const NetworkWeights& from, const NetworkWeights& to, float share) {
  NetworkWeights result = from;
  NetworkWeights end = to;
  const std::vector<Layer*> layers = layers_of(result);
  const std::vector<Layer*> ends = layers_of(end);
  const auto move = [&](std::vector<float>& values, const std::vector<float>& goals) {
    assert(values.size() == goals.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::lerp(values[i], goals[i], share);
  };
  for (std::size_t i = 0; i < layers.size(); ++i) {
    move(layers[i]->weight, ends[i]->weight);
    move(layers[i]->bias, ends[i]->bias);
  }
  return result;
}

}  // namespace becalm::filter
