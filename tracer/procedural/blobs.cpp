#include "tracer/procedural/blobs.h"

#include <numbers>

#include "tracer/procedural/first_root.h"
#include "tracer/procedural/unit_ray.h"
#include "tracer/procedural/vector_math.h"
#include "tracer/sampling/sobol.h"

namespace becalm::tracer {

namespace {

/// Distance below which a point counts as on the surface: what float coordinates up to 1 lose, and the
/// logarithm of a sum over all balls.
constexpr float kTolerance = 0x1p-20f;
constexpr float kFarAway = 1e6f;

/// The k-th number of a ball, in [0, 1).
double uniform(std::uint32_t seed, int ball, int k) {
  const std::uint64_t key = std::uint64_t{seed} << 32 | static_cast<std::uint32_t>(16 * ball + k);
  return to_unit_double(mix_bits(key + 0x9e3779b97f4a7c15ull));
}

/// A closed path inside the unit sphere: a Lissajous curve on each axis, of turns that differ by up to a half
/// from the mean.
V3d path(std::uint32_t seed, int ball, double turns) {
  V3d p;
  for (int axis = 0; axis < 3; ++axis) {
    const double speed = 0.5 + uniform(seed, ball, 2 * axis), start = uniform(seed, ball, 2 * axis + 1);
    p[axis] = std::sin(2.0 * std::numbers::pi * (speed * turns + start)) / std::numbers::sqrt3;
  }
  return p;
}

}  // namespace

bool Blobs::update(const BlobsDescription& description, double frame) {
  const double mean_radius = description.radius.at(frame)[0];
  const double turns = description.speed * description.time_s.at(frame)[0];
  const double unit = description.extent + mean_radius * (1.0 + description.variation);
  const float blend = static_cast<float>(description.blend / unit);
  Balls balls;
  balls.count = (description.count + kBallLanes - 1) / kBallLanes * kBallLanes;
  for (int i = 0; i < balls.count; ++i) {
    if (i >= description.count) {
      balls.x[i] = balls.y[i] = balls.z[i] = kFarAway;
      balls.radius[i] = 0.0f;
      continue;
    }
    const V3d p = path(description.seed, i, turns) * (description.extent / unit);
    balls.x[i] = static_cast<float>(p.x);
    balls.y[i] = static_cast<float>(p.y);
    balls.z[i] = static_cast<float>(p.z);
    const double part = 1.0 + description.variation * (2.0 * uniform(description.seed, i, 6) - 1.0);
    balls.radius[i] = static_cast<float>(mean_radius * part / unit);
  }
  const auto same = [&](const float* a, const float* b) { return std::equal(a, a + balls.count, b); };
  if (unit == unit_ && blend == blend_ && balls.count == balls_.count && same(balls.x, balls_.x) &&
      same(balls.y, balls_.y) && same(balls.z, balls_.z) && same(balls.radius, balls_.radius)) {
    return false;
  }
  unit_ = unit;
  blend_ = blend;
  balls_ = balls;
  unit_bounds_ = make_bounds();
  return true;
}

/// For each side of the box the nearest plane beyond which f > 0 for certain, by bisection: no point of a
/// plane is nearer to a centre than the plane is.
Imath::Box3f Blobs::make_bounds() const {
  Imath::Box3f box;
  const float* centres[3] = {balls_.x, balls_.y, balls_.z};
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      double inside = -2.0;
      int count = 0;
      for (int i = 0; i < balls_.count; ++i) {
        if (balls_.x[i] == kFarAway) continue;
        ++count;
        inside = std::max(inside, static_cast<double>(sign * centres[axis][i] + balls_.radius[i]));
      }
      double outside = inside + blend_ * std::log(static_cast<double>(count));
      for (int step = 0; step < 30; ++step) {
        const double middle = 0.5 * (inside + outside);
        double sum = 0.0;
        for (int i = 0; i < balls_.count; ++i) {
          if (balls_.x[i] == kFarAway) continue;
          sum += std::exp(-(middle - sign * centres[axis][i] - balls_.radius[i]) / blend_);
        }
        (sum < 1.0 ? outside : inside) = middle;
      }
      const float bound = sign * (static_cast<float>(outside) + 4.0f * kTolerance);
      (sign < 0.0f ? box.min : box.max)[axis] = bound;
    }
  }
  return box;
}

Imath::Box3f Blobs::bounds() const {
  const float unit = static_cast<float>(unit_);
  return {unit_bounds_.min * unit, unit_bounds_.max * unit};
}

V3f Blobs::centre(int i) const {
  return V3f(balls_.x[i], balls_.y[i], balls_.z[i]) * static_cast<float>(unit_);
}

float Blobs::radius(int i) const {
  return balls_.radius[i] * static_cast<float>(unit_);
}

Blobs::Field Blobs::field(const V3f& p) const {
  alignas(16) float distance[kMostBalls], to_x[kMostBalls], to_y[kMostBalls], to_z[kMostBalls];
  float least[kBallLanes], nearest[kBallLanes];
  std::fill(least, least + kBallLanes, HUGE_VALF);
  std::fill(nearest, nearest + kBallLanes, HUGE_VALF);
  for (int n = 0; n < balls_.count; n += kBallLanes) {
    for (int lane = 0; lane < kBallLanes; ++lane) {
      const int i = n + lane;
      const float x = p.x - balls_.x[i], y = p.y - balls_.y[i], z = p.z - balls_.z[i];
      const float from_centre = std::sqrt(x * x + y * y + z * z);
      // At a centre, which has no direction, the result is 0.
      const float per_length = 1.0f / std::max(from_centre, 1e-12f);
      to_x[i] = x * per_length;
      to_y[i] = y * per_length;
      to_z[i] = z * per_length;
      distance[i] = from_centre - balls_.radius[i];
      least[lane] = std::min(least[lane], distance[i]);
      nearest[lane] = std::min(nearest[lane], from_centre);
    }
  }
  const float smallest = *std::min_element(least, least + kBallLanes);
  const float per_blend = std::numbers::log2e_v<float> / blend_;
  float weight[kBallLanes] = {}, gx[kBallLanes] = {}, gy[kBallLanes] = {}, gz[kBallLanes] = {};
  for (int n = 0; n < balls_.count; n += kBallLanes) {
    for (int lane = 0; lane < kBallLanes; ++lane) {
      const int i = n + lane;
      const float w = exp2_fast((smallest - distance[i]) * per_blend);
      weight[lane] += w;
      gx[lane] += w * to_x[i];
      gy[lane] += w * to_y[i];
      gz[lane] += w * to_z[i];
    }
  }
  float sum = 0.0f;
  V3f gradient(0.0f);
  for (int lane = 0; lane < kBallLanes; ++lane) {
    sum += weight[lane];
    gradient += V3f(gx[lane], gy[lane], gz[lane]);
  }
  return {smallest - blend_ * std::log(sum), gradient / sum,
          *std::min_element(nearest, nearest + kBallLanes)};
}

std::optional<float> Blobs::intersect(const V3f& origin, const V3f& dir, float t_min, float t_max) const {
  const auto ray = clip_ray(origin, dir, t_min, t_max, unit_, unit_bounds_);
  if (!ray) return std::nullopt;
  Side side = Side::unknown;
  float t = 0.0f;
  while (t < ray->t_end || t == 0.0f) {
    const Field f = field(ray->origin + t * ray->dir);
    if (side == Side::unknown) side = side_of(f.value);
    const float sign = static_cast<float>(side);
    const float g = sign * f.value, dg = sign * f.gradient.dot(ray->dir);
    if (!(g > kTolerance)) return ray->outer_t(t);
    float step;
    if (side == Side::above) {
      step = safe_step({g, dg, 1.0f / blend_});
    } else {
      // Inside, -f bends by at most 1 / (distance from the nearest centre), which at most doubles within half
      // of it.
      const float room = 0.5f * f.nearest_centre;
      step = std::min(room, safe_step({g, dg, 1.0f / std::max(room, 1e-12f)}));
    }
    const float next = t + std::max(step, g);
    if (next == t) return ray->outer_t(t);
    t = next;
  }
  return std::nullopt;
}

ProceduralPoint Blobs::point(const V3f& p, float) const {
  const double unit = unit_;
  V3f q(V3d(p.x, p.y, p.z) / unit);
  Field f = field(q);
  // Two Newton steps along the gradient: p is close already.
  for (int step = 0; step < 2; ++step) {
    q -= f.value / std::max(f.gradient.dot(f.gradient), 1e-4f) * f.gradient;
    f = field(q);
  }
  // In a crease the gradient is short, and a ray must start further away for the field to exceed the
  // tolerance.
  const float steepness = f.gradient.length();
  const V3f normal = steepness > 0.0f ? f.gradient / steepness : V3f(0.0f, 1.0f, 0.0f);
  const float error = 8.0f * kTolerance / std::max(steepness, 0.05f);
  constexpr float per_turn = 0.5f * std::numbers::inv_pi_v<float>;
  const V2f uv(0.5f + per_turn * std::atan2(normal.x, normal.z),
               0.5f + 2.0f * per_turn * std::asin(std::clamp(normal.y, -1.0f, 1.0f)));
  return {V3f(V3d(q.x, q.y, q.z) * unit), normal, uv, error * static_cast<float>(unit), 0.0f};
}

}  // namespace becalm::tracer
