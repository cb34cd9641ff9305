// Writes log lines on its own thread, so that the caller never waits for a slow reader: a pipe that
// nobody reads, a stopped terminal, a slow disk. Lines that do not fit are dropped and counted. A
// later line reports the number of dropped lines once there is capacity again.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace server {

class LogWriter {
 public:
  static constexpr std::size_t kMaxWaiting = 256 * 1024;  // bytes

  // The caller owns fd. Its flags are left unchanged, since another process may share them.
  explicit LogWriter(int fd);
  // Waits for pending text, at most kPatienceUs; text that is still pending then is lost.
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  static constexpr std::int64_t kPatienceUs = 500'000;

  void write(const std::string& text);   // any thread; never blocks
  bool flush(std::int64_t patience_us);  // false: some text is still pending
  std::uint64_t dropped() const;         // texts

 private:
  struct State;
  std::shared_ptr<State> state_;  // shared with the thread, which may block in the kernel forever
};

}  // namespace server
