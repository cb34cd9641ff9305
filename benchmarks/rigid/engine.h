// What the comparison asks of an engine, ours or a peer. Each is a program of its own (runner.cpp
// has its main), so that its peak of memory is its own and its crash ends nothing else.
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
  // The settings that its makers recommend, as a phrase for the table.
  virtual std::string settings() const = 0;
  // One step of the dt that it was made for; all that is timed. False: it cannot go on.
  virtual bool step() = 0;
  // Why it cannot, when step() has said so.
  virtual std::string trouble() const { return "no finite state"; }
  // What happens between two steps (scenes::Event), not timed.
  virtual void launch(const scenes::Launch& launch) = 0;
  // Of scenes in which bodies come and go, which not every engine is given: indices.
  virtual void add_body(int) {}
  virtual void remove_body(int) {}
  virtual void add_joint(int) {}
  virtual void remove_joint(int) {}
  // T_world_body of all bodies, in the scene's order; of one that does not exist that of its start.
  virtual std::vector<vp::SE3> poses() const = 0;
};

// Why it cannot have the scene, of an engine that has been taught bodies of simple shapes only,
// which are there all the time and which it moves itself; empty: it can.
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

// The engine with the scene in it, or why it cannot have it; each program has one.
using MadeEngine = tl::expected<std::unique_ptr<Engine>, std::string>;
MadeEngine make_engine(const scenes::Scene& scene, double dt);

}  // namespace rigid
