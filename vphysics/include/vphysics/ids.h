// Handles to what a world owns: index and generation; zero is null. A handle to something destroyed
// is recognised as stale and never aliases what took its place.
//
// An id is of the world that gave it, and names the same in worlds made by the same sequence of
// calls. That it is of this world is not checked: in another it names what has its numbers there.
#pragma once

#include <compare>
#include <cstdint>

namespace vp {

template <class Tag>
struct Id {
  std::uint32_t index = 0;       // 1-based; 0 is null
  std::uint32_t generation = 0;  // bumped each time the slot is reused

  constexpr explicit operator bool() const { return index != 0; }
  constexpr auto operator<=>(const Id&) const = default;  // NOLINT(modernize-use-nullptr)
};

using BodyId = Id<struct BodyTag>;
using ColliderId = Id<struct ColliderTag>;
using ArticulationId = Id<struct ArticulationTag>;
using JointId = Id<struct JointTag>;

}  // namespace vp
