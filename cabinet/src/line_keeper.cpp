#include "line_keeper.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "os/capabilities.h"

namespace cabinet {
namespace {

void close_if_open(int fd) {
  if (fd >= 0) ::close(fd);
}

}  // namespace

LineKeeper::LineKeeper(std::function<int()> open)
    : open_(std::move(open)), error_(ENOENT), thread_([this] { run(); }) {}

LineKeeper::~LineKeeper() {
  ending_.store(true, std::memory_order_release);
  work_.post();
  thread_.join();
  close_if_open(to_close_.load(std::memory_order_relaxed));
  close_if_open(handover_.load(std::memory_order_relaxed));
}

int LineKeeper::take() {
  const int state = handover_.load(std::memory_order_acquire);
  if (state >= 0) {
    handover_.store(kIdle, std::memory_order_relaxed);
    return state;
  }
  if (state == kIdle) {
    handover_.store(kAsked, std::memory_order_release);
    work_.post();
  }
  errno = error_.load(std::memory_order_relaxed);
  return -1;
}

// to_close_ is free: the previous descriptor was closed before this one was opened.
void LineKeeper::close(int fd) {
  to_close_.store(fd, std::memory_order_release);
  work_.post();
}

bool LineKeeper::send(int fd, std::span<const std::byte> packet) {
  const std::uint32_t put = put_.load(std::memory_order_relaxed);
  if (packet.size() > kMaxPacket || fd < 0 ||
      put - taken_.load(std::memory_order_acquire) >= packets_.size())
    return false;
  Packet& place = packets_[put % packets_.size()];
  place.fd = fd;
  place.size = packet.size();
  std::ranges::copy(packet, place.bytes.begin());
  put_.store(put + 1, std::memory_order_release);
  work_.post();
  return true;
}

// Data that a device does not accept is lost.
void LineKeeper::write_packets() {
  std::uint32_t taken = taken_.load(std::memory_order_relaxed);
  while (taken != put_.load(std::memory_order_acquire)) {
    const Packet& packet = packets_[taken % packets_.size()];
    [[maybe_unused]] const ssize_t written = ::write(packet.fd, packet.bytes.data(), packet.size);
    taken_.store(++taken, std::memory_order_release);
  }
}

void LineKeeper::run() {
  // Keeps file access, since only root may be able to open the device.
  os::drop_capabilities(true);
  while (true) {
    work_.wait();  // a signal may interrupt it; then there is no work
    // Read handover_ first: a request follows the store of the descriptor to close. A later request
    // posts work_ again.
    const bool asked = handover_.load(std::memory_order_acquire) == kAsked;
    // The descriptor was closed after its last packet was queued. So after write_packets() no
    // packet is left for a number that by then names another file.
    const int closing = to_close_.exchange(-1, std::memory_order_acq_rel);
    write_packets();
    close_if_open(closing);
    if (ending_.load(std::memory_order_acquire)) return;
    if (!asked) continue;
    const int fd = open_();
    error_.store(fd >= 0 ? ENOENT : errno, std::memory_order_relaxed);
    handover_.store(fd >= 0 ? fd : kIdle, std::memory_order_release);
  }
}

}  // namespace cabinet
