// Handles of the objects that a world owns: index and generation. Zero is null. The id of a
// destroyed object is recognised as invalid; it never aliases the object that reuses its slot.
//
// An id belongs to the world that returned it. Worlds made by the same sequence of calls have the
// same ids. The world does not check that an id is its own: in another world the same numbers name
// another object.
#pragma once

#include <compare>
#include <cstdint>

namespace vp {

template <class Tag>
struct Id {
  std::uint32_t index = 0;       // 1-based; 0 is null
  std::uint32_t generation = 0;  // incremented each time the slot is reused

  constexpr explicit operator bool() const { return index != 0; }
  constexpr auto operator<=>(const Id&) const = default;  // NOLINT(modernize-use-nullptr)
};

using BodyId = Id<struct BodyTag>;
using ColliderId = Id<struct ColliderTag>;
using ArticulationId = Id<struct ArticulationTag>;
using JointId = Id<struct JointTag>;

}  // namespace vp
