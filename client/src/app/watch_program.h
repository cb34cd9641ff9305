// Runs space-foosball-watch, the program that shows recorded matches; it is installed beside this
// one. It simulates the match again, which a renderer never does, so it runs as a separate process.
// This program waits with its window hidden until it ends.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace client {

class WatchProgram {
 public:
  // Starts it with these command-line options; the error is a sentence.
  static tl::expected<WatchProgram, std::string> start(const std::vector<std::string>& options);
  WatchProgram(WatchProgram&& other) noexcept;
  WatchProgram& operator=(WatchProgram&&) = delete;
  ~WatchProgram();  // asks it to end, and waits for a limited time

  // Its exit code, returned once after it has ended; -1: ended by a signal.
  std::optional<int> ended();

 private:
  explicit WatchProgram(pid_t process) : process_(process) {}
  pid_t process_;  // -1: ended
};

}  // namespace client
