#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracer/procedural/ocean.h"
#include "tracer/sampling/sobol.h"

namespace becalm::tracer {

namespace {

/// The k-th number of a train, in (0, 1).
double uniform(std::uint32_t seed, int train, int k) {
  const std::uint64_t key = std::uint64_t{seed} << 32 | static_cast<std::uint32_t>(4 * train + k);
  return to_unit_double(mix_bits(key + 0x9e3779b97f4a7c15ull)) + 0x1p-54;
}

}  // namespace

WaveTrains make_wave_trains(const OceanDescription& description, double frame) {
  constexpr double turn = 2.0 * std::numbers::pi;
  const double longest = 1.6 * description.wavelength;
  const double log_range = std::log(longest / std::min(description.shortest_wavelength, longest));
  const double time_s = description.time_s.at(frame)[0];
  const int count = description.trains;
  double amplitudes[kMostTrains], energy = 0.0;
  WaveTrains trains;
  trains.count = (count + kTrainLanes - 1) / kTrainLanes * kTrainLanes;
  for (int n = 0; n < trains.count; ++n) {
    if (n >= count) {
      trains.kx[n] = trains.kz[n] = trains.amplitude[n] = trains.phase[n] = 0.0f;
      continue;
    }
    const double wavelength = longest * std::exp(-log_range * (n + uniform(description.seed, n, 0)) / count);
    const double relative_k = description.wavelength / wavelength;
    // S(w) dw over d(ln k) goes as w^-4, that is as k^-2.
    amplitudes[n] = std::exp(-0.625 / (relative_k * relative_k)) / relative_k;
    energy += 0.5 * amplitudes[n] * amplitudes[n];
    // Short waves spread over more directions than long ones.
    const double gauss = std::sqrt(-2.0 * std::log(uniform(description.seed, n, 1))) *
                         std::cos(turn * uniform(description.seed, n, 2));
    const double angle =
        (description.wind_deg + description.spread_deg * gauss * std::pow(relative_k, 0.25)) *
        std::numbers::pi / 180.0;
    const double turns_a_side = description.size / wavelength;
    trains.kx[n] = static_cast<float>(turns_a_side * std::cos(angle));
    trains.kz[n] = static_cast<float>(turns_a_side * std::sin(angle));
    const double turns_per_s = std::sqrt(description.gravity * turn / wavelength) / turn;
    const double phase = uniform(description.seed, n, 3) - turns_per_s * time_s;
    trains.phase[n] = static_cast<float>(phase - std::floor(phase));
  }
  const double scale = description.wave_height.at(frame)[0] / (4.0 * std::sqrt(energy) * description.size);
  for (int n = 0; n < count; ++n) trains.amplitude[n] = static_cast<float>(scale * amplitudes[n]);
  return trains;
}

}  // namespace becalm::tracer
