// Child accumulation, tip to base: loads passed from slots to their parents, stored in entries of a
// data's memory (Slot::from, Slot::to). The first entry is always empty, the second is for the next
// slot. Where a tree branches, the other branches have entries of their own.
#pragma once

#include "multibody/work.h"

namespace vp::detail {

template <class Load>
class ChildSum {
 public:
  explicit ChildSum(std::vector<Load>& frames) : places_(frames.data()) {}

  // Call take() and then give() for each slot, from the last to the first. take: the sum of the
  // children's loads.
  const Load& take(const Slot& slot) {
    if (!slot.from_next_too) return places_[slot.from];
    places_[Slot::kNext] = places_[Slot::kNext] + places_[slot.from];
    return places_[Slot::kNext];
  }
  // give: the slot's load for its parent.
  void give(const Slot& slot, const Load& load) {
    Load& frame = places_[slot.to];
    if (slot.adds) {
      frame = frame + load;
    } else {
      frame = load;
    }
  }

 private:
  Load* places_;
};

// The same for loads so small that the next slot's load stays in registers. Load::from and Load::to
// convert from and to an entry.
template <class Load, class Place>
class LightChildSum {
 public:
  explicit LightChildSum(std::vector<Place>& frames) : places_(frames.data()) {}

  // Adds the loads of the children to the slot's own load.
  Load add(const Slot& slot, Load load) const {
    if (slot.from == Slot::kNext || slot.from_next_too) load = load + next_;
    if (slot.from >= Slot::kOthers) load = load + Load::from(places_[slot.from].x);
    return load;
  }
  void give(const Slot& slot, const Load& load) {
    next_ = load;
    if (slot.to < Slot::kOthers) return;
    Place& frame = places_[slot.to];
    (slot.adds ? Load::from(frame.x) + load : load).to(frame.x);
  }

 private:
  Place* places_;
  Load next_{};
};

}  // namespace vp::detail
