// Slots of bodies and colliders, reused after what was in them is destroyed.
#pragma once

#include <cstdint>
#include <vector>

namespace vp {

// The first free slot, or a new one.
template <class Slot>
std::uint32_t take_slot(std::vector<Slot>& slots, std::vector<std::uint32_t>& free) {
  std::uint32_t index = static_cast<std::uint32_t>(slots.size());
  if (free.empty()) {
    slots.emplace_back();
  } else {
    index = free.back();
    free.pop_back();
  }
  const std::uint32_t generation = slots[index].generation + 1;
  slots[index] = Slot{};
  slots[index].generation = generation;
  slots[index].alive = true;
  return index;
}

}  // namespace vp
