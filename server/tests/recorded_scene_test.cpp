// A recording as a renderer sees it: the same scenes and events as in the recorded match.
#include "server/recorded_scene.h"

#include <gtest/gtest.h>

#include "lockstep.h"
#include "snapshot_builder.h"
#include "wire/enums.h"

namespace server {
namespace {

struct Moment {
  wire::Snapshot scene;
  std::size_t events = 0;  // so far
};

// Records two computer players, and stores the scene each second.
std::vector<Moment> record(const std::string& path, int seconds) {
  std::vector<Moment> moments;
  Lockstep table([&](ServerOptions& o) {
    o.computer = {true, true};
    o.match.seed = 42;
    o.record = path;
    o.overwrite = true;
  });
  std::size_t events = 0;
  for (int tick = 1; tick <= 1000 * seconds; ++tick) {
    table.tick();
    events += table->match().events().size();
    if (tick % 1000 != 0) continue;
    moments.push_back({{}, events});
    build_snapshot(table->match().view(), moments.back().scene);
  }
  table->finish(wire::Sentence::untranslated("done"));
  return moments;
}

TEST(RecordedScene, ShowsTheScenesAndEachEventOnceOfTheMatchThatWasPlayed) {
  const std::string path = temp_path("scene.sfr");
  const auto played = record(path, 20);
  auto recorded = RecordedScene::open(path);
  ASSERT_TRUE(recorded) << recorded.error();
  EXPECT_EQ(recorded->total_ticks(), 20000u);
  std::uint64_t tick = 0;
  std::size_t events = 0;
  std::uint32_t last_id = 0;
  for (const Moment& moment : played) {
    ASSERT_TRUE(recorded->advance_to(tick += 1000));
    for (const auto& event : recorded->take_events()) {
      EXPECT_EQ(event.id, ++last_id);
      ++events;
    }
    EXPECT_TRUE(recorded->take_events().empty());
    EXPECT_EQ(events, moment.events);
    EXPECT_EQ(recorded->snapshot().tick, moment.scene.tick);
    EXPECT_EQ(recorded->snapshot().ball.position, moment.scene.ball.position);
    EXPECT_EQ(recorded->snapshot().rods[3].angle, moment.scene.rods[3].angle);
    EXPECT_EQ(recorded->snapshot().screen, moment.scene.screen);
    EXPECT_EQ(recorded->snapshot().rods[0].source, wire::number(wire::RodSource::replay));
  }
  EXPECT_GT(events, 10u);
  EXPECT_FALSE(recorded->advance_to(tick + 1));
  EXPECT_EQ(recorded->playback().verdict(), Playback::Verdict::same);
}

TEST(RecordedScene, NamesAFileThatIsNoRecording) {
  const auto none = RecordedScene::open("/no/such.sfr");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().find("/no/such.sfr"), std::string::npos);
}

}  // namespace
}  // namespace server
