// Events of the contacts of the sub-stepped solver, and what of their impulses is worth telling.
#include <algorithm>
#include <bit>

#include "world/impl.h"
#include "world/lane_fields.h"

namespace vp {
namespace {

// What a lane tells of its contact, but for where.
template <int P>
double impulse_of(const solve::ContactBlock<P>& block, int lane) {
  return get(block.given, lane) + get(block.impact, lane);
}
// Turns what the sub-steps have found of contacts into events.
struct TouchReport {
  ContactStore& contacts;
  const Colliders& colliders;
  Events& events;

  template <int P>
  void report_lane(solve::ContactBlock<P>& block, int lane, bool loaded) {
    const std::uint32_t index = block.contact.lane[lane];
    Contact& c = contacts[index];
    const double closing = get(block.closing, lane);
    const double impulse = impulse_of(block, lane);
    block.given.lane[lane] += block.impact.lane[lane];  // for contacts_of()
    block.closing.lane[lane] = block.impact.lane[lane] = 0.0f;
    block.touches.lane[lane] = loaded ? 1 : 0;
    if (c.is_part()) {
      c.touching = loaded;
      events.news_of_parts.push_back({c.whole, index, closing, loaded ? impulse : 0.0,
                                      c.position[0], get(block.normal, lane)});
      return;
    }
    if (!loaded) {
      if (c.touching) events.touch(colliders, c, false);
      return;
    }
    const ColliderPair pair{c.key, c.a, c.b};
    const auto tell = [&](ContactEvent::Kind kind) {
      events.emit(colliders, kind, pair, c.position[0], get(block.normal, lane), closing, impulse,
                  0.0);
    };
    if (!c.touching) tell(ContactEvent::Kind::begin);
    c.touching = true;
    if (closing > 0.0) tell(ContactEvent::Kind::hit);
  }

  // One event for the whole: the impulses of the parts that have news add up, the largest tells
  // where.
  void report_parts() {
    std::vector<PartNews>& news = events.news_of_parts;
    std::sort(news.begin(), news.end(), [](const PartNews& a, const PartNews& b) {
      return a.whole != b.whole ? a.whole < b.whole : a.part < b.part;
    });
    for (std::size_t k = 0; k < news.size();) {
      PartNews sum = news[k];
      double most = sum.impulse;
      for (++k; k < news.size() && news[k].whole == sum.whole; ++k) {
        const PartNews& other = news[k];
        if (other.impulse > most) {
          most = other.impulse;
          sum.point = other.point;
          sum.normal = other.normal;
        }
        sum.impulse += other.impulse;
        sum.closing = std::max(sum.closing, other.closing);
      }
      Contact& whole = contacts[sum.whole];
      const bool touches = contacts.touches_in_parts(whole);
      if (!touches) {
        if (whole.touching) events.touch(colliders, whole, false);
        continue;
      }
      const ColliderPair pair{whole.key, whole.a, whole.b};
      const auto tell = [&](ContactEvent::Kind kind) {
        events.emit(colliders, kind, pair, sum.point, sum.normal, sum.closing, sum.impulse, 0.0);
      };
      if (!whole.touching) tell(ContactEvent::Kind::begin);
      whole.touching = true;
      if (sum.closing > 0.0) tell(ContactEvent::Kind::hit);
    }
    news.clear();
  }
};

}  // namespace

void World::Impl::report_news() {
  counters.contacts += contact_store.points;
  TouchReport report{contact_store, colliders, events};
  std::size_t next = 0;
  contact_runs().for_runs([&](const auto&, const auto&, auto& blocks) {
    for (auto& block : blocks) {
      const std::uint32_t found = sub_step.blocks.words[next++];
      for (std::uint32_t bits = found & 0xffffu; bits != 0; bits &= bits - 1) {
        const int lane = std::countr_zero(bits);
        report.report_lane(block, lane, ((found >> (16 + lane)) & 1u) != 0);
      }
    }
  });
  report.report_parts();
}

}  // namespace vp
