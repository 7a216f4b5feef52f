// What a path does inside objects: interfaces, scattering, shadow rays that media dim. Included by
// path_trace.cpp alone.

namespace becalm::tracer {

template <Features F>
bool Path<F>::cross_interface(const ObjectState& object, const Hit& hit, const Surface& surface) {
  if (++crossings_ > kMostCrossings) return false;
  cross_boundary(interiors_, object, hit.object, ray_.dir, surface);
  travelled_ += hit.t;
  ray_.origin = offset_origin(surface, ray_.dir);
  skipped_ = skipped_length(surface, ray_.dir);
  next_ray_seed();
  return true;
}

/// Records that what the camera's ray meets first is the medium, which is taken to stand still.
template <Features F>
void Path<F>::see_primary_medium(float t) {
  const V3d position(ray_.origin + ray_.dir * t);
  see_primary(interiors_.innermost(), t, {position, position});
}

template <Features F>
bool Path<F>::scatter_in_medium(const Medium& medium, float t) {
  const V3f position = ray_.origin + ray_.dir * t;
  if (depth_ == 0) {
    if (!result_.covered) see_primary_medium(t);
    if constexpr (F.guides) result_.guides.albedo = clamp_to_unit(throughput_);
  } else if (F.guides && scatterings_ == 0) {
    result_.guides.albedo = clamp_to_unit(throughput_ / radiance_scale_);
  }
  if (depth_ == integrator_.max_depth || is_black(throughput_)) return false;

  const auto [u_light, u_light_point, u_shadow, u_phase, u_roulette] =
      sampler_.next<float, V2f, V2f, V2f, float>();
  const float g = mean_cosine(medium);
  if (draws_lights_) gather_direct_light_in_medium(position, g, {u_light, u_light_point, u_shadow});
  const PhaseSample scattered = sample_henyey_greenstein(g, -ray_.dir, u_phase);
  ++scatterings_;
  material_pdf_ = scattered.pdf_solid_angle;
  previous_position_ = position;
  if constexpr (F.textures) {
    differential_.dpdx += differential_.dddx * t;
    differential_.dpdy += differential_.dddy * t;
    differential_ = becalm::tracer::scattered(differential_, scattered.wi, kScatteredSpread);
  }
  ray_.origin = position;
  skipped_ = 0.0f;
  ray_.dir = scattered.wi;
  return survives_roulette(u_roulette);
}

template <Features F>
void Path<F>::gather_direct_light_in_medium(const V3f& position, float g, const LightNumbers& u) {
  previous_ = snapshot_.lights().received(position, time_);
  const std::optional<LightSample> light = snapshot_.lights().sample(previous_, u.light, u.point);
  if (!light) return;
  const float phase = phase_henyey_greenstein(g, -ray_.dir, light->dir_world);
  V3f contribution = light->radiance * (phase / light->pdf_solid_angle);
  if (is_black(contribution)) return;
  if (integrator_.direct == Direct::mis && !light->delta)
    contribution *= mis_weight(integrator_.heuristic, light->pdf_solid_angle, phase);
  gather(throughput_ * contribution * visibility(position, position, 0.0f, *light, interiors_, u.shadow),
         scatterings_ + 1, light->group);
}

/// Transmittance along the shadow ray, which starts inside `interiors`, `skipped` beyond the surface that it
/// leaves; 0 if it hits anything but interfaces.
template <Features F>
V3f Path<F>::transmission(Ray shadow, float skipped, Interiors interiors, const V2f& u) {
  MediumRandom random(u);
  const float length = shadow.dir.length();  // finite lights' directions reach from here to there
  shadow.dir /= length;
  shadow.t_max *= length;
  V3f share(1.0f);
  for (int crossing = 0; shadow.t_max > 0.0f && crossing <= kMostCrossings; ++crossing) {
    const std::optional<Hit> hit = closest(shadow);
    if (hit && !snapshot_.object(hit->object).material->is_interface) return V3f(0.0f);
    if (!interiors.empty()) {
      const Medium& medium = *snapshot_.object(interiors.innermost()).interior;
      const float t_max = hit ? hit->t : shadow.t_max;
      share *=
          transmittance(medium, shadow.origin - shadow.dir * skipped, shadow.dir, t_max + skipped, random);
      if (is_black(share)) return share;
    }
    if (!hit) return share;
    const ObjectState& object = snapshot_.object(hit->object);
    const Surface surface = surface_of(object, *hit, object.mesh == nullptr ? footprint_at(hit->t) : 0.0f);
    cross_boundary(interiors, object, hit->object, shadow.dir, surface);
    shadow.origin = offset_origin(surface, shadow.dir);
    skipped = skipped_length(surface, shadow.dir);
    shadow.t_max -= hit->t;
    shadow.seed += kRaySeedStep;
  }
  return shadow.t_max > 0.0f ? V3f(0.0f) : share;  // as paths end that cross as many
}

}  // namespace becalm::tracer
