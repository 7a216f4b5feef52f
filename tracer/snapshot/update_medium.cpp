#include "tracer/snapshot/update_medium.h"

namespace becalm::tracer {

namespace {

void update(const CloudDescription& cloud, double frame, const M44d& medium_to_world, Medium& medium) {
  CloudShape shape = cloud.shape;
  const auto offset = cloud.offset.at(frame);
  shape.offset = V3f(V3d(offset[0], offset[1], offset[2]));
  shape.evolution = static_cast<float>(cloud.evolution.at(frame)[0]);
  shape.coverage = static_cast<float>(cloud.coverage.at(frame)[0]);

  auto* grid = std::get_if<GridMedium>(&medium);
  if (grid == nullptr) grid = &medium.emplace<GridMedium>();
  if (grid->bytes() == 0 || !(grid->baked_shape == shape)) {
    grid->density = std::make_shared<const DensityGrid>(bake_cloud(shape));
    grid->baked_shape = shape;
  }
  grid->world_to_voxels = world_to_voxels(medium_to_world, shape.resolution);
  grid->extinction = static_cast<float>(cloud.extinction.at(frame)[0]);
  grid->albedo = cloud.albedo;
  grid->g = cloud.g;
}

}  // namespace

void update_medium(const MediumDescription& description, double frame, const M44d& medium_to_world,
                   Medium& medium) {
  if (const auto* cloud = std::get_if<CloudDescription>(&description)) {
    update(*cloud, frame, medium_to_world, medium);
  } else {
    medium = std::get<HomogeneousMedium>(description);
  }
}

}  // namespace becalm::tracer
