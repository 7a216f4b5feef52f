#include "tracer/snapshot/scene.h"

#include "tracer/snapshot/snapshot.h"

namespace becalm::tracer {

Scene::Scene(SceneDescription description)
    : description_(std::make_unique<SceneDescription>(std::move(description))),
      needs_(compute_needs(*description_)) {}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

const Snapshot& Scene::at_frame(int frame) {
  if (snapshot_) {
    snapshot_->set_frame(frame);
  } else {
    snapshot_ = std::make_unique<Snapshot>(*description_, frame);
  }
  return *snapshot_;
}

}  // namespace becalm::tracer
