// Writes a match's journal without blocking the tick. The tick thread encodes into a ring; another
// thread appends to the file and calls fdatasync each second.
//
// If the ring is full or the file cannot be written (disk full), the journal ends after its last
// complete record and stays readable up to there. Play goes on, and the missing ticks are counted.
// A disk that hangs, or a pipe that nobody reads, does not block the program, not even its end:
// close() has a time limit.
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
  bool overwrite = false;  // an existing recording; other files are never overwritten
  std::uint64_t max_bytes = wire::kMaxJournalFile;  // more could not be read back
  std::size_t ring_bytes = std::size_t{8} << 20;  // minutes of play, or 8 of the largest keyframes
  // Max loss [time] on a power failure, if the disk keeps up.
  std::chrono::milliseconds sync_period{1000};
  // Time that close() gives the file for the rest: a keyframe on a slow USB stick takes far less.
  std::chrono::milliseconds close_patience{2000};
};

class JournalFile {
 public:
  // An existing file must be empty, or a recording to be overwritten, and no other server may be
  // writing it (flock). The error is a sentence. A pipe must have a reader; pipes and devices are
  // written to without these checks. The umask decides who may read a new file.
  static tl::expected<std::unique_ptr<JournalFile>, std::string> create(
      const JournalFileOptions& options);
  ~JournalFile();  // calls close() if it was not called

  // Tick thread. Does nothing once the journal has ended.
  void add(const wire::JournalEntry& entry);
  // Appends open records, waits until the disk has them (on the journal's thread), and ends the
  // thread. Takes at most twice close_patience. After that the journal has failed, and the thread
  // is abandoned with the file. Do not call from the running loop. problem() reports a failure of
  // the disk.
  void close();

  // Any thread. Empty, or the sentence with the reason why the journal ended early.
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
  std::shared_ptr<Writer> writer_;  // shared with the thread, which may outlive this object
  wire::JournalEncoder encoder_;
  std::vector<std::byte> encoded_;
  std::uint64_t dropped_ = 0;
  std::future<void> ended_;  // the thread's work
  std::thread thread_;
};

}  // namespace server
