// What the comparison asks of an engine, ours or a peer. Each is a program of its own (runner.cpp
// has its main), so that its peak of memory is its own and its crash ends nothing else.
#pragma once

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
  // Between two steps.
  virtual void launch(const scenes::Launch& launch) = 0;
  // T_world_body of all bodies, in the scene's order.
  virtual std::vector<vp::SE3> poses() const = 0;
};

// The engine with the scene in it, or why it cannot have it; each program has one.
using MadeEngine = tl::expected<std::unique_ptr<Engine>, std::string>;
MadeEngine make_engine(const scenes::Scene& scene, double dt);

}  // namespace rigid
