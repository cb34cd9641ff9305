// A scene in a world of Virtual Physics, with its events at their times.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "scenes/scene.h"
#include "vphysics/world.h"

namespace scenes {

// Converts shapes to the engine's. Shapes that share data here share it there.
class EngineShapes {
 public:
  // Fails if the engine rejects the shape.
  vp::Expected<vp::Shape> of(const Shape& shape);

 private:
  std::map<const void*, vp::Shape> made_;
};

class SceneWorld {
 public:
  // settings.gravity is replaced by the scene's. Fails with a reason if the engine rejects a part
  // of the scene.
  static vp::Expected<SceneWorld> create(Scene scene, vp::WorldDesc settings = {});

  // Steps the world. Events that are due before the middle of the step happen first.
  vp::Expected<vp::StepStatus> step(double dt);

  const Scene& scene() const { return scene_; }
  double time() const { return time_; }  // [s] since the start
  vp::World& world() { return world_; }
  const vp::World& world() const { return world_; }
  // The bodies of the scene, in their order; null for one that does not exist now. The user data of
  // a body and of its colliders is that index.
  const std::vector<vp::BodyId>& bodies() const { return bodies_; }
  // The number of the scene's events that have happened. Only events create and destroy bodies.
  std::size_t happened() const { return happened_; }
  // A body that does not exist has its initial pose.
  std::vector<SE3> poses() const;
  EngineShapes& shapes() { return shapes_; }

 private:
  SceneWorld(Scene scene, vp::World world);
  vp::Expected<void> handle(const Event& event);
  vp::Expected<void> add_body(std::size_t index);
  vp::Expected<void> add_compound(std::size_t index);
  vp::Expected<void> add_collider(std::size_t index, const vp::Shape& shape,
                                  const SE3& T_body_shape, const Material& material);
  vp::Expected<void> add_joint(std::size_t index);
  vp::Expected<void> launch(const Launch& launch);

  Scene scene_;
  vp::World world_;
  EngineShapes shapes_;
  std::vector<vp::BodyId> bodies_;
  std::vector<Event> events_;
  double time_ = 0.0;
  std::size_t happened_ = 0;
};

}  // namespace scenes
