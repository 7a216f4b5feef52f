#include "tracer/film.h"

namespace becalm::tracer {

namespace {

/// Variances of radiances beyond 1e19 do not fit into float; they become its largest value instead of
/// infinity.
float to_float(double v) {
  constexpr double largest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(v, -largest, largest));
}

template <class Vec>
void store(Image& image, int x, int y, const Vec& value) {
  const std::span<float> pixel = image.pixel(x, y);
  for (unsigned c = 0; c < Vec::dimensions(); ++c) pixel[c] = to_float(value[c]);
}

template <class Vec>
void store(Frame& frame, Aov aov, int x, int y, const Vec& value) {
  if (frame.has(aov)) store(frame.image(aov), x, y, value);
}

void store_id(Frame& frame, Aov aov, int x, int y, std::uint32_t id) {
  if (frame.has(aov)) frame.image(aov).at(x, y, 0) = static_cast<float>(id);
}

}  // namespace

void MajorityVote::add(std::uint32_t number) {
  for (auto& [candidate, count] : votes_) {
    if (candidate != number) continue;
    ++count;
    return;
  }
  votes_.emplace_back(number, 1);
}

std::uint32_t MajorityVote::winner() const {
  std::pair<std::uint32_t, std::uint32_t> best{0, 0};
  for (const auto& vote : votes_) {
    if (vote.second > best.second || (vote.second == best.second && vote.first < best.first)) best = vote;
  }
  return best.first;
}

void SplitStatistics::clear() {
  count_ = 0;
  direct_ = indirect_ = V3d(0.0);
  std::fill(groups_.begin(), groups_.end(), V3d(0.0));
}

void SplitStatistics::add(const RadianceSplit& split) {
  ++count_;
  direct_ += V3d(split.direct);
  indirect_ += V3d(split.indirect);
  for (std::size_t i = 0; i < groups_.size(); ++i) groups_[i] += V3d(split.groups[i]);
}

void SplitStatistics::write(Frame& frame, int x, int y) const {
  const double weight = count_ > 0 ? 1.0 / count_ : 0.0;
  store(frame, Aov::direct, x, y, direct_ * weight);
  store(frame, Aov::indirect, x, y, indirect_ * weight);
  for (std::size_t i = 0; i < frame.light_groups().size(); ++i) {
    store(frame.light_groups()[i].radiance, x, y, groups_[i] * weight);
  }
}

void PixelStatistics::close_block() {
  if (sums_.block_count == 0) return;
  const double weight = sums_.block_count;
  const V3d delta = sums_.block_sum / weight - sums_.mean;
  sums_.count += sums_.block_count;
  sums_.mean += delta * (weight / sums_.count);
  sums_.squares += weight * delta * (sums_.block_sum / weight - sums_.mean);
  ++sums_.blocks;
  sums_.block_count = 0;
  sums_.block_sum = V3d(0.0);
}

V3d PixelStatistics::variance_of_mean() const {
  // One block has no spread. Its square estimates the second moment, which is at least the variance: the
  // noise is overestimated instead of being 0.
  if (sums_.blocks < 2) return sums_.mean * sums_.mean;
  return sums_.squares / (double(sums_.count) * (sums_.blocks - 1.0));
}

void PixelStatistics::write(Frame& frame, int x, int y) {
  close_block();
  const double weight = sums_.count > 0 ? 1.0 / sums_.count : 0.0;
  store(frame, Aov::beauty, x, y,
        Imath::Vec4<double>(sums_.mean.x, sums_.mean.y, sums_.mean.z, sums_.covered * weight));
  store(frame, Aov::variance, x, y, variance_of_mean());
  store(frame, Aov::half_a, x, y,
        sums_.half_count[0] > 0 ? sums_.half_sum[0] / sums_.half_count[0] : V3d(0.0));
  store(frame, Aov::half_b, x, y,
        sums_.half_count[1] > 0 ? sums_.half_sum[1] / sums_.half_count[1] : V3d(0.0));
  const double guide_weight = sums_.guide_count > 0 ? 1.0 / sums_.guide_count : 0.0;
  store(frame, Aov::albedo, x, y, sums_.guide_count > 0 ? sums_.albedo * guide_weight : V3d(1.0));
  store(frame, Aov::normal, x, y, sums_.normal * guide_weight);
  store(frame, Aov::motion, x, y, sums_.motion * guide_weight);
  store_id(frame, Aov::object_id, x, y, objects_.winner());
  store_id(frame, Aov::material_id, x, y, materials_.winner());
  if (frame.has(Aov::depth)) {
    frame.image(Aov::depth).at(x, y, 0) = sums_.depth_count > 0 ? to_float(sums_.depth / sums_.depth_count)
                                                                : std::numeric_limits<float>::infinity();
  }
}

}  // namespace becalm::tracer
