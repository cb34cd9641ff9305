#include "arrival_watch.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>

#include <array>
#include <cerrno>

#include "os/capabilities.h"
#include "os/clock.h"

namespace cabinet {

ArrivalWatch::ArrivalWatch()
    : epoll_(::epoll_create1(EPOLL_CLOEXEC)), end_(::eventfd(0, EFD_CLOEXEC)) {
  epoll_event event{.events = EPOLLIN, .data = {.fd = end_.get()}};
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, end_.get(), &event);
  thread_ = std::thread([this] { run(); });
}

ArrivalWatch::~ArrivalWatch() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(end_.get(), &one, sizeof one);
  thread_.join();
}

// Edge-triggered: each arrival wakes the thread once, whether earlier bytes were read or not.
void ArrivalWatch::watch(int fd) {
  epoll_event event{.events = EPOLLIN | EPOLLET, .data = {.fd = fd}};
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, fd, &event);
}

void ArrivalWatch::run() {
  os::drop_capabilities(false);
  std::array<epoll_event, 4> events{};
  while (true) {
    const int ready =
        ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), -1);
    const std::int64_t now_us = os::monotonic_us();
    // Without this thread, poll() still bounds arrival times.
    if (ready < 0 && errno != EINTR) return;
    for (int i = 0; i < ready; ++i) {
      if (events[static_cast<std::size_t>(i)].data.fd == end_.get()) return;
      last_us_.store(now_us, std::memory_order_release);
    }
  }
}

}  // namespace cabinet
