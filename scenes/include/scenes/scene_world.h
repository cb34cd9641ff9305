// A scene in a world of Virtual Physics, with what happens in it at its time.
#pragma once

#include <memory>
#include <vector>

#include "scenes/scene.h"
#include "vphysics/world.h"

namespace scenes {

// As the engine has it. Precondition: a terrain is one that the engine can have.
vp::Shape engine_shape(const Shape& shape);

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
  // Of all bodies of the scene, in their order; user data of a body and of its colliders is that
  // index too.
  const std::vector<vp::BodyId>& bodies() const { return bodies_; }
  std::vector<SE3> poses() const;

 private:
  SceneWorld(Scene scene, vp::World world) : scene_(std::move(scene)), world_(std::move(world)) {}
  vp::Expected<void> add_body(std::size_t index);
  vp::Expected<void> add_compound(std::size_t index);
  vp::Expected<void> add_collider(std::size_t index, const vp::Shape& shape,
                                  const SE3& T_body_shape, const Material& material);
  vp::Expected<void> add_joint(const Joint& joint);
  vp::Expected<void> launch(const Launch& launch);

  Scene scene_;
  vp::World world_;
  std::vector<vp::BodyId> bodies_;
  double time_ = 0.0;
  std::size_t launched_ = 0;
};

}  // namespace scenes
