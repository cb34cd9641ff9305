// Opens and grabs a mouse from an address that a person types, such as "evdev:/dev/input/event5:4".
#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "cabinet/mouse_source.h"
#include "exclusive_line.h"
#include "line_keeper.h"
#include "mouse_line.h"
#include "os/file_descriptor.h"

namespace cabinet {
namespace {

constexpr std::string_view kScheme = "evdev:";

bool has_bit(const unsigned long* bits, unsigned bit) {
  constexpr unsigned kBits = 8 * sizeof(unsigned long);
  return (bits[bit / kBits] >> bit % kBits & 1) != 0;
}

int fail(int error) {
  errno = error;
  return -1;
}

}  // namespace

bool is_mouse(int fd) {
  unsigned long axes = 0;
  const int got = ::ioctl(fd, EVIOCGBIT(EV_REL, sizeof axes), &axes);
  return got > 0 && has_bit(&axes, REL_X) && has_bit(&axes, REL_Y);
}

int open_mouse_line(const char* path) {
  os::FileDescriptor fd(open_exclusively(path));
  if (!fd) return -1;
  if (!is_mouse(fd.get())) return fail(ENOTTY);
  int clock = CLOCK_MONOTONIC;
  if (::ioctl(fd.get(), EVIOCSCLOCKID, &clock) != 0) return fail(errno);
  if (::ioctl(fd.get(), EVIOCGRAB, 1) != 0) return fail(errno);
  return fd.release();
}

bool is_mouse_address(const std::string& address) {
  return address.compare(0, kScheme.size(), kScheme) == 0;
}

tl::expected<MouseAddress, std::string> parse_mouse_address(const std::string& address) {
  MouseAddress parsed;
  if (is_mouse_address(address)) parsed.path = address.substr(kScheme.size());
  // Names in /dev/input/by-path contain colons, with more text after them.
  const std::size_t colon = parsed.path.rfind(':');
  const std::string rod = colon == std::string::npos ? "" : parsed.path.substr(colon + 1);
  const bool names_rod =
      colon != std::string::npos && rod.find_first_not_of("+-0123456789.,:") == std::string::npos;
  const bool letter = rod.size() == 1;
  if (names_rod || letter) {
    if (rod.size() != 1 || rod[0] < '1' || rod[0] > '8') {
      return tl::unexpected(
          "\"" + address + "\" has no rod: append one from 1 (at team 0's goal) " +
          "to 8, such as " + std::string(kScheme) + parsed.path.substr(0, colon) + ":4.");
    }
    parsed.rod = rod[0] - '1';
    parsed.path.resize(colon);
  }
  if (!parsed.path.empty() && parsed.path[0] == '/') return parsed;
  return tl::unexpected("\"" + address +
                        "\" is not a mouse: write evdev:/dev/input/eventN, or with a rod from 1 to "
                        "8 evdev:/dev/input/eventN:4; space-foosball-doctor lists the mice.");
}

tl::expected<std::unique_ptr<MouseSource>, std::string> open_mouse(const std::string& path,
                                                                   MouseOptions options) {
  struct stat about {};
  if (::stat(path.c_str(), &about) == 0) {
    if (!S_ISCHR(about.st_mode)) {
      return tl::unexpected(options.name + ": not a device; space-foosball-doctor lists the mice.");
    }
    if (::access(path.c_str(), R_OK) != 0) {
      return tl::unexpected(options.name + ": " + std::strerror(errno) +
                            "; install cabinet/70-space-foosball.rules, or join group input and "
                            "log in again (docs/cabinet.md).");
    }
    const os::FileDescriptor fd(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (fd && !is_mouse(fd.get())) {
      return tl::unexpected(options.name + ": not a mouse; space-foosball-doctor lists the mice.");
    }
  }
  auto keeper = std::make_shared<LineKeeper>([path] { return open_mouse_line(path.c_str()); });
  options.reopen_us = 100'000;  // an attempt costs the poller nothing
  return std::make_unique<MouseSource>(
      std::move(options), [keeper] { return keeper->take(); },
      [keeper](int fd) { keeper->close(fd); });
}

}  // namespace cabinet
