#include "broadcaster.h"

#include <sched.h>

#include <algorithm>

#include "os/clock.h"

namespace server {

Broadcaster::Broadcaster(int fd, std::size_t capacity, int priority)
    : fd_(fd), capacity_(capacity) {
  listeners_.reserve(capacity);
  messages_.reserve(capacity);
  for (Parcel& parcel : parcels_) parcel.to.reserve(capacity);
  thread_ = std::thread([this, priority] { run(priority); });
}

Broadcaster::~Broadcaster() {
  close();
}

void Broadcaster::add(std::uint32_t client, const sockaddr_in& listener) {
  if (listeners_.size() < capacity_) listeners_.push_back({client, listener});
}

void Broadcaster::remove(std::uint32_t client) {
  std::erase_if(listeners_, [client](const Listener& l) { return l.client == client; });
}

void Broadcaster::expect() {
  if (listeners_.empty()) return;
  expected_.store(given_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  work_.post();
}

void Broadcaster::send(std::span<const std::byte> datagram, std::int64_t tick_ns) {
  if (listeners_.empty()) return;
  const std::uint32_t given = given_.load(std::memory_order_relaxed);
  if (given - done_.load(std::memory_order_acquire) == kParcels) {
    errors_.fetch_add(listeners_.size(), std::memory_order_relaxed);
    return;
  }
  Parcel& parcel = parcels_[given % kParcels];
  std::copy(datagram.begin(), datagram.end(), parcel.datagram.begin());
  parcel.size = datagram.size();
  parcel.tick_ns = tick_ns;
  parcel.to.clear();
  for (const Listener& listener : listeners_) parcel.to.push_back(listener.address);
  given_.store(given + 1, std::memory_order_release);
  work_.post();
}

void Broadcaster::wait_sent() {
  const std::uint32_t given = given_.load(std::memory_order_relaxed);
  for (std::uint32_t done; (done = done_.load(std::memory_order_acquire)) != given;) {
    done_.wait(done, std::memory_order_acquire);
  }
}

void Broadcaster::close() {
  if (!thread_.joinable()) return;
  closing_.store(true, std::memory_order_release);
  work_.post();
  thread_.join();
}

void Broadcaster::run(int priority) {
  if (priority > 0) {
    const sched_param wanted{.sched_priority = priority};
    ::sched_setscheduler(0, SCHED_FIFO, &wanted);  // refused: the loop has said so of its own
  }
  std::uint32_t done = 0;
  while (true) {
    const bool closing = closing_.load(std::memory_order_acquire);
    while (done != given_.load(std::memory_order_acquire)) {
      deliver(parcels_[done % kParcels]);
      done_.store(++done, std::memory_order_release);
      done_.notify_all();
    }
    if (closing) return;
    work_.wait();
    await(done);
  }
}

// Awake, since to be woken takes as long as the tick does.
void Broadcaster::await(std::uint32_t done) {
  static const bool beside = std::thread::hardware_concurrency() > 1;  // else it would hold it up
  if (!beside || expected_.load(std::memory_order_acquire) != done + 1) return;
  const std::int64_t end = os::monotonic_ns() + kLookOutNs;
  while (given_.load(std::memory_order_acquire) == done && os::monotonic_ns() < end) {
  }
}

void Broadcaster::deliver(Parcel& parcel) {
  const std::int64_t begun = os::monotonic_ns();
  iovec part{parcel.datagram.data(), parcel.size};
  messages_.clear();
  for (sockaddr_in& address : parcel.to) {
    mmsghdr message{};
    message.msg_hdr.msg_name = &address;
    message.msg_hdr.msg_namelen = sizeof address;
    message.msg_hdr.msg_iov = &part;
    message.msg_hdr.msg_iovlen = 1;
    messages_.push_back(message);
  }
  for (std::size_t at = 0; at < messages_.size();) {
    const auto left = static_cast<unsigned>(messages_.size() - at);
    const int sent = ::sendmmsg(fd_, messages_.data() + at, left, MSG_DONTWAIT);
    if (sent > 0) {
      at += static_cast<std::size_t>(sent);
      sent_.fetch_add(static_cast<std::uint64_t>(sent), std::memory_order_relaxed);
      bytes_.fetch_add(static_cast<std::uint64_t>(sent) * parcel.size, std::memory_order_relaxed);
    } else {  // the first of the rest could not be sent: the others may
      errors_.fetch_add(1, std::memory_order_relaxed);
      ++at;
    }
  }
  const std::int64_t ended = os::monotonic_ns();
  stats_.cost.record(ended - begun);
  stats_.to_wire.record(ended - parcel.tick_ns);
}

}  // namespace server
