// What flows inwards, from slots to their parents: loads, in places of a data's memory (Slot::from,
// Slot::to). The first place is always empty, the second is the next slot's; where a tree forks the
// other branches have places of their own.
#pragma once

#include "multibody/work.h"

namespace vp::detail {

template <class Load>
class ChildSum {
 public:
  explicit ChildSum(std::vector<Load>& frames) : places_(frames.data()) {}

  // Of the slots inwards from the last, each once: all that its children gave,
  const Load& take(const Slot& slot) {
    if (!slot.from_next_too) return places_[slot.from];
    places_[Slot::kNext] = places_[Slot::kNext] + places_[slot.from];
    return places_[Slot::kNext];
  }
  // then what it gives itself.
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

// The same for loads so small that the next slot's stays in registers: Load::from and Load::to are
// how it is read from a place and written there.
template <class Load, class Place>
class LightChildSum {
 public:
  explicit LightChildSum(std::vector<Place>& frames) : places_(frames.data()) {}

  // What its children gave comes on top of the slot's own.
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
