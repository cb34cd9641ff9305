// The program that shows recorded matches, space-foosball-watch, which is beside this one. It steps
// the match again, which a renderer never does, so it is a process of its own; this one waits with
// its window hidden until it ends.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace client {

class WatchProgram {
 public:
  // Starts it; the error is a sentence. options: of its command line.
  static tl::expected<WatchProgram, std::string> start(const std::vector<std::string>& options);
  WatchProgram(WatchProgram&& other) noexcept;
  WatchProgram& operator=(WatchProgram&&) = delete;
  ~WatchProgram();  // asks it to end, and waits for a while

  // Its exit code, when it has ended, once; -1: by a signal.
  std::optional<int> ended();

 private:
  explicit WatchProgram(pid_t process) : process_(process) {}
  pid_t process_;  // -1: ended
};

}  // namespace client
