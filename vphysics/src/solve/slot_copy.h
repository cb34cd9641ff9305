// Copies slots between blocks. In memory, every field of a block is kLanes adjacent words.
#pragma once

#include <cstddef>
#include <cstring>

#include "solve/contact_block.h"

namespace vp::solve {

// Copies all fields of a slot.
template <class Block>
void copy_slot(const Block& from, int from_slot, Block& to, int to_slot) {
  const auto* source = reinterpret_cast<const std::byte*>(&from) + sizeof(float) * from_slot;
  auto* target = reinterpret_cast<std::byte*>(&to) + sizeof(float) * to_slot;
  for (std::size_t f = 0; f < sizeof(Block) / sizeof(Field); ++f) {
    std::memcpy(target + f * sizeof(Field), source + f * sizeof(Field), sizeof(float));
  }
}

}  // namespace vp::solve
