// In the place of the library's, for bench_align, which has no network: with that it would need oneDNN and
// oneTBB wherever it is copied to.

#include "filter/smooth/host_features.h"

namespace becalm::filter {

std::array<gpu::ImageId, kScales> add_host_features(gpu::Chain&, const NetworkWeights&, gpu::Extent,
                                                    gpu::ImageId) {
  throw gpu::DeviceError("bench_align has no network");
}

}  // namespace becalm::filter
