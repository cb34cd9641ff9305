// Events of the contacts of the sub-stepped solver, and what of their impulses is worth telling.
#include <bit>

#include "world/impl.h"
#include "world/runs.h"

namespace vp {
namespace {

// What a lane tells of its contact.
struct Told {
  double impulse = 0.0, closing = 0.0;
  Vec3 normal;
};

template <int P>
Told told_by(const solve::ContactBlock<P>& block, int lane, int sub_steps) {
  Told told;
  float load = 0.0f;
  for (int i = 0; i < P; ++i) load += block.impulse[i].lane[lane];
  told.impulse =
      static_cast<double>(load) * sub_steps + static_cast<double>(block.impact.lane[lane]);
  told.closing = static_cast<double>(block.closing.lane[lane]);
  told.normal = {static_cast<double>(block.normal.x.lane[lane]),
                 static_cast<double>(block.normal.y.lane[lane]),
                 static_cast<double>(block.normal.z.lane[lane])};
  return told;
}

}  // namespace

void World::Impl::clear_hits() {
  for_runs([&](const auto&, const auto&, auto& blocks) {
    for (auto& block : blocks) block.closing = block.impact = {};
  });
}

void World::Impl::report_touch(std::uint32_t index, bool loaded) {
  Contact& c = contact_pool[index];
  c.touching = loaded;
  const ColliderPair pair{c.key, c.a, c.b};
  const auto kind = loaded ? ContactEvent::Kind::begin : ContactEvent::Kind::end;
  emit(kind, pair, loaded && c.count > 0 ? c.position[0] : Vec3{}, {}, 0.0, 0.0, 0.0);
}

// Before the last relaxing: what pushes two apart that overlap is a load, though nothing of it is
// left in the velocities.
void World::Impl::find_loaded() {
  std::size_t count = 0;
  for_runs([&](const auto& pass, const auto& run, auto& blocks) {
    lane_bits.resize(std::max(lane_bits.size(), count + blocks.size()));
    pass.find_loaded(run, lane_bits.data() + count);
    count += blocks.size();
  });
}

void World::Impl::report_touches(int sub_steps) {
  for (Body& body : bodies) body.rested = false;
  std::size_t first = 0;
  for_runs([&](const auto&, const auto&, auto& blocks) {
    const std::size_t count = blocks.size();
    const std::uint16_t* bits = lane_bits.data() + first;
    first += count;
    for (std::size_t b = 0; b < count; ++b) {
      const auto& block = blocks[b];
      for (int lane = 0; lane < solve::kLanes; ++lane) {
        const std::uint32_t index = block.contact.lane[lane];
        if (index == solve::kNoContact) break;
        Contact& c = contact_pool[index];
        const bool loaded = ((bits[b] >> lane) & 1u) != 0;
        if (loaded) {
          bodies[colliders[c.a].body].rested = true;
          bodies[colliders[c.b].body].rested = true;
          counters.contacts += c.count;
        }
        const bool hit = loaded && block.closing.lane[lane] > 0.0f;
        if (loaded == c.touching && !hit) continue;
        if (!loaded) {
          report_touch(index, false);
          continue;
        }
        const Told told = told_by(block, lane, sub_steps);
        const ColliderPair pair{c.key, c.a, c.b};
        if (!c.touching) {
          emit(ContactEvent::Kind::begin, pair, c.position[0], told.normal, told.closing,
               told.impulse, 0.0);
        }
        c.touching = true;
        if (hit) {
          emit(ContactEvent::Kind::hit, pair, c.position[0], told.normal, told.closing,
               told.impulse, 0.0);
        }
      }
    }
  });
}

}  // namespace vp
