// Orders snapshots as they arrive, and gives the scene to be drawn now: behind the newest snapshot
// by as little as the network's jitter allows.
//
// The fastest arrivals of the last 256 map the server's simulated time (tick * tick_us) to this
// process's clock. The delay of the others behind them is the jitter. The scene is played
//   delay = 1.5 ticks + 98th percentile of the jitter, at most kLongestDelay
// behind the fastest arrival. Changes of the delay are slewed, so that time never jumps in play.
// One thread at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "wire/snapshot.h"

namespace client {

struct SnapshotCounters {
  std::uint64_t received = 0;     // accepted
  std::uint64_t bad = 0;          // bytes that are no valid snapshot
  std::uint64_t old = 0;          // duplicates, and too late to be of use
  std::uint64_t foreign = 0;      // of another session
  std::uint64_t lost = 0;         // never arrived, or too late
  std::uint64_t reordered = 0;    // arrived after a newer one, but in time
  std::uint64_t implausible = 0;  // jumped in time, and too few later ones agreed
};

struct SceneSample {
  bool any = false;       // false: no snapshot in this session
  bool starving = false;  // no newer snapshot: the scene stands still
  wire::Snapshot state;
};

class SnapshotBuffer {
 public:
  static constexpr std::int64_t kLongestDelayUs = 50'000;
  static constexpr std::int64_t kExtrapolateUs =
      20'000;  // longer extrapolation looks worse than a stop

  // Drops snapshots of other sessions from now on. A session that continues keeps its scene.
  // Preconditions, which the decoders ensure: tick_us in 1..wire::kMaxTickUs, and no snapshot's
  // tick above wire::kMaxTick.
  void begin_session(std::uint64_t session, std::uint32_t tick_us);

  // A snapshot that jumps in time is rejected: ahead by more than kAheadUs beyond the elapsed time,
  // or back although it was sent later. Otherwise all later snapshots would be too old. After
  // kAgreeing consecutive snapshots that agree, the jump is accepted: the server itself may have
  // jumped.
  static constexpr std::int64_t kAheadUs = 1'000'000;
  static constexpr int kAgreeing = 32;

  enum class Verdict : std::uint8_t { taken, old, foreign, implausible };
  Verdict push(wire::Snapshot snapshot, std::int64_t arrival_us);
  void count_bad() { ++counters_.bad; }
  void count_old() { ++counters_.old; }
  void count_foreign() { ++counters_.foreign; }

  // Precondition: now_us does not decrease between calls.
  SceneSample sample(std::int64_t now_us);
  // Events whose tick the drawn scene has reached, each once, oldest first.
  std::vector<wire::EventSnapshot> take_events();

  SnapshotCounters counters() const;
  std::int64_t delay_us() const { return delay_us_; }
  std::int64_t last_arrival_us() const { return last_arrival_us_; }  // 0: none yet

 private:
  static constexpr std::size_t kKept = 128;
  static constexpr std::size_t kWindow = 256;

  std::int64_t time_of(const wire::Snapshot& s) const {
    return static_cast<std::int64_t>(s.tick) * tick_us_;
  }
  bool plausible(const wire::Snapshot& snapshot, std::int64_t arrival_us);
  bool jumps(const wire::Snapshot& snapshot, std::int64_t arrival_us) const;
  bool insert(wire::Snapshot snapshot);
  void note_arrival(std::int64_t offset_us);
  void note_events(const wire::Snapshot& snapshot);
  void count_sequence(std::uint64_t sequence, bool newest);
  std::int64_t play_time(std::int64_t now_us);

  struct PendingEvent {
    std::uint64_t tick;
    wire::EventSnapshot event;
  };

  std::uint64_t session_ = 0;
  std::int64_t tick_us_ = 1000;
  std::deque<wire::Snapshot> kept_;  // by tick, oldest first
  SnapshotCounters counters_;
  int doubted_ = 0;  // number of consecutive implausible snapshots that agree
  std::uint64_t doubted_tick_ = 0, doubted_sequence_ = 0;
  // Since the last begin_session(). counters() derives the losses from them.
  std::uint64_t first_sequence_ = 0, newest_sequence_ = 0, in_session_ = 0, lost_before_ = 0;
  std::uint64_t last_sequence_ = 0;  // the newest of the session, in whatever order it arrived

  std::array<std::int64_t, kWindow> offsets_{};  // arrival - simulated time
  std::size_t offset_count_ = 0, offset_next_ = 0;
  std::int64_t fastest_us_ = 0, delay_us_ = 1500;

  bool playing_ = false;
  std::int64_t play_us_ = 0, sampled_at_us_ = 0, last_arrival_us_ = 0;
  std::deque<PendingEvent> events_;
  std::uint32_t last_event_ = 0;
  bool any_event_ = false;
};

}  // namespace client
