#include "solve/speculative_list.h"

#include "solve/slot_copy.h"

namespace vp::solve {
namespace {

const SpeculativeBlock& empty_speculative_block() {
  static const SpeculativeBlock kEmpty = [] {
    SpeculativeBlock block;
    std::memset(static_cast<void*>(&block), 0, sizeof block);
    for (std::uint32_t& c : block.contact.lane) c = kNoContact;
    for (float& c : block.clearance.lane) c = kFarSeparated;
    return block;
  }();
  return kEmpty;
}

}  // namespace

std::uint32_t SpeculativeList::add(std::uint32_t contact, std::uint32_t row_a,
                                   std::uint32_t row_b) {
  const std::uint32_t index = lanes_++;
  if (index / kLanes == blocks_.size()) blocks_.push_back(empty_speculative_block());
  SpeculativeBlock& to = block(index);
  to.a.lane[lane(index)] = row_a;
  to.b.lane[lane(index)] = row_b;
  to.contact.lane[lane(index)] = contact;
  to.clearance.lane[lane(index)] = 0.0f;
  return index;
}

std::uint32_t SpeculativeList::add(const SpeculativeList& from, std::uint32_t index) {
  const std::uint32_t slot = add(0, 0, 0);
  copy_slot(from.block(index), lane(index), block(slot), lane(slot));
  return slot;
}

std::uint32_t SpeculativeList::remove(std::uint32_t index) {
  const std::uint32_t last = --lanes_;
  std::uint32_t moved = kNoContact;
  if (last != index) {
    copy_slot(block(last), lane(last), block(index), lane(index));
    moved = block(index).contact.lane[lane(index)];
  }
  copy_slot(empty_speculative_block(), 0, block(last), lane(last));
  if (lane(last) == 0) blocks_.pop_back();
  return moved;
}

}  // namespace vp::solve
