#include "phone_port.h"

#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <thread>
#include <vector>

#include "door.h"
#include "os/capabilities.h"
#include "os/clock.h"
#include "phone_caller.h"
#include "server/spsc_queue.h"

namespace server {
namespace {

// Without free descriptors, accept(2) fails at once, repeatedly.
constexpr auto kAcceptPause = std::chrono::milliseconds(100);
constexpr auto kGoodbye = std::chrono::milliseconds(200);
constexpr int kLinesAtOnce = 20;
constexpr std::int64_t kLineEveryUs = 1'000'000;

// Uses only letters and digits that are not easily confused: 20 of 31 give 99 bits.
std::string make_token(const std::function<std::uint64_t()>& random) {
  constexpr char kLetters[] = "23456789abcdefghjkmnpqrstuvwxyz";
  std::string token;
  for (int i = 0; i < 20; ++i) token += kLetters[random() % (sizeof kLetters - 1)];
  return token;
}

// The address where other machines reach this one: the listening address, or, if that is "any", the
// source address of its route to the Internet. No packet is sent.
std::string host_for_others(const os::SocketAddress& listen) {
  if (!listen.is_any()) return listen.host();
  for (const char* far : {"192.0.2.1", "2001:db8::1"}) {  // documentation: RFC 5737, 3849
    const auto to = os::parse_address(far, 9);
    const os::FileDescriptor fd(::socket(to->family(), SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (!fd || ::connect(fd.get(), to->generic(), to->size()) != 0) continue;
    const auto here = os::local_address(fd.get());
    if (!here.empty() && !here.is_any()) return here.host();
  }
  return os::loopback(0).host();
}

tl::expected<os::FileDescriptor, SocketError> listen_at(const os::SocketAddress& address) {
  constexpr int kBacklog = 128, kYes = 1, kNo = 0;
  os::FileDescriptor fd(::socket(address.family(), SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const bool ok = fd && ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &kYes, sizeof kYes) == 0 &&
                  (!address.is_ipv6() ||
                   ::setsockopt(fd.get(), IPPROTO_IPV6, IPV6_V6ONLY, &kNo, sizeof kNo) == 0) &&
                  ::bind(fd.get(), address.generic(), address.size()) == 0 &&
                  ::listen(fd.get(), kBacklog) == 0;
  if (!ok) return tl::unexpected(SocketError{errno});
  return fd;
}

}  // namespace

struct PhonePort::Impl final : PhoneHouse {
  Impl(PhonePortOptions given, os::FileDescriptor listener, os::FileDescriptor wake);

  void accept_next();
  void admit(os::FileDescriptor socket, const os::SocketAddress& peer);
  void make_room_at_the_door();
  void receive_pulses();
  void run();
  void end();

  // PhoneHouse
  const PhonePortOptions& options() const override { return options_; }
  const std::string& token() const override { return token_; }
  bool has_room() const override;
  bool adopt(VouchedConnection&& connection) override { return adopt_(std::move(connection)); }
  void take(const PhoneInputEvent& event) override;
  void count(Count which) override {
    counts_[static_cast<std::size_t>(which)].fetch_add(1, std::memory_order_relaxed);
  }
  void log(LogLevel level, const std::string& text) override;
  void gone(PhoneCaller* caller) override;

  std::uint64_t value(Count which) const {
    return counts_[static_cast<std::size_t>(which)].load(std::memory_order_relaxed);
  }

  PhonePortOptions options_;
  std::string token_, url_;
  std::uint16_t port_ = 0;
  std::function<bool(VouchedConnection&&)> adopt_;
  asio::io_context io_{1};
  asio::posix::stream_descriptor listener_, wake_;
  asio::steady_timer pause_, goodbye_;
  std::vector<std::shared_ptr<PhoneCaller>> callers_;  // in order of arrival
  RateLimit log_limit_{kLinesAtOnce, kLineEveryUs};
  bool ending_ = false;
  SpscQueue<PhoneInputEvent, 1024> inputs_;
  SpscQueue<PhonePulseEvent, 256> pulses_;
  std::array<std::atomic<std::uint64_t>, static_cast<std::size_t>(Count::kCount)> counts_{};
  std::thread thread_;
};

PhonePort::Impl::Impl(PhonePortOptions given, os::FileDescriptor listener, os::FileDescriptor wake)
    : options_(std::move(given)),
      token_(make_token(options_.random)),
      listener_(io_),
      wake_(io_),
      pause_(io_),
      goodbye_(io_) {
  auto address = os::local_address(listener.get());
  port_ = address.port();
  auto shown = os::parse_address(host_for_others(address), port_);
  url_ = "http://" + os::to_text(shown ? *shown : os::loopback(port_)) + "/" + token_;
  listener_.assign(listener.release());
  wake_.assign(wake.release());
}

// Uses accept4(2) directly, which returns the address and sets the flags in one call.
void PhonePort::Impl::accept_next() {
  listener_.async_wait(asio::posix::stream_descriptor::wait_read, [this](const Error& error) {
    if (error || ending_) return;
    constexpr int kAtOnce = 32;
    for (int i = 0; i < kAtOnce; ++i) {
      sockaddr_storage storage{};
      socklen_t size = sizeof storage;
      auto* generic = reinterpret_cast<sockaddr*>(&storage);
      os::FileDescriptor socket(
          ::accept4(listener_.native_handle(), generic, &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
      if (socket) {
        admit(std::move(socket), os::SocketAddress::from(generic, size));
      } else if (errno != ECONNABORTED && errno != EINTR) {
        if (errno == EAGAIN) break;
        pause_.expires_after(kAcceptPause);
        return pause_.async_wait([this](const Error& cancelled) {
          if (!cancelled) accept_next();
        });
      }
    }
    accept_next();
  });
}

void PhonePort::Impl::admit(os::FileDescriptor socket, const os::SocketAddress& peer) {
  count(Count::accepted);
  make_room_at_the_door();
  callers_.push_back(std::make_shared<PhoneCaller>(*this, io_, std::move(socket), peer));
  callers_.back()->begin();
}

// As on the control port: drops the oldest of the network with the most of them.
void PhonePort::Impl::make_room_at_the_door() {
  std::map<std::string, int> crowd;
  int greeting = 0;
  for (const auto& caller : callers_)
    if (!caller->inside()) ++greeting, ++crowd[caller->peer().network()];
  if (greeting < options_.limits.greeting) return;
  int max = 0;
  for (const auto& [network, count] : crowd) max = std::max(max, count);
  const auto oldest = std::ranges::find_if(callers_, [&](const auto& caller) {
    return !caller->inside() && crowd.at(caller->peer().network()) == max;
  });
  count(Count::crowded_out);
  const auto keep = *oldest;
  keep->drop();
}

bool PhonePort::Impl::has_room() const {
  const auto inside = std::ranges::count_if(callers_, [](const auto& c) { return c->inside(); });
  return inside < options_.limits.phones;
}

void PhonePort::Impl::take(const PhoneInputEvent& event) {
  count(inputs_.push(event) ? Count::inputs : Count::inputs_dropped);
}

void PhonePort::Impl::log(LogLevel level, const std::string& text) {
  if (log_limit_.take(os::monotonic_us())) options_.log(level, text);
}

void PhonePort::Impl::gone(PhoneCaller* caller) {
  std::erase_if(callers_, [caller](const auto& c) { return c.get() == caller; });
  if (ending_ && callers_.empty()) io_.stop();
}

void PhonePort::Impl::receive_pulses() {
  wake_.async_wait(asio::posix::stream_descriptor::wait_read, [this](const Error& error) {
    if (error) return;
    eventfd_t times = 0;
    ::eventfd_read(wake_.native_handle(), &times);
    PhonePulseEvent event;
    while (pulses_.pop(event)) {
      const auto keep = callers_;  // a slow one is dropped during the loop
      for (const auto& caller : keep)
        if (caller->client() == event.client) caller->pulse(event);
    }
    receive_pulses();
  });
}

void PhonePort::Impl::run() {
  os::drop_capabilities(false);  // untrusted bytes are read here
  io_.run();
}

// Ends after pending messages are sent, or after 0.2 s.
void PhonePort::Impl::end() {
  ending_ = true;
  Error ignored;
  listener_.close(ignored);
  pause_.cancel();
  goodbye_.expires_after(kGoodbye);
  goodbye_.async_wait([this](const Error&) { io_.stop(); });
  const auto keep = callers_;
  for (const auto& caller : keep) caller->leave_after_output();
  if (callers_.empty()) io_.stop();
}

tl::expected<std::unique_ptr<PhonePort>, SocketError> PhonePort::open(PhonePortOptions options) {
  const auto address = os::parse_address(options.listen, options.port);
  if (!address) return tl::unexpected(SocketError{});
  auto listener = listen_at(*address);
  if (!listener) return tl::unexpected(listener.error());
  os::FileDescriptor wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake) return tl::unexpected(SocketError{errno});
  try {
    return std::unique_ptr<PhonePort>(new PhonePort(
        std::make_unique<Impl>(std::move(options), std::move(*listener), std::move(wake))));
  } catch (const boost::system::system_error& error) {  // no free descriptor
    return tl::unexpected(SocketError{error.code().value()});
  }
}

PhonePort::PhonePort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

PhonePort::~PhonePort() {
  stop();
}

const std::string& PhonePort::url() const {
  return impl_->url_;
}

std::uint16_t PhonePort::port() const {
  return impl_->port_;
}

void PhonePort::start(std::function<bool(VouchedConnection&&)> adopt) {
  Impl& in = *impl_;
  in.adopt_ = std::move(adopt);
  in.accept_next();
  in.receive_pulses();
  in.thread_ = std::thread([&in] { in.run(); });
}

void PhonePort::stop() {
  Impl& in = *impl_;
  if (!in.thread_.joinable()) return;
  asio::post(in.io_, [&in] { in.end(); });
  in.thread_.join();
  const auto keep = std::exchange(in.callers_, {});
  for (const auto& caller : keep) caller->drop();
}

bool PhonePort::next_input(PhoneInputEvent& event) {
  return impl_->inputs_.pop(event);
}

void PhonePort::pulse(const PhonePulseEvent& event) {
  if (!impl_->pulses_.push(event)) return impl_->count(PhoneHouse::Count::pulses_dropped);
  ::eventfd_write(impl_->wake_.native_handle(), 1);
}

PhoneCounters PhonePort::counters() const {
  const Impl& in = *impl_;
  using Count = PhoneHouse::Count;
  return {.accepted = in.value(Count::accepted),
          .pages = in.value(Count::pages),
          .joined = in.value(Count::joined),
          .refused = in.value(Count::refused),
          .bad_messages = in.value(Count::bad_messages),
          .timed_out = in.value(Count::timed_out),
          .crowded_out = in.value(Count::crowded_out),
          .slow_dropped = in.value(Count::slow_dropped),
          .inputs = in.value(Count::inputs),
          .inputs_dropped = in.value(Count::inputs_dropped),
          .pulses = in.value(Count::pulses),
          .pulses_dropped = in.value(Count::pulses_dropped)};
}

}  // namespace server
