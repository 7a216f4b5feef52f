#pragma once

#include <tbb/global_control.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "filter/gpu/device.h"
#include "filter/settings.h"
#include "frame/aov.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;
class Option;
}  // namespace CLI

namespace becalm::app {

/// Options that more than one subcommand has, with one name and one meaning.
struct OutputOptions {
  std::string pattern;
  std::string frames;  ///< as typed; empty: the subcommand's default
  bool resume = false;
  bool overwrite = false;
};
/// The option of the output pattern is returned, and is required.
CLI::Option* add_output_options(CLI::App& command, OutputOptions& options, const std::string& frames_default);

struct RunningOptions {
  int threads = 0;  ///< 0: all processors
  bool reproducible = false;
  bool profile = false;
  bool quiet = false;
  bool verbose = false;
};
void add_threads_option(CLI::App& command, int& threads);
void add_running_options(CLI::App& command, RunningOptions& options);

struct FilterOptions {
  std::vector<std::string> assignments;  ///< of --set
  std::string device;
  std::string memory;         ///< of --memory; empty: what the device has
  double memory_share = 1.0;  ///< of it, for this filter; others of the process have the rest
  std::optional<int> segment;
  std::optional<int> warmup;
  std::string context;  ///< empty: what there is
  std::string cuts = "auto";
  std::string alpha = "keep";
  std::optional<bool> stereo;     ///< whether eyes are filtered together; by default where there are two
  std::string additive = "auto";  ///< none: additive layers are passed on noisy
  bool validate = false;
  bool diagnostics = false;
};
/// With --reproducible sets what holds for the whole process: the instruction sets of libraries and, unless
/// --device names one, the software device. Called before the command runs.
void apply(const RunningOptions& running, FilterOptions& filter);
/// Of commands that may pass alpha on as it came.
void add_alpha_option(CLI::App& command, FilterOptions& options);
/// All but --alpha, and --additive, which takes layers of files in `denoise` alone.
void add_filter_options(CLI::App& command, FilterOptions& options);

/// The preset with every --set applied. Throws Error(usage).
filter::Settings resolve_settings(const std::string& preset, const FilterOptions& options);
gpu::DeviceOptions device_options(const FilterOptions& options);
/// What --memory allows a filter.
class MemoryLimit {
 public:
  /// Throws Error(usage) for a text that is no size.
  explicit MemoryLimit(const FilterOptions& options);
  /// The filter's share of what --memory allows or the device has, whichever is less.
  std::uint64_t bytes_of(const gpu::Device& device) const;

 private:
  std::uint64_t most_;
  double share_;
};
/// Every diagnostic AOV, or none.
AovSet diagnostics_of(const FilterOptions& options);
/// The settings tables of the denoiser and of antialiasing as lines of help.
std::string denoise_settings_help();
std::string antialias_settings_help();

/// Throws DeviceError if the validation layer had anything to say.
void check_validation(const gpu::Device& device);

/// Holds --threads for the tracer and the software device as long as it lives; made before the device is
/// opened.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);

 private:
  std::optional<tbb::global_control> control_;
};

}  // namespace becalm::app
