#include "recorder.h"

namespace server {

Recorder::Recorder(std::unique_ptr<JournalFile> file, const wire::JournalHeader& header)
    : file_(std::move(file)) {
  std::get<wire::JournalTick>(tick_entry_).commands.reserve(wire::kMaxJournalCommands);
  std::get<wire::JournalKeyframe>(keyframe_entry_).snapshot.reserve(wire::kMaxKeyframe);
  file_->add(header);
}

void Recorder::add(const wire::JournalTick& tick, const foosball::Match& match) {
  std::get<wire::JournalTick>(tick_entry_) = tick;
  file_->add(tick_entry_);
  ++ticks_;
  if (ticks_ % kHashTicks == 0) file_->add(wire::JournalHash{ticks_, match.state_hash()});
  if (ticks_ % kKeyframeTicks == 0) {
    auto& keyframe = std::get<wire::JournalKeyframe>(keyframe_entry_);
    keyframe.tick = ticks_;
    keyframe.snapshot.clear();
    match.snapshot(keyframe.snapshot);
    file_->add(keyframe_entry_);
  }
}

void Recorder::finish(const foosball::Match& match) {
  file_->add(wire::JournalEnd{ticks_, match.state_hash()});
  file_->close();
}

}  // namespace server
