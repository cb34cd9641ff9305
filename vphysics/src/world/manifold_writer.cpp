#include "world/manifold_writer.h"

#include <algorithm>
#include <cmath>

#include "solve/passes.h"
#include "world/prefetch.h"

namespace vp {
namespace {

constexpr std::size_t kWriteGrain = 4;  // blocks: some microseconds

std::uint64_t block_of(const solve::ContactSlot& slot) {
  const std::uint32_t block = solve::ColourBlocks<1>::block_of(slot.index, slot.colour);
  return std::uint64_t{slot.region} << 48 | std::uint64_t{slot.colour} << 40 |
         std::uint64_t{slot.points} << 32 | block;
}

// The impulse of the old point with the same feature id; otherwise, since feature ids change when
// edges pass over each other, of the nearest old point within range.
float impulse_of(const Contact& contact, std::span<const float> impulses,
                 const collide::ManifoldPoint& p, double range) {
  float nearest = 0.0f;
  double min_distance_squared = range * range;
  for (std::size_t i = 0; i < contact.count; ++i) {
    if (contact.feature[i] == p.feature) return impulses[i];
    const Vec3 d = contact.position[i] - p.position;
    if (dot(d, d) >= min_distance_squared) continue;
    min_distance_squared = dot(d, d);
    nearest = impulses[i];
  }
  return nearest;
}

}  // namespace

void ManifoldWriter::reserve() {
  waiting_.reserve(kContactBatch);
  order_.reserve(kContactBatch);
  block_ends_.reserve(kContactBatch);
}

void ManifoldWriter::add(std::uint32_t contact, const collide::Manifold& manifold,
                         const collide::MotionToImpact& to_impact) {
  const Contact& c = s_.contact_store[contact];
  s_.contact_store.points +=
      static_cast<std::uint32_t>(std::min<int>(manifold.count, c.slot.points)) - c.count;
  if (waiting_.size() == kContactBatch) write();
  waiting_.push_back({contact, &manifold, &to_impact});
}

void ManifoldWriter::write() {
  order_.clear();
  for (std::uint32_t k = 0; k < waiting_.size(); ++k)
    order_.push_back({block_of(s_.contact_store[waiting_[k].contact].slot), k});
  std::sort(order_.begin(), order_.end(), [](const At& a, const At& b) {
    return a.block != b.block ? a.block < b.block : a.waiting < b.waiting;
  });
  block_ends_.clear();
  for (std::uint32_t k = 1; k <= order_.size(); ++k) {
    if (k == order_.size() || order_[k].block != order_[k - 1].block) block_ends_.push_back(k);
  }
  s_.workers.in_parallel(block_ends_.size(), kWriteGrain, [&](std::size_t begin, std::size_t end) {
    solve::NewContacts contacts{};
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t first = b == 0 ? 0 : block_ends_[b - 1];
      const Contact& c = s_.contact_store[waiting_[order_[first].waiting].contact];
      c.slot.points == 1 ? write_block<1>(first, block_ends_[b], contacts)
                         : write_block<4>(first, block_ends_[b], contacts);
    }
  });
  waiting_.clear();
}

// The contact takes over the points.
solve::NewContact ManifoldWriter::take(const Waiting& waiting, std::span<const float> impulses) {
  const collide::Manifold& m = *waiting.manifold;
  Contact& c = s_.contact_store[waiting.contact];
  const Collider &a = s_.colliders[c.a], &b = s_.colliders[c.b];
  solve::NewContact n{};
  n.normal = m.normal;
  // The world has no centre of its own: the other body's centre makes the arms short.
  n.x_a = reference_point(s_.bodies[a.body]) + waiting.to_impact->a;
  n.x_b = reference_point(s_.bodies[b.body]) + waiting.to_impact->b;
  if (end_of(s_.bodies, a.body).state == solve::kWorldState) n.x_a = n.x_b;
  if (end_of(s_.bodies, b.body).state == solve::kWorldState) n.x_b = n.x_a;
  n.count = std::min<int>(m.count, c.slot.points);
  n.slid_limit = slide_limit(a, b);
  for (int i = 0; i < n.count; ++i) {
    const collide::ManifoldPoint& p = m.points[i];
    n.points[i] = {p.position, p.separation, impulse_of(c, impulses, p, 4.0 * n.slid_limit)};
  }
  n.friction = std::sqrt(a.material.friction * b.material.friction);
  n.restitution = std::max(a.material.restitution, b.material.restitution);
  n.rolling = std::max(a.material.rolling_friction, b.material.rolling_friction);
  n.spinning = std::max(a.material.spinning_friction, b.material.spinning_friction);
  n.surface_velocity = a.T.rotate(a.surface_velocity) - b.T.rotate(b.surface_velocity);
  c.count = static_cast<std::uint8_t>(n.count);
  for (int i = 0; i < n.count; ++i) {
    c.feature[i] = m.points[i].feature;
    c.position[i] = m.points[i].position;
  }
  return n;
}

// contacts: scratch. Lanes that are not used are computed too, from what an earlier block has left.
template <int P>
void ManifoldWriter::write_block(std::size_t begin, std::size_t end, solve::NewContacts& contacts) {
  contacts.lanes = 0;
  solve::ContactBlock<P>* block = nullptr;
  for (std::size_t k = begin; k < end; ++k) {
    prefetch_contacts(
        s_, [&](std::size_t i) { return waiting_[order_[i].waiting].contact; }, k, order_.size());
    const Waiting& waiting = waiting_[order_[k].waiting];
    const Contact& c = s_.contact_store[waiting.contact];
    const int lane = solve::ContactGraph::lane(c.slot);
    block = &s_.contact_store.graph.block<P>(c.slot);
    float impulses[P];
    for (int i = 0; i < P; ++i) impulses[i] = block->impulse[i].lane[lane];
    const solve::NewContact contact = take(waiting, impulses);
    put(contacts, lane, contact, s_.body_states[block->a.lane[lane]],
        s_.body_states[block->b.lane[lane]]);
    block->touches.lane[lane] = c.touching ? 1 : 0;
  }
  if constexpr (P == 1)
    solve::passes().one.renew(*block, contacts);
  else
    solve::passes().four.renew(*block, contacts);
}

}  // namespace vp
