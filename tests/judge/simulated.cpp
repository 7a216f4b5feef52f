#include "tests/judge/simulated.h"

#include <cmath>
#include <numbers>

namespace becalm::judge {
namespace {

constexpr int kEdge = 16;
/// A reference costs as much as dozens of frames, so that some frames share one.
constexpr int kFramesOfReference = 20;

}  // namespace

const char* name(Noise noise) {
  switch (noise) {
    case Noise::gaussian:
      return "gaussian";
    case Noise::poisson:
      return "poisson";
    case Noise::lognormal:
      return "lognormal";
    case Noise::fireflies:
      return "fireflies";
  }
  return "";
}

double SampleSource::normal() {
  // Box and Muller; the second of the pair is not kept, so that a sample is a function of two numbers.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

double SampleSource::next() {
  const auto lognormal = [&](double sigma) { return std::exp(sigma * normal() - 0.5 * sigma * sigma); };
  constexpr double firefly_rate = 1e-4;
  constexpr double firefly = 1000.0;
  switch (noise_) {
    case Noise::gaussian:
      return 1.0 + 0.25 * normal();
    case Noise::poisson:
      return uniform() < 0.05 ? 20.0 : 0.0;
    case Noise::lognormal:
      return lognormal(1.5);
    case Noise::fireflies:
      return (1.0 - firefly * firefly_rate) * lognormal(0.472) + (uniform() < firefly_rate ? firefly : 0.0);
  }
  return 0.0;
}

SimulatedImage simulate(SampleSource& source, int edge_px, int samples) {
  SimulatedImage image{Image(edge_px, edge_px, 1), Image(edge_px, edge_px, 1), static_cast<double>(samples)};
  for (int y = 0; y < edge_px; ++y) {
    for (int x = 0; x < edge_px; ++x) {
      const double scale = std::pow(10.0, 2.0 * (x + 0.5) / edge_px - 1.0);
      double mean = 0.0;
      double squares = 0.0;
      for (int i = 0; i < samples; ++i) {
        const double sample = scale * source.next();
        const double delta = sample - mean;
        mean += delta / (i + 1);
        squares += delta * (sample - mean);
      }
      image.mean.at(x, y, 0) = static_cast<float>(mean);
      image.variance.at(x, y, 0) =
          static_cast<float>(samples > 1 ? squares / (samples * (samples - 1.0)) : mean * mean);
    }
  }
  return image;
}

void brighten(SimulatedImage& image, int x, int y, int edge_px, double factor) {
  for (int v = y; v < y + edge_px; ++v) {
    for (int u = x; u < x + edge_px; ++u) {
      image.mean.at(u, v, 0) *= static_cast<float>(factor);
      image.variance.at(u, v, 0) *= static_cast<float>(factor * factor);
    }
  }
}

FalseAlarms count_false_alarms(Noise noise, int samples, int reference_samples, int runs, double rate,
                               std::uint32_t seed) {
  SampleSource source(noise, seed);
  FalseAlarms alarms{.runs = runs};
  SimulatedImage reference;
  for (int run = 0; run < runs; ++run) {
    if (run % kFramesOfReference == 0) reference = simulate(source, kEdge, reference_samples);
    const SimulatedImage frame = simulate(source, kEdge, samples);
    const StatisticalOptions options{.false_alarm_rate = rate};
    const auto fails = [&](const Estimate& test) {
      return !compare_statistically(test, reference.estimate(), options).passed();
    };
    alarms.with_variance += fails(frame.estimate()) ? 1 : 0;
    alarms.without_variance += fails(frame.without_variance()) ? 1 : 0;
  }
  return alarms;
}

}  // namespace becalm::judge
