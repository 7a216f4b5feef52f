#include "tests/tracer/estimates.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer::test {
namespace {

double block_mean(const Image& beauty, int x0, int y0, int block, int channel) {
  double sum = 0.0;
  int count = 0;
  for (int y = y0; y < std::min(y0 + block, beauty.height()); ++y) {
    for (int x = x0; x < std::min(x0 + block, beauty.width()); ++x, ++count) sum += beauty.at(x, y, channel);
  }
  return sum / count;
}

std::string with_direct(std::string json, const std::string& mode) {
  const std::size_t at = json.find("DIRECT");
  EXPECT_NE(at, std::string::npos);
  return json.replace(at, 6, mode);
}

}  // namespace

std::vector<Estimate> estimate_blocks(const Estimator& estimator, int block) {
  Scene scene = load_text(estimator.json);
  std::vector<Estimate> blocks;
  std::vector<double> squares;
  for (int i = 0; i < estimator.seeds; ++i) {
    RenderReport report;
    const Frame frame =
        render_frame(scene, estimator.frame,
                     options(estimator.spp, {}, estimator.first_seed + static_cast<std::uint32_t>(i)),
                     &report)
            .value();
    EXPECT_EQ(report.non_finite_samples, 0u) << estimator.name << ", seed " << estimator.first_seed + i;
    std::size_t index = 0;
    for (int y = 0; y < frame.height(); y += block) {
      for (int x = 0; x < frame.width(); x += block) {
        for (int channel = 0; channel < 3; ++channel, ++index) {
          if (i == 0) {
            blocks.emplace_back();
            squares.push_back(0.0);
          }
          Estimate& b = blocks[index];
          const double value = block_mean(frame.image(Aov::beauty), x, y, block, channel);
          const double delta = value - b.mean;
          b.mean += delta / ++b.seeds;
          squares[index] += delta * (value - b.mean);
        }
      }
    }
  }
  for (std::size_t i = 0; i < blocks.size(); ++i)
    blocks[i].variance_of_mean = squares[i] / (blocks[i].seeds - 1.0) / blocks[i].seeds;
  return blocks;
}

double equal_means_p_value(const Estimate& a, const Estimate& b) {
  const double variance = a.variance_of_mean + b.variance_of_mean;
  if (variance == 0.0) return a.mean == b.mean ? 1.0 : 0.0;
  const double freedom = variance * variance /
                         (a.variance_of_mean * a.variance_of_mean / (a.seeds - 1.0) +
                          b.variance_of_mean * b.variance_of_mean / (b.seeds - 1.0));
  const double t = std::abs(a.mean - b.mean) / std::sqrt(variance);
  return 2.0 * cdf(complement(boost::math::students_t(freedom), t));
}

void expect_same_expectation(const Estimator& a, const Estimator& b, int block, double largest_error,
                             double tolerance, double level) {
  const std::vector<Estimate> of_a = estimate_blocks(a, block), of_b = estimate_blocks(b, block);
  ASSERT_EQ(of_a.size(), of_b.size());
  double least_p = 2.0, sum = 0.0, variance = 0.0;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    sum += of_a[i].mean;
    variance += of_a[i].variance_of_mean + of_b[i].variance_of_mean;
    // What lies within the tolerance agrees.
    if (std::abs(of_a[i].mean - of_b[i].mean) <= tolerance * std::abs(of_b[i].mean)) continue;
    const double p = equal_means_p_value(of_a[i], of_b[i]);
    if (p < least_p) {
      least_p = p;
      worst = i;
    }
  }
  ASSERT_GT(sum, 0.0) << a.name << " is black";
  EXPECT_LT(std::sqrt(variance), largest_error * sum) << a.name << ": too noisy to tell";
  EXPECT_GT(least_p, sidak_level(level, static_cast<int>(of_a.size())))
      << a.name << " against " << b.name << ", frame " << a.frame << ", seeds from " << a.first_seed
      << " and " << b.first_seed << ": block " << worst / 3 << " channel " << worst % 3 << ": "
      << of_a[worst].mean << " +- " << std::sqrt(of_a[worst].variance_of_mean) << " and " << of_b[worst].mean
      << " +- " << std::sqrt(of_b[worst].variance_of_mean) << ", p " << least_p;
}

void expect_direct_modes_agree(const std::string& json, int spp, int seeds, int block, int frame) {
  const Estimator mis{"mis", with_direct(json, "mis"), spp, seeds, 0, frame};
  for (const char* mode : {"light", "material"}) {
    const Estimator other{mode, with_direct(json, mode), 2 * spp, seeds, 1000, frame};
    expect_same_expectation(other, mis, block, 0.05);
  }
}

}  // namespace becalm::tracer::test
