#include "core/snapshot_listener.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cmath>

#include "os/clock.h"

namespace client {
namespace {

// Maximum number of datagrams received before the person's input is sent again. With twice as many,
// a flood could delay the input by 2 ms (measured: 3.4 us for a good snapshot). This number makes
// up for a stall of a quarter of a second at 1 kHz in one call.
constexpr std::size_t kMaxAtOnce = 256;
static_assert(kLongestDatagram >
              wire::kMaxDatagram + wire::kSealBytes);  // a longer datagram shows as too long
constexpr std::int64_t kSendEveryUs = 1'000;
constexpr std::int64_t kRepeatUs = 45'000;     // 20 a second are promised: slightly more often
constexpr std::int64_t kForgetUs = 1'000'000;  // a stalled window must not hold the rods for ever
constexpr int kIdleMs = 1000;

bool same(const wire::InputRod& a, const wire::InputRod& b) {
  return a.driven == b.driven && a.slide == b.slide && a.angle == b.angle &&
         a.slide_rate == b.slide_rate && a.angle_rate == b.angle_rate;
}

}  // namespace

SnapshotListener::SnapshotListener(UdpSocket unicast)
    : unicast_(std::move(unicast)), thread_([this] { run(); }) {}

SnapshotListener::~SnapshotListener() {
  stop_ = true;
  waker_.wake();
  thread_.join();
}

tl::expected<void, std::string> SnapshotListener::join(const wire::Welcome& welcome,
                                                       const os::SocketAddress& server,
                                                       const os::SocketAddress& here) {
  std::shared_ptr<const UdpSocket> group;
  if (!welcome.multicast.empty()) {
    auto opened = open_multicast(welcome.multicast, welcome.multicast_port, here);
    if (!opened) return tl::unexpected(opened.error());
    group = std::make_shared<const UdpSocket>(std::move(*opened));
  }
  const std::lock_guard lock(mutex_);
  multicast_ = std::move(group);
  os::SocketAddress inputs = server;
  inputs.set_port(welcome.udp_port);
  if (!accept_only_from(unicast_, inputs)) {
    return tl::unexpected("There is no route to the server's UDP port " + os::to_text(inputs) +
                          ": check this machine's network.");
  }
  // A group's key stays the same after a lost connection.
  opener_.use(welcome.snapshot_key, welcome.multicast.empty() ? welcome.client : 0);
  input_key_ = welcome.input_key;
  client_ = welcome.client;
  sealed_ = 0;
  buffer_.begin_session(welcome.session, welcome.tick_us);
  input_ = {.session = welcome.session, .token = welcome.token, .sequence = input_.sequence};
  input_known_ = input_changed_ = false;  // earlier input was for another match
  joined_ = true;
  waker_.wake();
  return {};
}

void SnapshotListener::leave() {
  const std::lock_guard lock(mutex_);
  joined_ = false;
  multicast_.reset();
  waker_.wake();  // the thread holds the group until it wakes
}

SceneSample SnapshotListener::sample(std::int64_t now_us) {
  const std::lock_guard lock(mutex_);
  return buffer_.sample(now_us);
}

std::vector<wire::EventSnapshot> SnapshotListener::take_events() {
  const std::lock_guard lock(mutex_);
  return buffer_.take_events();
}

SnapshotCounters SnapshotListener::counters() const {
  const std::lock_guard lock(mutex_);
  return buffer_.counters();
}

std::int64_t SnapshotListener::delay_us() const {
  const std::lock_guard lock(mutex_);
  return buffer_.delay_us();
}

void SnapshotListener::drive(std::uint64_t session, const std::array<wire::InputRod, 8>& rods,
                             std::int64_t now_us) {
  const std::lock_guard lock(mutex_);
  if (!joined_ || session != input_.session) return;
  driven_at_us_ = now_us;
  if (input_known_ && std::equal(rods.begin(), rods.end(), input_.rods.begin(), same)) return;
  input_.rods = rods;
  input_known_ = input_changed_ = true;
  waker_.wake();
}

// Precondition: the lock is held. A repeated input has positions, but zero rates.
void SnapshotListener::send_input(std::int64_t now_us) {
  if (!input_changed_) {
    for (wire::InputRod& rod : input_.rods) rod.slide_rate = rod.angle_rate = 0;
  }
  ++input_.sequence;
  std::array<std::byte, wire::kMaxInputDatagram> plain;
  std::array<std::byte, wire::kMaxInputDatagram + wire::kSealBytes> bytes;
  const auto input = std::span<const std::byte>(plain).first(wire::encode_input(input_, plain));
  const std::size_t size = wire::seal_datagram(input_key_, client_, sealed_++, input, bytes);
  ::send(unicast_.fd.get(), bytes.data(), size, 0);
  inputs_sent_.fetch_add(1, std::memory_order_relaxed);
  input_changed_ = false;
  sent_at_us_ = now_us;
}

// Sends the due input; returns the time until the next one [ms].
int SnapshotListener::send_due(std::int64_t now_us) {
  const std::lock_guard lock(mutex_);
  if (!joined_ || !input_known_ || now_us - driven_at_us_ > kForgetUs) return kIdleMs;
  const std::int64_t due = sent_at_us_ + (input_changed_ ? kSendEveryUs : kRepeatUs);
  if (now_us >= due) {
    send_input(now_us);
    return static_cast<int>(kRepeatUs / 1000);
  }
  return static_cast<int>((due - now_us + 999) / 1000);
}

// Takes the lock, because join() may connect the same socket to another server meanwhile.
void SnapshotListener::receive(int socket) {
  const std::lock_guard lock(mutex_);
  take_datagrams(socket, kMaxAtOnce,
                 [&](std::span<const std::byte> bytes) { take(bytes, os::monotonic_us()); });
}

// Precondition: the lock is held.
void SnapshotListener::take(std::span<const std::byte> sealed, std::int64_t arrival) {
  std::array<std::byte, wire::kMaxDatagram> plain;
  std::size_t size = 0;
  switch (opener_.open(sealed, plain, size)) {
    case wire::SealVerdict::good:
      break;
    case wire::SealVerdict::foreign:
      return buffer_.count_foreign();
    case wire::SealVerdict::replayed:
      return buffer_.count_old();
    case wire::SealVerdict::malformed:
    case wire::SealVerdict::forged:
      return buffer_.count_bad();
  }
  if (!wire::decode_snapshot(std::span(plain).first(size), received_)) return buffer_.count_bad();
  if (buffer_.push(received_, arrival) == SnapshotBuffer::Verdict::taken) {
    last_arrival_us_.store(arrival, std::memory_order_relaxed);
  }
}

void SnapshotListener::run() {
  while (!stop_) {
    const int wait_ms = send_due(os::monotonic_us());
    std::shared_ptr<const UdpSocket> group;  // a reference, so that leave() closes no socket in use
    {
      const std::lock_guard lock(mutex_);
      group = multicast_;
    }
    pollfd polled[3] = {{waker_.fd(), POLLIN, 0},
                        {unicast_.fd.get(), POLLIN, 0},
                        {group ? group->fd.get() : -1, POLLIN, 0}};
    if (::poll(polled, 3, wait_ms) < 0) continue;
    if (polled[0].revents != 0) waker_.drain();
    if (polled[1].revents != 0) receive(unicast_.fd.get());
    if (group && polled[2].revents != 0) receive(group->fd.get());
  }
}

}  // namespace client
