#include "solve/near_list.h"

namespace vp::solve {
namespace {

constexpr NearPair kEmptyPair = [] {
  NearPair pair{};
  pair.contact = kNoContact;
  pair.clearance = kFarApart;
  return pair;
}();

NearBlock empty_near_block() {
  NearBlock block;
  for (NearPair& pair : block.pairs) pair = kEmptyPair;
  return block;
}

}  // namespace

std::uint32_t NearList::add(std::uint32_t contact, std::uint32_t row_a, std::uint32_t row_b) {
  const std::uint32_t index = size_++;
  if (index / kLanes == blocks_.size()) blocks_.push_back(empty_near_block());
  NearPair& to = pair(index);
  to.a = row_a;
  to.b = row_b;
  to.contact = contact;
  to.clearance = 0.0f;
  return index;
}

std::uint32_t NearList::add(const NearList& from, std::uint32_t index) {
  const std::uint32_t place = add(0, 0, 0);
  pair(place) = from.pair(index);
  return place;
}

std::uint32_t NearList::remove(std::uint32_t index) {
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
