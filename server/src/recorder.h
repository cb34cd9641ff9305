// A match's journal on disk; server/record_schedule.h defines its content.
#pragma once

#include <memory>

#include "foosball/match.h"
#include "journal_file.h"
#include "server/record_schedule.h"

namespace server {

class Recorder {
 public:
  Recorder(std::unique_ptr<JournalFile> file, const wire::JournalHeader& header)
      : file_(std::move(file)), schedule_(*file_, header) {}

  // Call after the match was stepped with the tick.
  void add(const wire::JournalTick& tick, const foosball::Match& match) {
    schedule_.add(tick, match);
  }
  void finish(const foosball::Match& match) {
    schedule_.finish(match);
    file_->close();
  }

  const JournalFile& file() const { return *file_; }

 private:
  std::unique_ptr<JournalFile> file_;
  RecordSchedule<JournalFile> schedule_;
};

}  // namespace server
