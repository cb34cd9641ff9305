// What flows inwards, from slots to their parents.
//
// Along a chain it stays in registers: the next slot's comes straight to the slot before it. Where
// a tree forks, the other branches wait in a sum in memory.
#pragma once

#include "multibody/work.h"

namespace vp::detail {

template <class Load>
class Inflow {
 public:
  explicit Inflow(std::vector<Load>& sums) : sums_(sums) {}

  // Of the slots inwards from the last, each once: all that its children gave,
  Load take(const Slot& slot) const {
    Load load = slot.from_next ? next_ : Load{};
    if (slot.from_sum >= 0) load = load + sums_[static_cast<std::size_t>(slot.from_sum)];
    return load;
  }
  // then what it gives itself.
  void give(const Slot& slot, const Load& load) {
    if (slot.to_previous) {
      next_ = load;
    } else if (slot.to_sum >= 0) {
      Load& sum = sums_[static_cast<std::size_t>(slot.to_sum)];
      sum = slot.opens_sum ? load : sum + load;
    }
  }

 private:
  std::vector<Load>& sums_;
  Load next_{};
};

}  // namespace vp::detail
