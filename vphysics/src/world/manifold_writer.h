// Writes the manifolds that the narrow phase has found into the contact slots, block by block.
//
// A slot is one lane of a block, in as many cache lines as the block has fields. So manifolds are
// collected first, and all slots of a block are written together, in SIMD lanes
// (solve/renew_pass.h) and by several workers. Between add() and write() a slot may move; its
// contact knows where it is.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collide/impact_manifold.h"
#include "solve/contact_slot.h"
#include "world/step_context.h"

namespace vp {

// Contacts that are tested, and whose slots are written, in one batch: few enough that most of what
// they read stays in the second-level cache, enough that several workers seldom wait for the last.
inline constexpr std::size_t kContactBatch = 512;

class ManifoldWriter {
 public:
  explicit ManifoldWriter(const Stores& stores) : s_(stores) {}

  void reserve();
  // Precondition: the contact has a slot, and no manifold that waits; the references stay valid
  // until write(). Writes all if a batch waits.
  void add(std::uint32_t contact, const collide::Manifold& manifold,
           const collide::MotionToImpact& to_impact);
  void write();

 private:
  struct Waiting {
    std::uint32_t contact;
    const collide::Manifold* manifold;
    const collide::MotionToImpact* to_impact;
  };
  // The block of a waiting manifold's slot.
  struct At {
    std::uint64_t block;
    std::uint32_t waiting;
  };
  solve::NewContact take(const Waiting& waiting, std::span<const float> impulses);
  // Those from begin to end in order_, all in one block of P points.
  template <int P>
  void write_block(std::size_t begin, std::size_t end, solve::NewContacts& contacts);

  const Stores s_;
  std::vector<Waiting> waiting_;
  std::vector<At> order_;                  // by block
  std::vector<std::uint32_t> block_ends_;  // in order_
};

}  // namespace vp
