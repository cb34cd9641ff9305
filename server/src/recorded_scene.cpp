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

tl::expected<RecordedScene, std::string> RecordedScene::twin() const {
  auto playback = playback_->twin();
  auto match = foosball::Match::create(playback->match());
  if (!match) return tl::unexpected("the recording cannot be replayed: " + match.error().message);
  return RecordedScene(std::move(playback), std::move(*match));
}

void RecordedScene::extend(Playback::Bytes longer, std::optional<std::uint64_t> total_ticks) {
  playback_->extend(std::move(longer));
  total_ticks_ = total_ticks ? *total_ticks : playback_->total_ticks();
}

RecordedScene::Mark RecordedScene::mark() const {
  Mark mark{playback_->place(), {}, match_.state_hash(), snapshot_, last_event_};
  match_.snapshot(mark.match);
  return mark;
}

bool RecordedScene::go_to(const Mark& mark) {
  const Mark before = this->mark();
  if (!match_.restore(mark.match)) return false;
  if (match_.state_hash() != mark.state_hash) {
    (void)match_.restore(before.match);
    return false;
  }
  playback_->go_to(mark.place);
  snapshot_ = mark.scene;
  last_event_ = mark.last_event;
  events_.clear();
  return true;
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
