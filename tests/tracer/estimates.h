#pragma once

#include <string>
#include <vector>

#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {

/// Mean of an estimator over independent seeds, and the spread of that mean: what variance AOVs cannot tell
/// at few samples, and what does not depend on how samples are stratified within a render.
struct Estimate {
  double mean = 0.0;
  double variance_of_mean = 0.0;
  int seeds = 0;
};

/// Which renders make an estimate.
struct Estimator {
  std::string name;  ///< for messages
  std::string json;
  int spp = 8;
  int seeds = 16;
  std::uint32_t first_seed = 0;
  int frame = 1;
};

/// Of each block of `block` x `block` pixels, row by row, its three channels next to each other.
std::vector<Estimate> estimate_blocks(const Estimator& estimator, int block);

/// Probability of means at least as far apart if both had the same expectation (Welch's test).
double equal_means_p_value(const Estimate& a, const Estimate& b);

/// Expects that no block tells the estimators apart at that level of the whole comparison (Sidak), and that
/// they could: the pooled standard error of the picture's mean is below `largest_error` of it. `tolerance` is
/// the relative difference that approximations of the scene itself may make.
void expect_same_expectation(const Estimator& a, const Estimator& b, int block, double largest_error = 0.02,
                             double tolerance = 1e-4, double level = 1e-4);

/// The same of modes that all must have the expectation of "mis": DIRECT in the scene's text is replaced.
void expect_direct_modes_agree(const std::string& json, int spp, int seeds, int block, int frame = 1);

}  // namespace becalm::tracer::test
