#pragma once

#include <memory>

#include "tracer/scene/scene_description.h"
#include "tracer/scene/scene_needs.h"

namespace becalm::tracer {

class Snapshot;

/// A scene ready to be rendered: the description, what it needs, and what is kept from frame to frame.
class Scene {
 public:
  explicit Scene(SceneDescription description);
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  const SceneDescription& description() const { return *description_; }
  const SceneNeeds& needs() const { return needs_; }

  /// The scene at that frame. Only what differs from the frame asked for before is built anew; the reference
  /// stays valid until the next call. Throws Error(bad_input) for a camera that has no direction there,
  /// Error(resource) when the geometry does not fit into memory.
  const Snapshot& at_frame(int frame);

 private:
  std::unique_ptr<SceneDescription> description_;  ///< its address stays, since the snapshot refers to it
  SceneNeeds needs_;
  std::unique_ptr<Snapshot> snapshot_;
};

}  // namespace becalm::tracer
