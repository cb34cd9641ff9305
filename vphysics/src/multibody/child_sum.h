// Child accumulation, tip to base: loads passed from slots to their parents, stored in entries of a
// data's memory (Slot::from, Slot::to). The first entry is always empty, the second is for the next
// slot. Where a tree branches, the other branches have entries of their own.
#pragma once

#include "multibody/work.h"

namespace vp::detail {

template <class Load>
class ChildSum {
 public:
  explicit ChildSum(std::vector<Load>& entries) : entries_(entries.data()) {}

  // Call take() and then give() for each slot, from the last to the first. take: the sum of the
  // children's loads.
  const Load& take(const Slot& slot) {
    if (!slot.from_next_too) return entries_[slot.from];
    entries_[Slot::kNext] = entries_[Slot::kNext] + entries_[slot.from];
    return entries_[Slot::kNext];
  }
  // give: the slot's load for its parent.
  void give(const Slot& slot, const Load& load) {
    Load& entry = entries_[slot.to];
    if (slot.adds) {
      entry = entry + load;
    } else {
      entry = load;
    }
  }

 private:
  Load* entries_;
};

// The same for loads so small that the next slot's load stays in registers. Load::from and Load::to
// convert from and to an entry.
template <class Load, class Entry>
class LightChildSum {
 public:
  explicit LightChildSum(std::vector<Entry>& entries) : entries_(entries.data()) {}

  // Adds the loads of the children to the slot's own load.
  Load add(const Slot& slot, Load load) const {
    if (slot.from == Slot::kNext || slot.from_next_too) load = load + next_;
    if (slot.from >= Slot::kOthers) load = load + Load::from(entries_[slot.from].x);
    return load;
  }
  void give(const Slot& slot, const Load& load) {
    next_ = load;
    if (slot.to < Slot::kOthers) return;
    Entry& entry = entries_[slot.to];
    (slot.adds ? Load::from(entry.x) + load : load).to(entry.x);
  }

 private:
  Entry* entries_;
  Load next_{};
};

}  // namespace vp::detail
