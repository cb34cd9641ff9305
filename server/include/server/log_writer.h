// Lines for a person, written by a thread of its own: whoever logs never waits for whoever reads. A
// pipe that nobody empties, a terminal that was stopped, a slow disk: lines that find no place are
// dropped and counted, and that is said when there is a place again.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace server {

class LogWriter {
 public:
  static constexpr std::size_t kMostWaiting = 256 * 1024;  // bytes

  // fd is the caller's, and left as it is (its flags may be another process' too).
  explicit LogWriter(int fd);
  // Waits for what was written, at most kPatienceUs; what is then left is lost.
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  static constexpr std::int64_t kPatienceUs = 500'000;

  void write(const std::string& text);   // any thread; never waits
  bool flush(std::int64_t patience_us);  // false: something still waits to be written
  std::uint64_t dropped() const;         // texts

 private:
  struct State;
  std::shared_ptr<State> state_;  // the thread's too: it may be stuck in the kernel for ever
};

}  // namespace server
