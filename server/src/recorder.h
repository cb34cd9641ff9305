// What goes into a match's journal, and when: the header, every tick's inputs, a hash each second,
// a keyframe every 10 s, the end.
#pragma once

#include <memory>

#include "foosball/match.h"
#include "journal_file.h"

namespace server {

class Recorder {
 public:
  static constexpr std::uint64_t kHashTicks = 1'000;
  static constexpr std::uint64_t kKeyframeTicks = 10'000;

  Recorder(std::unique_ptr<JournalFile> file, const wire::JournalHeader& header);

  // After the match was stepped with the tick.
  void add(const wire::JournalTick& tick, const foosball::Match& match);
  void finish(const foosball::Match& match);

  const JournalFile& file() const { return *file_; }

 private:
  std::unique_ptr<JournalFile> file_;
  std::uint64_t ticks_ = 0;
  // Kept from tick to tick for their memory.
  wire::JournalEntry tick_entry_{wire::JournalTick{}};
  wire::JournalEntry keyframe_entry_{wire::JournalKeyframe{}};
};

}  // namespace server
