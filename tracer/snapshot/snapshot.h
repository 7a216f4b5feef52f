#pragma once

#include <Imath/ImathBox.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "tracer/lights/lights.h"
#include "tracer/media/medium.h"
#include "tracer/scene/scene_description.h"
#include "tracer/snapshot/frame_shapes.h"
#include "tracer/snapshot/intersect.h"
#include "tracer/snapshot/motion_steps.h"

namespace becalm::tracer {

inline constexpr std::uint32_t kNoLight = ~0u;

/// An object's transforms at one moment.
struct Place {
  M44f to_world;
  M44f normal_to_world;  ///< the inverse transpose up to a positive factor: the outside stays outside under
                         ///< mirroring
};

/// One object at a frame.
struct ObjectState {
  Shape shape;
  const Mesh* mesh = nullptr;  ///< null where there are no triangles
  const Material* material = nullptr;
  const Medium* interior = nullptr;
  bool material_varies = false;  ///< over the surface, or by a random choice
  Place place;                   ///< when the shutter opens, and all the time if the object does not move
  MotionSteps<float> blur;       ///< while the shutter is open
  MotionSteps<double> exact;     ///< the same in double, and a frame before: for the motion AOV
  MotionSteps<double> exact_previous;
  float scale = 1.0f;                    ///< bound of |p to_world| / |p| without the translation
  float length_scale = 1.0f;             ///< cube root of the factor by which volumes grow
  float translation = 0.0f;              ///< largest coordinate of the translation
  std::uint32_t first_light = kNoLight;  ///< number of its first triangle among the lights' triangles, or of
                                         ///< its sphere among the spheres
  V3f emission{0.0f};
  std::uint16_t light_group = 0;
  bool two_sided = false;

  bool blurred() const { return blur.moving(); }
  /// The place at that time in [0,1] of the shutter's interval.
  Place at(float time) const;
};

/// The scene at one frame, as paths query it. It is kept from frame to frame: only what differs is evaluated,
/// committed or built anew.
class Snapshot {
 public:
  /// The description must outlive the snapshot and keep its address.
  Snapshot(const SceneDescription& description, int frame);

  /// Throws as Scene::at_frame does.
  void set_frame(int frame);

  const SceneDescription& description() const { return *description_; }
  const Intersector& intersector() const { return *intersector_; }
  const Lights& lights() const { return lights_; }
  const ObjectState& object(std::uint32_t index) const { return objects_[index]; }
  /// Memory of procedural surfaces and media.
  std::size_t procedural_bytes() const { return shapes_.procedural_bytes(); }
  std::size_t media_bytes() const;

 private:
  void place(std::size_t index, int frame);
  void measure();
  void build_lights(int frame);
  void update_media(int frame);

  const SceneDescription* description_;
  int frame_ = 0;
  bool whole_ = true;  ///< false while set_frame() works, and after it has thrown
  FrameShapes shapes_;
  std::vector<ObjectState> objects_;
  std::unique_ptr<Intersector> intersector_;
  Lights lights_;
  std::vector<Medium> interiors_;  ///< of each object that has one, in their order
};

}  // namespace becalm::tracer
