// What a path does at surfaces: emission, materials, direct light, the next direction. Included by
// path_trace.cpp alone.

namespace becalm::tracer {

template <Features F>
void Path<F>::gather_emission(const ObjectState& object, const Hit& hit, const Surface& surface) {
  const V3f radiance = emitted(object, surface, ray_.dir);
  if (is_black(radiance)) return;
  const float mis = weight([&] {
    if (object.first_light == kNoLight) return 0.0f;
    if (object.mesh == nullptr) return snapshot_.lights().pdf_sphere(object.first_light, previous_);
    const float distance = (surface.position - previous_position_).length();
    return snapshot_.lights().pdf_triangle(object.first_light + std::size_t{hit.triangle}, previous_,
                                           ray_.dir, distance);
  });
  gather(throughput_ * radiance * mis, scatterings_, object.light_group);
}

/// The BSDF at the hit: the material's ready one, or, where the material varies, one evaluated into `local`.
/// Bump and normal maps replace the surface's shading normal.
template <Features F>
const Bsdf& Path<F>::shade(const ObjectState& object, const Hit& hit, Surface& surface, float u_mix,
                           std::optional<Bsdf>& local, V3f& tangent) {
  if constexpr (F.textures) {
    if (object.material_varies) {
      const std::span<const Material> materials = snapshot_.description().materials;
      const SurfaceTangents around = tangents_at(object, place_of(object), hit);
      ParameterFootprint footprint;
      if (around.has_uvs)
        footprint = parameter_footprint(differential_.dpdx, differential_.dpdy, around.dpdu, around.dpdv);
      const TexturePoint point{surface.uv, footprint.duv_dx, footprint.duv_dy};
      const Material& material = resolve_mix(materials, *object.material, context_.textures, point, u_mix);
      if (has_relief(material) && around.has_uvs) {
        surface.normal_shading = perturbed_normal(
            material, context_.textures,
            {point, around.dpdu, around.dpdv, surface.normal_shading, surface.normal_geometric});
      }
      tangent = around.dpdu;
      local = evaluate_material(material, context_.textures, point);
    }
    if (surface.slope_variance > 0.0f) {
      if (!local) local = object.material->bsdf;
      widen(*local, surface.slope_variance);
    }
    if (local) return *local;
  }
  return object.material->bsdf;
}

template <Features F>
bool Path<F>::scatter(const ObjectState& object, const Hit& hit, Surface& surface) {
  const bool wants_guides = F.guides && scatterings_ == 0;
  const bool last = depth_ == integrator_.max_depth;
  if (last && !wants_guides) return false;
  V3f tangent(0.0f);
  const float u_mix = F.textures && context_.mixes ? sampler_.next_1d() : 0.0f;
  std::optional<Bsdf> local;
  const Bsdf& bsdf = shade(object, hit, surface, u_mix, local, tangent);
  const V3f wo_world = -ray_.dir;
  const V3f normal = visible_normal(surface, wo_world);
  const bool specular = F.surfaces && is_specular(bsdf);
  if (wants_guides && (!specular || last)) {
    result_.guides.albedo = clamp_to_unit(throughput_ / radiance_scale_ * albedo(bsdf));
    result_.guides.normal = normal.dot(wo_world) < 0.0f ? -normal : normal;
  } else if (wants_guides) {
    result_.guides.albedo = V3f(0.0f);  // stays if the path ends inside the mirror or glass
  }
  if (last || (context_.guides_only && !specular)) return false;

  // Every event draws the same dimensions, used or not, so that those of later events stay stratified among
  // samples.
  const auto [u_light, u_light_point, u_material, u_lobe, u_roulette] =
      sampler_.next<float, V2f, V2f, float, float>();
  const V2f u_shadow = F.media ? sampler_.next_2d() : V2f(0.0f);

  const ShadingFrame frame = F.textures && object.material_varies
                                 ? ShadingFrame::from_normal_and_tangent(normal, tangent)
                                 : ShadingFrame::from_normal(normal);
  const ShadingVertex vertex(surface, bsdf, frame, wo_world);
  if (draws_lights_ && !specular)
    gather_direct_light(object, hit.object, vertex, {u_light, u_light_point, u_shadow});

  const std::optional<BsdfSample> scattered = sample(bsdf, vertex.wo, u_material, u_lobe);
  if (!scattered) return false;
  const V3f wi_world = frame.to_world(scattered->wi).normalized();
  if (!vertex.consistent(scattered->wi, wi_world)) return false;
  throughput_ *= scattered->weight;
  if (is_black(throughput_)) return false;
  radiance_scale_ *= scattered->radiance_scale;
  if (!specular) ++scatterings_;
  material_pdf_ = scattered->specular ? 0.0f : scattered->pdf_solid_angle;
  if constexpr (F.textures) bend_differential(object, hit, normal, *scattered, wi_world);
  previous_position_ = surface.position;

  if (F.media && scattered->transmitted) cross_boundary(interiors_, object, hit.object, wi_world, surface);
  ray_.origin = offset_origin(surface, wi_world);
  if constexpr (F.media) skipped_ = skipped_length(surface, wi_world);
  ray_.dir = wi_world;
  return survives_roulette(u_roulette);
}

/// The differentials of the ray that leaves the hit.
template <Features F>
void Path<F>::bend_differential(const ObjectState& object, const Hit& hit, const V3f& normal,
                                const BsdfSample& scattered, const V3f& wi_world) {
  if (!scattered.specular) {
    differential_ = becalm::tracer::scattered(differential_, wi_world, kScatteredSpread);
    return;
  }
  const SurfaceDifferentials around = differentials_at(object, place_of(object), hit);
  const ParameterFootprint footprint =
      parameter_footprint(differential_.dpdx, differential_.dpdy, around.dpdu, around.dpdv);
  const V3f dndx = around.dndu * footprint.duv_dx.x + around.dndv * footprint.duv_dx.y;
  const V3f dndy = around.dndu * footprint.duv_dy.x + around.dndv * footprint.duv_dy.y;
  differential_ = scattered.transmitted ? refracted(differential_, ray_.dir, normal, dndx, dndy,
                                                    std::sqrt(scattered.radiance_scale))
                                        : reflected(differential_, ray_.dir, normal, dndx, dndy);
}

/// The light sample's part of the direct light.
template <Features F>
void Path<F>::gather_direct_light(const ObjectState& object, std::uint32_t number,
                                  const ShadingVertex& vertex, const LightNumbers& u) {
  const Receiver receiver = vertex.receiver();
  previous_ = snapshot_.lights().received(receiver, time_);
  const std::optional<LightSample> light = snapshot_.lights().sample(previous_, u.light, u.point);
  if (!light) return;
  const V3f wi = vertex.frame.to_local(light->dir_world);
  if (!vertex.consistent(wi, light->dir_world)) return;
  const BsdfValue bsdf = evaluate(vertex.bsdf, vertex.wo, wi);
  V3f contribution = bsdf.f_cos * light->radiance / light->pdf_solid_angle;
  if (is_black(contribution)) return;
  if (integrator_.direct == Direct::mis && !light->delta)
    contribution *= mis_weight(integrator_.heuristic, light->pdf_solid_angle, bsdf.pdf_solid_angle);
  Interiors interiors = interiors_;
  if (F.media && wi.z * vertex.wo.z < 0.0f)
    cross_boundary(interiors, object, number, light->dir_world, vertex.surface);
  const V3f from = offset_origin(vertex.surface, light->dir_world);
  const float skipped = F.media ? skipped_length(vertex.surface, light->dir_world) : 0.0f;
  gather(
      throughput_ * contribution * visibility(from, receiver.position, skipped, *light, interiors, u.shadow),
      scatterings_ + 1, light->group);
}

}  // namespace becalm::tracer
