#include "tracer/path_trace.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "tracer/path.h"
#include "tracer/scene/relief.h"

namespace becalm::tracer {

namespace {

/// Radiance that the hit surface emits along the ray backward.
V3f emitted(const ObjectState& object, const Surface& surface, const V3f& ray_dir) {
  if (is_black(object.emission)) return V3f(0.0f);
  return object.two_sided || ray_dir.dot(surface.normal_geometric) < 0.0f ? object.emission : V3f(0.0f);
}

/// Offset from a point's raster position to its previous one. A point that was behind the previous camera has
/// none and counts as unmoved.
V2f motion(const std::optional<V2d>& current, const std::optional<V2d>& previous) {
  return current && previous ? V2f(*previous - *current) : V2f(0.0f);
}

V3f clamp_to_unit(const V3f& v) {
  return {std::clamp(v.x, 0.0f, 1.0f), std::clamp(v.y, 0.0f, 1.0f), std::clamp(v.z, 0.0f, 1.0f)};
}

}  // namespace

template <Features F>
bool Path<F>::step() {
  const std::optional<Hit> hit = closest(ray_);
  if constexpr (F.media) {
    MediumRandom random(sampler_.next_2d());
    if (!interiors_.empty()) {
      const Medium& medium = *snapshot_.object(interiors_.innermost()).interior;
      const V3f entry = ray_.origin - ray_.dir * skipped_;
      const float t_max = hit ? hit->t + skipped_ : kInfinity;
      const MediumSample event = sample_distance(medium, entry, ray_.dir, t_max, random, throughput_);
      if (depth_ == 0 && !result_.covered) {
        // The radiance passes by its share, without noise; only what the eye meets first is drawn.
        if (const std::optional<float> t = sample_absorption(medium, t_max, random, throughput_))
          see_primary_medium(beyond_origin(*t));
      }
      throughput_ *= event.weight;
      if (event.scattered) return scatter_in_medium(medium, beyond_origin(event.t));
      if (is_black(throughput_)) {  // too deep for any light to pass
        result_.covered = result_.covered || depth_ == 0;
        if (F.guides && scatterings_ == 0) result_.guides.albedo = V3f(0.0f);
        return false;
      }
    }
  }
  if (!hit) {
    escape();
    return false;
  }
  const ObjectState& object = snapshot_.object(hit->object);
  Surface surface = surface_of(object, *hit, object.mesh == nullptr ? footprint_at(hit->t) : 0.0f);
  if constexpr (F.textures)
    differential_ = transferred(differential_, ray_.dir, hit->t, surface.normal_geometric);
  if (F.media && object.material->is_interface) return cross_interface(object, *hit, surface);
  if (depth_ == 0 && !result_.covered)
    see_primary(hit->object, hit->t, F.guides ? point_motion(object, *hit, time_) : PointMotion{});
  gather_emission(object, *hit, surface);
  if (context_.log != nullptr) {
    context_.log->push_back({hit->object, surface.position, throughput_, result_.radiance});
  }
  return scatter(object, *hit, surface);
}

template <Features F>
void Path<F>::escape() {
  const bool is_first = depth_ == 0 && !result_.covered;
  if (is_first) result_.covered = snapshot_.description().environment.has_value();
  snapshot_.lights().for_each_infinite(
      ray_.dir, [&](const V3f& radiance, std::uint16_t group, const auto& pdf) {
        if (!is_black(radiance))
          gather(throughput_ * radiance * weight([&] { return pdf(previous_); }), scatterings_, group);
      });
  if constexpr (F.guides) {
    if (scatterings_ == 0) result_.guides.albedo = clamp_to_unit(throughput_ / radiance_scale_);
    if (is_first) {
      const V3d dir(ray_.dir);
      result_.guides.motion = motion(context_.cameras.current(time_).project_direction(dir),
                                     context_.cameras.previous(time_).project_direction(dir));
    }
  }
}

/// Records what the camera's ray meets first, at `distance` along it.
template <Features F>
void Path<F>::see_primary(std::uint32_t object, float distance, const PointMotion& point) {
  result_.covered = true;
  if constexpr (F.guides) {
    Guides& guides = result_.guides;
    guides.depth = travelled_ + distance;
    guides.motion = motion(context_.cameras.current(time_).project(point.current),
                           context_.cameras.previous(time_).project(point.previous));
    guides.ids = {object + 1, snapshot_.description().objects[object].material + 1};
  }
}

/// Counts the scattering that has just happened and decides whether the path goes on after it.
template <Features F>
bool Path<F>::survives_roulette(float u) {
  ++depth_;
  travelled_ = 0.0f;
  next_ray_seed();
  // Paths are kept until they reach the surface that gives albedo and normal, and past mirrors and glass,
  // through which lights are found by chance alone.
  if (depth_ < integrator_.roulette_depth || scatterings_ == 0 || material_pdf_ == 0.0f) return true;
  const float survival = std::min(1.0f, max_component(throughput_) / radiance_scale_);
  if (u >= survival) return false;
  throughput_ /= survival;
  return true;
}

/// Share of the light sample's radiance that arrives at `from`, which is `position` off its surface: by
/// `skipped` along the way to the light.
template <Features F>
V3f Path<F>::visibility(const V3f& from, const V3f& position, float skipped, const LightSample& light,
                        const Interiors& interiors, const V2f& u) {
  next_ray_seed();
  Ray shadow = ray_;
  shadow.origin = from;
  shadow.dir = light.dir_world;
  shadow.t_max = kInfinity;
  if (light.distance < kInfinity) {
    shadow.dir = position + light.dir_world * light.distance - from;
    // Points and spots have no surface to hit. For other lights the ray ends short of the light by the
    // rounding errors of both ends.
    const float size = std::max(light.extent, largest_coordinate(from));
    shadow.t_max = light.delta ? 1.0f : 1.0f - kShadowShortening - size * 0x1p-18f / light.distance;
  }
  if constexpr (F.media) return transmission(shadow, skipped, interiors, u);
  return shadow.t_max > 0.0f && occluded(shadow) ? V3f(0.0f) : V3f(1.0f);
}

}  // namespace becalm::tracer

#include "tracer/path_media.inl"
#include "tracer/path_surface.inl"

namespace becalm::tracer {

namespace {

template <Features F>
PathSample trace_path(const PathContext& context, const V2f& raster, Sampler& sampler) {
  return Path<F>(context, raster, sampler).trace();
}

template <Features F>
constexpr PathVariant variant(const char* name) {
  return {name, F.surfaces, F.textures, F.media, F.blur, &trace_path<F>};
}

// A ladder and not all combinations: a rung that is not needed costs 0 to 12%.
template <bool kGuides>
constexpr std::array kVariants = {
    variant<Features{false, false, false, false, kGuides}>("diffuse"),
    variant<Features{.surfaces = true, .textures = false, .media = false, .blur = false, .guides = kGuides}>(
        "surfaces"),
    variant<Features{.surfaces = true, .textures = true, .media = false, .blur = false, .guides = kGuides}>(
        "textures"),
    variant<Features{.surfaces = true, .textures = true, .media = false, .blur = true, .guides = kGuides}>(
        "blur"),
    variant<Features{.surfaces = true, .textures = true, .media = true, .blur = true, .guides = kGuides}>(
        "media"),
};

}  // namespace

std::span<const PathVariant> path_variants(bool with_guides) {
  return with_guides ? std::span(kVariants<true>) : std::span(kVariants<false>);
}

const PathVariant& select_path_variant(const SceneNeeds& needs, bool with_guides) {
  const bool textures = needs.textures || needs.procedurals || needs.relief || needs.mix || needs.tangents;
  const bool surfaces = needs.specular || needs.rough_specular || needs.alpha;
  const bool blur = needs.motion_blur || needs.depth_of_field;
  const std::span<const PathVariant> variants = path_variants(with_guides);
  const auto found = std::ranges::find_if(variants, [&](const PathVariant& has) {
    return has.surfaces >= surfaces && has.textures >= textures && has.media >= needs.media &&
           has.blur >= blur;
  });
  assert(found != variants.end());
  return *found;
}

}  // namespace becalm::tracer
