#include "event_repeater.h"

#include <gtest/gtest.h>

#include <map>

namespace server {
namespace {

using foosball::Event;
using foosball::EventKind;

Event event(EventKind kind, double value = 0.0) {
  Event e;
  e.kind = kind;
  e.value = value;
  return e;
}

std::vector<wire::EventSnapshot> next(EventRepeater& repeater, std::vector<Event> events = {}) {
  repeater.add(events);
  std::vector<wire::EventSnapshot> out;
  repeater.fill(out);
  return out;
}

TEST(EventRepeater, PutsAnEventIntoEightSnapshotsInARow) {
  EventRepeater repeater;
  std::vector<wire::EventSnapshot> out = next(repeater, {event(EventKind::goal, 2.5)});
  for (int i = 0; i < 8; ++i, out = next(repeater)) {
    ASSERT_EQ(out.size(), 1u) << i;
    EXPECT_EQ(out[0].id, 1u);
    EXPECT_EQ(out[0].value, 2.5f);
  }
  EXPECT_TRUE(out.empty());
}

// Seven lost datagrams in a row, starting anywhere: every event was in one that arrived.
TEST(EventRepeater, ShowsEveryEventDespiteSevenLostDatagrams) {
  for (int lost_from = 0; lost_from < 16; ++lost_from) {
    EventRepeater repeater;
    std::map<std::uint32_t, int> seen;
    for (int i = 0; i < 40; ++i) {
      const bool fires = i % 4 == 0 && i < 24;
      const auto out = fires ? next(repeater, {event(EventKind::wall_hit)}) : next(repeater);
      if (i >= lost_from && i < lost_from + 7) continue;
      for (const auto& e : out) ++seen[e.id];
    }
    EXPECT_EQ(seen.size(), 6u) << lost_from;
  }
}

TEST(EventRepeater, ListsTheOldestFirstAndNeverMoreThanASnapshotHolds) {
  EventRepeater repeater;
  for (int i = 0; i < 100; ++i) {
    const auto out = next(repeater, {event(EventKind::man_hit), event(EventKind::wall_hit)});
    ASSERT_LE(out.size(), static_cast<std::size_t>(wire::kMaxEvents));
    for (std::size_t k = 1; k < out.size(); ++k) EXPECT_LT(out[k - 1].id, out[k].id);
  }
  EXPECT_GT(repeater.dropped(), 0u);
}

TEST(EventRepeater, GivesAGoalThePlaceOfAHit) {
  EventRepeater repeater;
  next(repeater, std::vector<Event>(wire::kMaxEvents, event(EventKind::wall_hit)));
  EXPECT_EQ(repeater.dropped(), 0u);
  const auto out = next(repeater, {event(EventKind::goal)});
  ASSERT_EQ(out.size(), static_cast<std::size_t>(wire::kMaxEvents));
  EXPECT_EQ(out.back().kind, static_cast<std::uint8_t>(EventKind::goal));
  EXPECT_EQ(out.front().id, 2u);  // the oldest hit was dropped
  EXPECT_EQ(repeater.dropped(), 1u);
}

TEST(EventRepeater, DropsAHitThatFindsNoPlace) {
  EventRepeater repeater;
  next(repeater, std::vector<Event>(wire::kMaxEvents, event(EventKind::goal)));
  const auto out = next(repeater, {event(EventKind::wall_hit)});
  for (const auto& e : out) EXPECT_EQ(e.kind, static_cast<std::uint8_t>(EventKind::goal));
  EXPECT_EQ(repeater.dropped(), 1u);
}

}  // namespace
}  // namespace server
