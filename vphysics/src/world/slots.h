// Slots of bodies, colliders or joints, in order of creation. A slot is reused after its object is
// destroyed. Users hold ids: index + 1, and the generation of the slot's object.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "solve/large_pages.h"

namespace vp {

// Takes a free slot, or appends a new one.
template <class Vector>
std::uint32_t take_slot(Vector& slots, std::vector<std::uint32_t>& free) {
  const auto index = static_cast<std::uint32_t>(slots.size());
  if (free.empty()) {
    slots.emplace_back();
    return index;
  }
  const std::uint32_t last = free.back();
  free.pop_back();
  return last;
}

template <class T, class Id>
class Slots {
 public:
  // Null if the object does not exist (any more).
  const T* find(Id id) const {
    if (id.index == 0 || id.index > slots_.size()) return nullptr;
    const T& slot = slots_[id.index - 1];
    return slot.alive && slot.generation == id.generation ? &slot : nullptr;
  }
  T* find(Id id) { return const_cast<T*>(std::as_const(*this).find(id)); }
  Id id(std::uint32_t index) const { return {index + 1, slots_[index].generation}; }
  std::uint32_t index_of(const T& slot) const {
    return static_cast<std::uint32_t>(&slot - slots_.data());
  }

  std::uint32_t take() {
    const std::uint32_t index = take_slot(slots_, free_);
    const std::uint32_t generation = slots_[index].generation + 1;
    slots_[index] = T{};
    slots_[index].generation = generation;
    slots_[index].alive = true;
    return index;
  }
  void release(std::uint32_t index) {
    slots_[index].alive = false;
    free_.push_back(index);
  }

  T& operator[](std::size_t index) { return slots_[index]; }
  const T& operator[](std::size_t index) const { return slots_[index]; }
  std::size_t size() const { return slots_.size(); }
  bool empty() const { return slots_.empty(); }
  auto begin() { return slots_.begin(); }
  auto end() { return slots_.end(); }
  auto begin() const { return slots_.begin(); }
  auto end() const { return slots_.end(); }

 private:
  solve::LargeVector<T> slots_;
  std::vector<std::uint32_t> free_;
};

}  // namespace vp
