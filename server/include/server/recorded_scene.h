// A recorded match as a renderer sees it, without sockets and without a clock: tick by tick, as
// fast as requested. For programs that draw a recording, such as space-foosball-video.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "foosball/match.h"
#include "server/playback.h"
#include "wire/snapshot.h"

namespace server {

class RecordedScene {
 public:
  // The error is a sentence that names the file; see Playback::open.
  static tl::expected<RecordedScene, std::string> open(const std::string& path);

  // Another scene of the same recording, at its beginning; shares the bytes.
  tl::expected<RecordedScene, std::string> twin() const;

  // A checkpoint: the match and the position in the recording, about 10 kB. Valid for this scene
  // and its twins.
  struct Mark {
    Playback::Place place;
    std::vector<std::byte> match;
    std::uint64_t state_hash;
    wire::Snapshot scene;
    std::uint32_t last_event;
  };
  Mark mark() const;
  // Returns false, and changes nothing, if the restored match does not have the mark's hash. Drops
  // pending events.
  bool go_to(const Mark& mark);

  // Steps the match until this many ticks of the recording are played; false if it ends before.
  bool advance_to(std::uint64_t tick);

  // The scene after the last tick. Its events are all events since the last take_events(), each
  // once; there may be more than fit into one datagram.
  const wire::Snapshot& snapshot() const { return snapshot_; }
  std::vector<wire::EventSnapshot> take_events();

  std::uint64_t ticks() const { return playback_->ticks(); }
  std::uint64_t total_ticks() const { return total_ticks_; }  // of the recording
  // The file has grown; see Playback::extend. total_ticks: of a twin that was extended by the same
  // bytes; none: this function counts them.
  void extend(Playback::Bytes longer, std::optional<std::uint64_t> total_ticks = {});
  const foosball::Characters& characters() const { return playback_->match().characters; }
  const Playback& playback() const { return *playback_; }
  std::uint64_t state_hash() const { return match_.state_hash(); }

 private:
  RecordedScene(std::unique_ptr<Playback> playback, foosball::Match match);

  std::unique_ptr<Playback> playback_;
  foosball::Match match_;
  wire::Snapshot snapshot_;
  std::vector<wire::EventSnapshot> events_;
  std::uint32_t last_event_ = 0;
  std::uint64_t total_ticks_;
};

}  // namespace server
