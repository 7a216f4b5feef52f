#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "filter/report.h"

namespace becalm::app {

/// What --profile prints at the end on standard error: where the time and the memory went. May be called from
/// any thread.
class Profile {
 public:
  /// The wall time that one frame took in a step: "render", "read", "filter", "write".
  void add(const std::string& step, double seconds);
  /// One frame's device times.
  void add(const std::vector<gpu::PassTime>& passes);
  void set_device(std::string name, const filter::FilterMemory& memory);
  /// Medians over the frames, the device's memory and the process's peak.
  void print() const;

 private:
  using Samples = std::vector<std::pair<std::string, std::vector<double>>>;  // in order of first appearance
  static std::vector<double>& find(Samples& samples, const std::string& name);
  static void print_table(const char* title, const Samples& samples);

  mutable std::mutex mutex_;
  Samples steps_ms_;
  Samples passes_ms_;
  std::string device_;
  filter::FilterMemory memory_;
};

/// Adds the time of its own life to a step.
class ProfileScope {
 public:
  ProfileScope(Profile& profile, std::string step) : profile_(profile), step_(std::move(step)) {}
  ~ProfileScope() {
    profile_.add(step_, std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
  }
  ProfileScope(const ProfileScope&) = delete;
  ProfileScope& operator=(const ProfileScope&) = delete;

 private:
  Profile& profile_;
  std::string step_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace becalm::app
