// Defines what a match's journal holds, and when: the header, the inputs of every tick, a hash and
// the standing each second, a keyframe every 10 s, the end. The sink decides where it goes: to a
// file of the server, or to memory.
#pragma once

#include "foosball/match.h"
#include "server/match_standing.h"
#include "wire/journal.h"

namespace server {

// Sink: void add(const wire::JournalEntry&). It must outlive the schedule.
template <class Sink>
class RecordSchedule {
 public:
  static constexpr std::uint64_t kHashTicks = 1'000;
  static constexpr std::uint64_t kKeyframeTicks = 10'000;

  RecordSchedule(Sink& sink, const wire::JournalHeader& header) : sink_(sink) {
    std::get<wire::JournalTick>(tick_entry_).commands.reserve(wire::kMaxJournalCommands);
    std::get<wire::JournalKeyframe>(keyframe_entry_).snapshot.reserve(wire::kMaxKeyframe);
    sink_.add(header);
  }

  // Call after the match was stepped with the tick.
  void add(const wire::JournalTick& tick, const foosball::Match& match) {
    std::get<wire::JournalTick>(tick_entry_) = tick;
    sink_.add(tick_entry_);
    ++ticks_;
    standing_.observe(match);
    if (ticks_ % kHashTicks == 0) {
      sink_.add(wire::JournalHash{ticks_, match.state_hash()});
      sink_.add(standing_.at(ticks_));
    }
    if (ticks_ % kKeyframeTicks == 0) {
      auto& keyframe = std::get<wire::JournalKeyframe>(keyframe_entry_);
      keyframe.tick = ticks_;
      keyframe.snapshot.clear();
      match.snapshot(keyframe.snapshot);
      sink_.add(keyframe_entry_);
    }
  }
  void finish(const foosball::Match& match) {
    sink_.add(standing_.at(ticks_));
    sink_.add(wire::JournalEnd{ticks_, match.state_hash()});
  }

 private:
  Sink& sink_;
  std::uint64_t ticks_ = 0;
  MatchStanding standing_;
  // Reused for their memory.
  wire::JournalEntry tick_entry_{wire::JournalTick{}};
  wire::JournalEntry keyframe_entry_{wire::JournalKeyframe{}};
};

}  // namespace server
