// The clients of the loop benchmark: a separate process with N clients on real sockets, which
// counts what arrives.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>

namespace bench {

struct ListenerTotals {
  std::uint64_t joined = 0;
  std::uint64_t received = 0;
  std::uint64_t bad = 0;        // not a snapshot, or of another session
  std::uint64_t gaps = 0;       // sequence numbers missing between a listener's first and last
  std::uint64_t reordered = 0;  // or duplicated
  bool complete = false;        // all received Bye
};

class Listeners {
 public:
  // Forks: call before any thread is created.
  explicit Listeners(int count);
  ~Listeners();

  bool join(std::uint16_t port);           // tells the clients to join; false if not all could
  std::optional<ListenerTotals> totals();  // after the server's Bye

 private:
  pid_t child_ = -1;
  std::uint64_t expected_ = 0;
  int to_child_ = -1, from_child_ = -1;
};

}  // namespace bench
