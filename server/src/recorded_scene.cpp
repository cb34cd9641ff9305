#include "server/recorded_scene.h"

#include <utility>

#include "event_repeater.h"
#include "snapshot_builder.h"

namespace server {

tl::expected<RecordedScene, std::string> RecordedScene::open(const std::string& path) {
  auto playback = Playback::open(path);
  if (!playback) return tl::unexpected(playback.error());
  auto match = foosball::Match::create((*playback)->match());
  if (!match) return tl::unexpected(path + " cannot be replayed: " + match.error().message);
  return RecordedScene(std::move(*playback), std::move(*match));
}

RecordedScene::RecordedScene(std::unique_ptr<Playback> playback, foosball::Match match)
    : playback_(std::move(playback)),
      match_(std::move(match)),
      total_ticks_(playback_->total_ticks()) {
  build_snapshot(match_.view(), snapshot_);
}

bool RecordedScene::advance_to(std::uint64_t tick) {
  while (ticks() < tick) {
    const wire::JournalTick* recorded = playback_->next(match_);
    if (recorded == nullptr) return false;
    step_recorded(match_, *recorded);
    for (const foosball::Event& event : match_.events()) {
      events_.push_back(to_wire(event, ++last_event_));
    }
    put_replay_drivers(*recorded, snapshot_);
  }
  build_snapshot(match_.view(), snapshot_);
  return true;
}

std::vector<wire::EventSnapshot> RecordedScene::take_events() {
  return std::exchange(events_, {});
}

}  // namespace server
