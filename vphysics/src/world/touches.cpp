// Contact events of the sub-stepped solver, and the impulses that contacts_of() reports.
#include <algorithm>
#include <bit>

#include "world/impl.h"
#include "world/lane_fields.h"

namespace vp {
namespace {

// The impulse that a contact slot reports.
template <int P>
double impulse_of(const solve::ContactBlock<P>& block, int lane) {
  return get(block.given, lane) + get(block.impact, lane);
}
// Converts the contact changes of the sub-steps into events.
struct TouchReport {
  ContactStore& contacts;
  const Colliders& colliders;
  Events& events;

  template <int P>
  void report_slot(solve::ContactBlock<P>& block, int lane, bool loaded) {
    const std::uint32_t index = block.contact.lane[lane];
    Contact& c = contacts[index];
    const double approach_speed = get(block.approach_speed, lane);
    const double impulse = impulse_of(block, lane);
    block.given.lane[lane] += block.impact.lane[lane];  // for contacts_of()
    block.approach_speed.lane[lane] = block.impact.lane[lane] = 0.0f;
    block.touches.lane[lane] = loaded ? 1 : 0;
    if (c.is_part()) {
      c.touching = loaded;
      events.part_events.push_back({c.aggregate, index, approach_speed, loaded ? impulse : 0.0,
                                    c.position[0], get(block.normal, lane)});
      return;
    }
    if (!loaded) {
      if (c.touching) events.touch(colliders, c, false);
      return;
    }
    const ColliderPair pair{c.key, c.a, c.b};
    const auto tell = [&](ContactEvent::Kind kind) {
      events.emit(colliders, kind, pair, c.position[0], get(block.normal, lane), approach_speed,
                  impulse, 0.0);
    };
    if (!c.touching) tell(ContactEvent::Kind::begin);
    c.touching = true;
    if (approach_speed > 0.0) tell(ContactEvent::Kind::hit);
  }

  // One event for each aggregate contact: the impulses of its changed parts add up; the part with
  // the largest impulse gives point and normal.
  void report_parts() {
    std::vector<PartEvent>& changed = events.part_events;
    std::sort(changed.begin(), changed.end(), [](const PartEvent& a, const PartEvent& b) {
      return a.aggregate != b.aggregate ? a.aggregate < b.aggregate : a.part < b.part;
    });
    for (std::size_t k = 0; k < changed.size();) {
      PartEvent sum = changed[k];
      double max_impulse = sum.impulse;
      for (++k; k < changed.size() && changed[k].aggregate == sum.aggregate; ++k) {
        const PartEvent& other = changed[k];
        if (other.impulse > max_impulse) {
          max_impulse = other.impulse;
          sum.point = other.point;
          sum.normal = other.normal;
        }
        sum.impulse += other.impulse;
        sum.approach_speed = std::max(sum.approach_speed, other.approach_speed);
      }
      Contact& aggregate = contacts[sum.aggregate];
      const bool touches = contacts.touches_in_parts(aggregate);
      if (!touches) {
        if (aggregate.touching) events.touch(colliders, aggregate, false);
        continue;
      }
      const ColliderPair pair{aggregate.key, aggregate.a, aggregate.b};
      const auto tell = [&](ContactEvent::Kind kind) {
        events.emit(colliders, kind, pair, sum.point, sum.normal, sum.approach_speed, sum.impulse,
                    0.0);
      };
      if (!aggregate.touching) tell(ContactEvent::Kind::begin);
      aggregate.touching = true;
      if (sum.approach_speed > 0.0) tell(ContactEvent::Kind::hit);
    }
    changed.clear();
  }
};

}  // namespace

void World::Impl::report_changes() {
  counters.contacts += contact_store.points;
  TouchReport report{contact_store, colliders, events};
  std::size_t next = 0;
  contact_runs().for_runs([&](const auto&, const auto&, auto& blocks) {
    for (auto& block : blocks) {
      const std::uint32_t found = sub_step.blocks.words[next++];
      for (std::uint32_t bits = found & 0xffffu; bits != 0; bits &= bits - 1) {
        const int lane = std::countr_zero(bits);
        report.report_slot(block, lane, ((found >> (16 + lane)) & 1u) != 0);
      }
    }
  });
  report.report_parts();
}

}  // namespace vp
