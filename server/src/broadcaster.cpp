#include "broadcaster.h"

#include <sched.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "os/capabilities.h"
#include "os/clock.h"
#include "os/cores.h"

namespace server {

Broadcaster::Broadcaster(int fd, std::size_t capacity, int priority)
    : fd_(fd), capacity_(capacity) {
  listeners_.reserve(capacity);
  messages_.resize(capacity);
  sealed_.resize(capacity);
  for (Parcel& parcel : parcels_) parcel.to.reserve(capacity);
  thread_ = std::thread([this, priority] { run(priority); });
}

Broadcaster::~Broadcaster() {
  close();
}

void Broadcaster::add(const Listener& listener) {
  if (listeners_.size() < capacity_) listeners_.push_back(listener);
}

void Broadcaster::remove(std::uint32_t client) {
  std::erase_if(listeners_, [client](const Listener& l) { return l.client == client; });
}

void Broadcaster::expect() {
  if (listeners_.empty()) return;
  expected_.store(given_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  work_.post();
}

void Broadcaster::send(std::span<const std::byte> datagram, std::uint64_t counter,
                       std::int64_t tick_ns) {
  if (listeners_.empty()) return;
  const std::uint32_t given = given_.load(std::memory_order_relaxed);
  if (given - done_.load(std::memory_order_acquire) == kParcels) {
    errors_.fetch_add(listeners_.size(), std::memory_order_relaxed);
    return;
  }
  Parcel& parcel = parcels_[given % kParcels];
  std::copy(datagram.begin(), datagram.end(), parcel.datagram.begin());
  parcel.size = datagram.size();
  parcel.counter = counter;
  parcel.tick_ns = tick_ns;
  parcel.to.assign(listeners_.begin(), listeners_.end());  // within the reserved capacity
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
    ::sched_setscheduler(0, SCHED_FIFO, &wanted);  // refused: the loop has logged the same refusal
  }
  os::drop_capabilities(false);
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

// True if this thread has a core beside the tick's. Checked again from time to time, since an
// administrator may change the affinity. With a quota of one core, busy-waiting would take the
// tick's time.
bool Broadcaster::spare_core() {
  constexpr std::uint32_t kEvery = 1024;  // a second
  if (looked_at_cores_++ % kEvery == 0) spare_core_ = os::usable_cores() > 1;
  return spare_core_;
}

// Busy-waits, since a wake-up takes as long as the tick does. After several failures in a row (long
// ticks, a loaded machine) it stops for a while.
void Broadcaster::await(std::uint32_t done) {
  constexpr int kMaxFailedWaits = 8, kRest = 1000;
  if (expected_.load(std::memory_order_acquire) != done + 1 || !spare_core()) return;
  if (failed_waits_ >= kMaxFailedWaits) {
    if (++failed_waits_ > kMaxFailedWaits + kRest) failed_waits_ = 0;
    return;
  }
  const std::int64_t end = os::monotonic_ns() + kLookOutNs;
  while (given_.load(std::memory_order_acquire) == done) {
    if (os::monotonic_ns() >= end) {
      ++failed_waits_;
      return;
    }
  }
  failed_waits_ = 0;
}

namespace {

// Sends from the address that the client knows, on a machine with several.
template <class Info>
std::size_t put_source(std::span<std::byte> control, int level, int type, const Info& info) {
  auto* head = reinterpret_cast<cmsghdr*>(control.data());
  head->cmsg_level = level;
  head->cmsg_type = type;
  head->cmsg_len = CMSG_LEN(sizeof info);
  std::memcpy(CMSG_DATA(head), &info, sizeof info);
  return CMSG_SPACE(sizeof info);
}

std::size_t put_source(std::span<std::byte> control, const os::SocketAddress& from) {
  if (from.empty()) return 0;
  if (from.is_ipv6()) {
    in6_pktinfo info{};
    info.ipi6_addr = from.ipv6().sin6_addr;
    return put_source(control, IPPROTO_IPV6, IPV6_PKTINFO, info);
  }
  in_pktinfo info{};
  info.ipi_spec_dst = from.ipv4().sin_addr;
  return put_source(control, IPPROTO_IP, IP_PKTINFO, info);
}

}  // namespace

void Broadcaster::prepare(Parcel& parcel, std::size_t i) {
  Listener& listener = parcel.to[i];
  Sealed& sealed = sealed_[i];
  const auto plain = std::span<const std::byte>(parcel.datagram).first(parcel.size);
  const std::size_t size =
      wire::seal_datagram(listener.key, listener.client, parcel.counter, plain, sealed.bytes);
  sealed.part = {sealed.bytes.data(), size};
  mmsghdr& message = messages_[i];
  message = {};
  message.msg_hdr.msg_name = listener.to.generic();
  message.msg_hdr.msg_namelen = listener.to.size();
  message.msg_hdr.msg_iov = &sealed.part;
  message.msg_hdr.msg_iovlen = 1;
  sealed.control = {};
  message.msg_hdr.msg_controllen = put_source(sealed.control, listener.from);
  if (message.msg_hdr.msg_controllen != 0) message.msg_hdr.msg_control = sealed.control.data();
}

void Broadcaster::deliver(Parcel& parcel) {
  const std::int64_t begun = os::monotonic_ns();
  const std::size_t listeners = parcel.to.size();
  for (std::size_t i = 0; i < listeners; ++i) prepare(parcel, i);
  for (std::size_t at = 0; at < listeners;) {
    const auto left = static_cast<unsigned>(listeners - at);
    const int sent = ::sendmmsg(fd_, messages_.data() + at, left, MSG_DONTWAIT);
    if (sent > 0) {
      at += static_cast<std::size_t>(sent);
      sent_.fetch_add(static_cast<std::uint64_t>(sent), std::memory_order_relaxed);
      bytes_.fetch_add(static_cast<std::uint64_t>(sent) * (parcel.size + wire::kSealBytes),
                       std::memory_order_relaxed);
    } else {  // the first of the rest failed; the others may succeed
      errors_.fetch_add(1, std::memory_order_relaxed);
      last_error_.store(errno, std::memory_order_relaxed);
      ++at;
    }
  }
  const std::int64_t ended = os::monotonic_ns();
  stats_.cost.record(ended - begun);
  stats_.to_wire.record(ended - parcel.tick_ns);
}

}  // namespace server
