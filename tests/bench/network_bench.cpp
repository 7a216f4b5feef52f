// What the smoothing network takes a frame, its convolutions by kernels and by oneDNN in turn.
//
//   bench_network WIDTH HEIGHT [RUNS]
//
// Other programs change processor times, which are of all threads, less than the wall's, which those of
// passes are.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <random>
#include <string_view>

#include "filter/smooth/network.h"
#include "tests/bench/stopwatch.h"
#include "tests/filter/task.h"

namespace becalm::bench {
namespace {

using filter::Convolver;

class NetworkJob {
 public:
  NetworkJob(gpu::Device& device, gpu::Extent full, Convolver convolver)
      : chain_(device, "network"),
        noisy_(chain_, task(full), full, filter::NoisyUse::smooth),
        network_(chain_, filter::embedded_weights(), full, noisy_, true, {}, convolver) {
    chain_.output(network_.smoothed().color);
    chain_.output(network_.smoothed().stats);
    chain_.build();
    network_.upload_weights(chain_);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    for (const gpu::ImageId image :
         {noisy_.color, noisy_.own_color, noisy_.variance, noisy_.exposure, noisy_.features->albedo_depth,
          noisy_.features->normal, noisy_.own_features->albedo_depth, noisy_.own_features->normal}) {
      for (float& value : chain_.upload<float>(image)) value = uniform(random);
    }
    chain_.run();  // touches memory for the first time, and makes what is made once
  }

  void run() {
    whole_.add(time_of([&] { chain_.run(); }));
    double convolutions_ms = 0.0;
    for (const gpu::PassTime& pass : chain_.times()) {
      const std::string_view name = pass.name;
      const bool convolves = name.starts_with("smooth/convolve") || name.starts_with("smooth/pool") ||
                             name.starts_with("smooth/host");
      if (convolves) convolutions_ms += pass.milliseconds;
    }
    convolutions_ms_.push_back(convolutions_ms);
  }
  void print_passes() const {
    for (const gpu::PassTime& pass : chain_.times())
      fmt::print("  {:8.1f} ms  {}\n", pass.milliseconds, pass.name);
  }
  const Runs& whole() const { return whole_; }
  double convolutions_ms() const { return median(convolutions_ms_); }
  double device_mib() const { return static_cast<double>(chain_.device_bytes()) / (1 << 20); }

 private:
  static filter::FilterTask task(gpu::Extent full) {
    filter::FilterTask task = filter::task_with_variance(filter::preset("balanced"), full);
    task.merged = true;
    return task;
  }

  gpu::Chain chain_;
  filter::NoisyInputs noisy_;
  filter::NetworkPasses network_;
  Runs whole_;
  std::vector<double> convolutions_ms_;
};

double giga_products(gpu::Extent full) {
  const filter::NetworkWeights& weights = filter::embedded_weights();
  const auto of = [](const filter::Layer& layer) { return static_cast<double>(layer.weight.size()); };
  double a_pixel = of(weights.finish);  // of the finest scale
  double pixels = 1.0;
  for (std::size_t i = 0; i < filter::kScales; ++i, pixels /= 4) {
    a_pixel += of(weights.encode[i]) * pixels;
    if (i + 1 == filter::kScales) break;
    const filter::Layer& decode = weights.decode[i];
    const int upsampled = weights.channels[i + 1];  // four products in the place of nine
    a_pixel += (of(decode) - 5.0 * upsampled * decode.outputs) * pixels;
  }
  return a_pixel * static_cast<double>(full.elements()) * 1e-9;
}

int number(const char* text) {
  int value = 0;
  const std::string_view digits = text;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return std::max(value, 1);
}

void compare(gpu::Extent full, int runs) {
  gpu::Device device;
  NetworkJob kernels(device, full, Convolver::kernels);
  NetworkJob host(device, full, Convolver::host);
  for (int i = 0; i < runs; ++i) {
    kernels.run();
    host.run();
  }
  fmt::print("{}x{}, {:.1f} G products, medians of {} runs\n", full.width, full.height, giga_products(full),
             runs);
  for (const auto& [name, job] : {std::pair{"kernels", &kernels}, {"oneDNN", &host}}) {
    const Duration whole = job->whole().middle();
    fmt::print("{:8}: {:.3f} s, of all threads {:.3f} s; convolutions {:.3f} s; {:.0f} MiB\n", name,
               whole.wall_s, whole.processor_s, job->convolutions_ms() * 1e-3, job->device_mib());
  }
  fmt::print("kernels / oneDNN, the whole network's processor time: {:.2f}\n",
             kernels.whole().ratio_to(host.whole()));
  host.print_passes();
}

}  // namespace
}  // namespace becalm::bench

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: bench_network WIDTH HEIGHT [RUNS]\n");
    return 2;
  }
  becalm::bench::compare({becalm::bench::number(argv[1]), becalm::bench::number(argv[2])},
                         argc > 3 ? becalm::bench::number(argv[3]) : 7);
}
