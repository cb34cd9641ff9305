// A scene in a world of Virtual Physics, with what happens in it at its time.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "scenes/scene.h"
#include "vphysics/world.h"

namespace scenes {

// Shapes as the engine has them. What shares its data here does so there.
class EngineShapes {
 public:
  // Refused: what the engine refuses.
  vp::Expected<vp::Shape> of(const Shape& shape);

 private:
  std::map<const void*, vp::Shape> made_;
};

class SceneWorld {
 public:
  // settings.gravity is the scene's. Refused: what the engine cannot have, with its reason.
  static vp::Expected<SceneWorld> create(Scene scene, vp::WorldDesc settings = {});

  // One step of the world; what is due before its middle happens first.
  vp::Expected<vp::StepStatus> step(double dt);

  const Scene& scene() const { return scene_; }
  double time() const { return time_; }  // [s] since the start
  vp::World& world() { return world_; }
  const vp::World& world() const { return world_; }
  // Of all bodies of the scene, in their order, null of one that does not exist now; user data of a
  // body and of its colliders is that index too.
  const std::vector<vp::BodyId>& bodies() const { return bodies_; }
  // How many of the scene's events have happened: bodies come and go with them alone.
  std::size_t happened() const { return happened_; }
  // What does not exist has the pose that it starts with.
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
