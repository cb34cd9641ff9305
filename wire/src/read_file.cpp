#include "wire/read_file.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace wire {
namespace {

// Timeout for the next bytes from a pipe's writer.
constexpr int kPatience_ms = 10'000;

struct File {
  int descriptor;
  ~File() { ::close(descriptor); }
};

}  // namespace

// Never blocks forever: opening a pipe does not wait for a writer.
tl::expected<std::vector<std::byte>, std::string> read_file(const std::string& path,
                                                            std::size_t max_bytes) {
  const auto error = [&](const std::string& what) { return tl::unexpected(path + ": " + what); };
  const auto system_error = [&](const char* verb) {
    return error(std::string("cannot be ") + verb + " (" + std::strerror(errno) +
                 "); check its name and permissions.");
  };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return system_error("opened");
  const File file{descriptor};

  // Reads until the end instead of asking for the size: a pipe or a device has none.
  constexpr std::size_t kChunk = 1 << 16;
  std::vector<std::byte> bytes;
  while (true) {
    pollfd ready{file.descriptor, POLLIN, 0};
    const int polled = ::poll(&ready, 1, kPatience_ms);
    if (polled < 0 && errno == EINTR) continue;
    if (polled < 0) return system_error("read");
    if (polled == 0) return error("nothing came for 10 s; check who writes it.");
    const std::size_t size = bytes.size();
    bytes.resize(size + kChunk);
    const ssize_t got = ::read(file.descriptor, bytes.data() + size, kChunk);
    bytes.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got < 0) return system_error("read");
    if (got == 0) return bytes;
    if (bytes.size() > max_bytes) {
      return error("larger than " + std::to_string(max_bytes) +
                   " bytes; it is not what is expected here.");
    }
  }
}

}  // namespace wire
