// The interface of an engine in the comparison, ours or a peer. Each engine is a separate program
// (runner.cpp has its main), so that its peak memory can be measured and a crash affects no other.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "scenes/scene.h"

namespace rigid {

class Engine {
 public:
  virtual ~Engine() = default;
  // Its settings, which its developers recommend, as a phrase for the table.
  virtual std::string settings() const = 0;
  // One step of the dt given at construction; only this is timed. False: it cannot continue.
  virtual bool step() = 0;
  // Why it cannot continue, after step() has returned false.
  virtual std::string trouble() const { return "no finite state"; }
  // Events between two steps (scenes::Event), not timed.
  virtual void launch(const scenes::Launch& launch) = 0;
  // By index, for scenes in which bodies appear and disappear. Not every engine gets these scenes.
  virtual void add_body(int) {}
  virtual void remove_body(int) {}
  virtual void add_joint(int) {}
  virtual void remove_joint(int) {}
  // T_world_body of all bodies, in the scene's order; the initial pose of a body that does not
  // exist.
  virtual std::vector<vp::SE3> poses() const = 0;
};

// For engines whose adapter supports only permanent, non-kinematic bodies of simple shapes: why it
// cannot run the scene; empty: it can.
inline std::string beyond_simple(const scenes::Scene& scene) {
  if (scenes::has_terrain(scene)) return "this comparison gives it no terrain";
  for (const scenes::Body& body : scene.bodies) {
    if (body.motion == scenes::Motion::kinematic)
      return "this comparison gives it bodies that it moves itself";
    if (body.from > 0.0 || std::isfinite(body.until))
      return "this comparison gives it bodies that are there all the time";
    for (const scenes::Part& part : body.parts) {
      if (std::holds_alternative<scenes::Hull>(part.shape) ||
          std::holds_alternative<scenes::Mesh>(part.shape)) {
        return "this comparison gives it no hulls and no meshes";
      }
    }
  }
  return {};
}

// The engine with the scene, or why it cannot run it. Each program defines it.
using MadeEngine = tl::expected<std::unique_ptr<Engine>, std::string>;
MadeEngine make_engine(const scenes::Scene& scene, double dt);

}  // namespace rigid
