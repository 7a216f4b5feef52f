#include "app/test/suite.h"

#include <algorithm>

#include "tracer/sample_counts.h"

namespace becalm::app {
namespace {

/// Whether more samples can be asked of what makes the references.
bool takes_spp(const TestCase& test) {
  if (!test.reference.command.empty()) return has_placeholder(test.reference.command, "{spp}");
  return test.source.command.empty() ||
         any_has_placeholder(test.source.command, test.source.prepare, "{spp}");
}

}  // namespace

int reference_count(const TestCase& test) {
  return test.reference.count.value_or(1);
}

int reference_spp(const TestCase& test) {
  constexpr int times = 16;
  const bool as_source = test.judges.exact || test.judges.denoised || !takes_spp(test);
  const int spp = test.source.spp;
  return test.reference.spp.value_or(as_source ? spp : std::min(tracer::kMostSamples, times * spp));
}

}  // namespace becalm::app
