#include "solve/speculative_list.h"

namespace vp::solve {
namespace {

constexpr SpeculativePair kEmptyPair = [] {
  SpeculativePair pair{};
  pair.contact = kNoContact;
  pair.clearance = kFarSeparated;
  return pair;
}();

SpeculativeBlock empty_speculative_block() {
  SpeculativeBlock block;
  for (SpeculativePair& pair : block.pairs) pair = kEmptyPair;
  return block;
}

}  // namespace

std::uint32_t SpeculativeList::add(std::uint32_t contact, std::uint32_t state_a,
                                   std::uint32_t state_b) {
  const std::uint32_t index = size_++;
  if (index / kLanes == blocks_.size()) blocks_.push_back(empty_speculative_block());
  SpeculativePair& to = pair(index);
  to.a = state_a;
  to.b = state_b;
  to.contact = contact;
  to.clearance = 0.0f;
  return index;
}

std::uint32_t SpeculativeList::add(const SpeculativeList& from, std::uint32_t index) {
  const std::uint32_t slot = add(0, 0, 0);
  pair(slot) = from.pair(index);
  return slot;
}

std::uint32_t SpeculativeList::remove(std::uint32_t index) {
  const std::uint32_t last = --size_;
  std::uint32_t moved = kNoContact;
  if (last != index) {
    pair(index) = pair(last);
    moved = pair(index).contact;
  }
  pair(last) = kEmptyPair;
  if (last % kLanes == 0) blocks_.pop_back();
  return moved;
}

}  // namespace vp::solve
