// Time of the smoothing network for one frame, its convolutions by the device's kernels or by oneDNN. The
// column "CPU" is the time of all threads: other programs on the machine change it less than the wall time.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>
#include <string_view>

#include "filter/smooth/network.h"
#include "tests/filter/task.h"

namespace becalm::bench {
namespace {

using filter::Convolver;

class NetworkJob {
 public:
  NetworkJob(gpu::Extent full, Convolver convolver)
      : chain_(device_, "network"),
        noisy_(chain_, task(full), full, filter::NoisyUse::smooth),
        network_(chain_, {filter::embedded_weights(), &filter::embedded_own_share()}, full, noisy_, true, {},
                 convolver) {
    chain_.output(network_.smoothed().color);
    chain_.output(network_.smoothed().stats);
    chain_.build();
    network_.upload_weights(chain_, filter::embedded_weights());
    upload();
    run();  // the first run also touches memory for the first time and builds oneDNN's primitives
  }

  /// Before each run.
  void upload() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    for (const gpu::ImageId image :
         {noisy_.color, noisy_.own_color, noisy_.variance, noisy_.exposure, noisy_.features->albedo_depth,
          noisy_.features->normal, noisy_.own_features->albedo_depth, noisy_.own_features->normal}) {
      for (float& value : chain_.upload<float>(image)) value = uniform(random);
    }
  }

  void run() { chain_.run(); }

  /// Of the last run.
  double convolutions_s() const {
    double milliseconds = 0.0;
    for (const gpu::PassTime& pass : chain_.times()) {
      const std::string_view name = pass.name;
      const bool convolves = name.starts_with("smooth/convolve") || name.starts_with("smooth/pool") ||
                             name.starts_with("smooth/host");
      if (convolves) milliseconds += pass.milliseconds;
    }
    return 1e-3 * milliseconds;
  }
  double device_bytes() const { return static_cast<double>(chain_.device_bytes().total()); }

 private:
  static filter::FilterTask task(gpu::Extent full) {
    filter::FilterTask task = filter::task_with_variance(filter::preset("balanced"), full);
    task.merged = true;
    return task;
  }

  gpu::Device device_;
  gpu::Chain chain_;
  filter::NoisyInputs noisy_;
  filter::NetworkPasses network_;
};

/// Multiplications of all convolutions of one frame.
double products(gpu::Extent full) {
  const filter::NetworkWeights& weights = filter::embedded_weights();
  const auto of = [](const filter::Layer& layer) { return static_cast<double>(layer.weight.size()); };
  double per_pixel = of(weights.finish);  // per pixel of the finest scale
  double pixels = 1.0;
  for (std::size_t i = 0; i < filter::kScales; ++i, pixels /= 4) {
    per_pixel += of(weights.encode[i]) * pixels;
    if (i + 1 == filter::kScales) break;
    const filter::Layer& decode = weights.decode[i];
    const int upsampled =
        weights.channels[i + 1];  // their 3x3 convolution is one of 2x2 on the coarser scale
    per_pixel += (of(decode) - 5.0 * upsampled * decode.outputs) * pixels;
  }
  return per_pixel * static_cast<double>(full.elements());
}

void smooth(benchmark::State& state, Convolver convolver) {
  const gpu::Extent full{static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
  NetworkJob job(full, convolver);
  double convolutions_s = 0.0;
  while (state.KeepRunning()) {
    state.PauseTiming();
    job.upload();
    state.ResumeTiming();
    job.run();
    convolutions_s += job.convolutions_s();
  }
  state.counters["convolutions_s"] = benchmark::Counter(convolutions_s, benchmark::Counter::kAvgIterations);
  state.counters["products"] = products(full);
  state.counters["device_bytes"] =
      benchmark::Counter(job.device_bytes(), benchmark::Counter::kDefaults, benchmark::Counter::kIs1024);
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"width", "height"})->Args({960, 540})->Args({1920, 544});
  bench->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
  bench->Iterations(1)->Repetitions(7)->ReportAggregatesOnly();
}

BENCHMARK_CAPTURE(smooth, kernels, Convolver::kernels)->Apply(sizes);
BENCHMARK_CAPTURE(smooth, oneDNN, Convolver::host)->Apply(sizes);

}  // namespace
}  // namespace becalm::bench

BENCHMARK_MAIN();
