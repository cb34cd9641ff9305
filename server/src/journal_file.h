// Writes a match's journal without ever holding up the tick: the tick's thread encodes into a ring,
// a thread of its own appends to the file and has the disk take it (fdatasync) each second.
//
// When the ring is full or the file cannot be written (disk full), the journal ends at its last
// whole record and stays readable to there; play goes on, and the ticks that are missing are
// counted. A disk that answers no more, or a pipe that nobody reads, holds up nothing either, not
// even the end of the program: close() has a bound.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <tl/expected.hpp>
#include <vector>

#include "wire/journal.h"
#include "wire/read_file.h"
#include "wire/sentence.h"

namespace server {

struct JournalFileOptions {
  std::string path;
  bool overwrite = false;  // a recording that is there already; nothing else ever is
  std::uint64_t max_bytes = wire::kMaxJournalFile;  // what nobody could read is not written
  std::size_t ring_bytes = std::size_t{8} << 20;  // minutes of play, or 8 of the largest keyframes
  // What is lost at most when the machine loses its power, if the disk keeps up.
  std::chrono::milliseconds sync_period{1000};
  // What close() gives the file to take the rest: a keyframe on a slow USB stick takes far less.
  std::chrono::milliseconds close_patience{2000};
};

class JournalFile {
 public:
  // A file that is there already must be empty, or a recording to be overwritten, and no other
  // server may write it (flock); the error is a sentence. A pipe must have a reader; a pipe or a
  // device is written to as it is. The umask decides who may read a new file.
  static tl::expected<std::unique_ptr<JournalFile>, std::string> create(
      const JournalFileOptions& options);
  ~JournalFile();  // closes, if close() was not called

  // Tick thread. Nothing happens once the journal has ended.
  void add(const wire::JournalEntry& entry);
  // Appends what is still open, waits until the disk has it (on the journal's thread), ends the
  // thread; up to twice close_patience: then the journal has failed, and the thread is
  // left alone with the file. Not for the loop while it runs. problem() says if the disk failed.
  void close();

  // Any thread. Empty, or the sentence that says why the journal ended early.
  wire::Sentence problem() const;
  bool failed() const;
  std::uint64_t bytes_written() const;
  std::uint64_t entries_dropped() const { return dropped_; }  // tick thread

 private:
  class Writer;

  JournalFile(const JournalFileOptions& options, std::shared_ptr<Writer> writer);
  void push();

  std::chrono::milliseconds close_patience_;
  std::uint64_t room_;              // bytes that may still be written
  std::shared_ptr<Writer> writer_;  // the thread's too, which may outlast this object
  wire::JournalEncoder encoder_;
  std::vector<std::byte> encoded_;
  std::uint64_t dropped_ = 0;
  std::future<void> ended_;  // the thread's work
  std::thread thread_;
};

}  // namespace server
