// Between bodies and their rows of the sub-stepped solver, in one step.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "solve/body_row.h"
#include "world/body.h"
#include "world/loads.h"

namespace vp {

struct BodyRows {
  std::span<solve::BodyRow> rows;  // i + 1 is of body i
  std::span<std::array<float, 6>>
      start_displacements;  // of each body: its row's way when the step began
  const BodyLoads& loads;
  const WorldDesc& desc;
  double dt;
  int sub_steps;

  // Before the sub-steps. True if the row's way has become so long that it must begin again.
  bool load(Body& body, std::uint32_t index) const;
  // After them: the velocities of a dynamic body become those of the end of the step; more: what
  // its mean velocities over the step have more. False if they are out of range: it stands.
  bool settle(Body& body, std::uint32_t index, Velocity& more) const;
  // The same, and its pose, of a dynamic body that its row leads; false if it flies out of range.
  bool advance(Body& body, std::uint32_t index) const;

 private:
  bool leave_untouched(Body& body, std::uint32_t index) const;
};

}  // namespace vp
