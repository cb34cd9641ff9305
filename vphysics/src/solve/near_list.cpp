#include "solve/near_list.h"

#include "solve/lane_copy.h"

namespace vp::solve {
namespace {

const NearBlock& empty_near_block() {
  static const NearBlock kEmpty = [] {
    NearBlock block;
    std::memset(static_cast<void*>(&block), 0, sizeof block);
    for (std::uint32_t& c : block.contact.lane) c = kNoContact;
    for (float& c : block.clearance.lane) c = kFarApart;
    return block;
  }();
  return kEmpty;
}

}  // namespace

std::uint32_t NearList::add(std::uint32_t contact, std::uint32_t row_a, std::uint32_t row_b) {
  const std::uint32_t index = lanes_++;
  if (index / kLanes == blocks_.size()) blocks_.push_back(empty_near_block());
  NearBlock& to = block(index);
  to.a.lane[lane(index)] = row_a;
  to.b.lane[lane(index)] = row_b;
  to.contact.lane[lane(index)] = contact;
  to.clearance.lane[lane(index)] = 0.0f;
  return index;
}

std::uint32_t NearList::add(const NearList& from, std::uint32_t index) {
  const std::uint32_t place = add(0, 0, 0);
  copy_lane(from.block(index), lane(index), block(place), lane(place));
  return place;
}

std::uint32_t NearList::remove(std::uint32_t index) {
  const std::uint32_t last = --lanes_;
  std::uint32_t moved = kNoContact;
  if (last != index) {
    copy_lane(block(last), lane(last), block(index), lane(index));
    moved = block(index).contact.lane[lane(index)];
  }
  copy_lane(empty_near_block(), 0, block(last), lane(last));
  if (lane(last) == 0) blocks_.pop_back();
  return moved;
}

}  // namespace vp::solve
