// Writes a match's journal without ever holding up the tick: the tick's thread encodes into a ring,
// a thread of its own appends to the file.
//
// When the ring is full or the file cannot be written (disk full), the journal ends at its last
// whole record and stays readable to there; play goes on, and the ticks that are missing are
// counted.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <tl/expected.hpp>
#include <vector>

#include "os/file_descriptor.h"
#include "server/byte_ring.h"
#include "wire/journal.h"

namespace server {

struct JournalFileOptions {
  std::string path;
  bool overwrite = false;  // a recording that is there already; nothing else ever is
  std::size_t ring_bytes = std::size_t{8} << 20;  // minutes of play, or 8 of the largest keyframes
};

class JournalFile {
 public:
  // A file that is there already must be empty, or a recording to be overwritten; the error is a
  // sentence. A pipe or a device is written to as it is.
  static tl::expected<std::unique_ptr<JournalFile>, std::string> create(
      const JournalFileOptions& options);
  ~JournalFile();  // closes, if close() was not called

  // Tick thread. Nothing happens once the journal has ended.
  void add(const wire::JournalEntry& entry);
  // Appends what is still open, waits until the disk has it (fdatasync, on the journal's thread),
  // ends the thread. Not for the loop while it runs. problem() then says if the disk failed.
  void close();

  // Any thread. Empty, or the sentence that says why the journal ended early.
  std::string problem() const;
  bool failed() const { return failure_.load(std::memory_order_acquire) != Failure::none; }
  std::uint64_t bytes_written() const { return written_.load(std::memory_order_relaxed); }
  std::uint64_t entries_dropped() const { return dropped_; }  // tick thread

 private:
  enum class Failure : int { none, ring_full, write_failed };

  JournalFile(const JournalFileOptions& options, os::FileDescriptor file, os::FileDescriptor wake);
  void push();
  void fail(Failure failure, int error_number);
  void write_loop();
  bool drain();
  void sync();
  void signal();

  std::string path_;
  os::FileDescriptor file_, wake_;
  ByteRing ring_;
  wire::JournalEncoder encoder_;
  std::vector<std::byte> encoded_;
  std::uint64_t dropped_ = 0;
  std::atomic<std::uint64_t> written_{0};
  std::atomic<Failure> failure_{Failure::none};
  std::atomic<int> error_number_{0};
  std::atomic<bool> closing_{false};
  std::thread thread_;
};

}  // namespace server
