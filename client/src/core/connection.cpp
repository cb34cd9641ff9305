#include "client/connection.h"

#include "core/control_link.h"
#include "os/clock.h"
#include "os/socket_address.h"

namespace client {

struct Connection::Impl {
  Impl(const ConnectionOptions& o, const os::SocketAddress& server, UdpSocket udp)
      : options(o), listener(std::move(udp)), link(o, server, listener) {}
  ConnectionOptions options;
  SnapshotListener listener;
  ControlLink link;
};

tl::expected<std::unique_ptr<Connection>, std::string> Connection::open(
    const ConnectionOptions& options) {
  // For a server on this machine, the socket receives from this machine only.
  const auto server = resolve(options.host, options.port);
  if (!server) return tl::unexpected(server.error());
  auto udp = open_udp(own_address_for(*server));
  if (!udp) return tl::unexpected(udp.error());
  return std::unique_ptr<Connection>(
      new Connection(std::make_unique<Impl>(options, *server, std::move(*udp))));
}

Connection::Connection(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Connection::~Connection() = default;

void Connection::start() {
  impl_->link.start();
}

ConnectionStatus Connection::status() const {
  ConnectionStatus status = impl_->link.status();
  status.small_receive_buffer = impl_->listener.small_buffer();
  return status;
}

std::string Connection::address() const {
  return impl_->options.host + ":" + std::to_string(impl_->options.port);
}
SceneSample Connection::sample(std::int64_t now_us) {
  return impl_->listener.sample(now_us);
}
std::vector<wire::EventSnapshot> Connection::take_events() {
  return impl_->listener.take_events();
}
std::vector<wire::Notice> Connection::notices() const {
  return impl_->link.notices();
}
SnapshotCounters Connection::counters() const {
  return impl_->listener.counters();
}
std::int64_t Connection::delay_us() const {
  return impl_->listener.delay_us();
}
std::optional<wire::Tuning> Connection::tuning() const {
  return impl_->link.tuning();
}
std::optional<wire::Game> Connection::game() const {
  return impl_->link.game();
}
std::optional<wire::Questionnaire> Connection::questionnaire() const {
  return impl_->link.questionnaire();
}
std::string Connection::phones() const {
  return impl_->link.phones();
}
std::optional<wire::Report> Connection::report() const {
  return impl_->link.report();
}
wire::Roster Connection::roster() const {
  return impl_->link.roster();
}
void Connection::claim(std::uint64_t session, const wire::Claim& claim) {
  impl_->link.claim(session, claim);
}
void Connection::kick(std::uint64_t session, const wire::Kick& kick) {
  impl_->link.kick(session, kick);
}
void Connection::choose(std::uint64_t session, const wire::Game& game) {
  impl_->link.choose(session, game);
}
void Connection::join_as(const std::string& name) {
  impl_->link.join_as(name);
}
void Connection::name(std::uint64_t session, const wire::Names& names) {
  impl_->link.name(session, names);
}
void Connection::answer(std::uint64_t session, const wire::Answers& answers) {
  impl_->link.answer(session, answers);
}
void Connection::ask_devices(std::uint64_t session) {
  impl_->link.ask_devices(session);
}
std::optional<wire::Devices> Connection::take_devices() {
  return impl_->link.take_devices();
}
void Connection::request(std::uint64_t session, const wire::MatchRequest& request) {
  impl_->link.request(session, request);
}
void Connection::drive(std::uint64_t session, const std::array<wire::InputRod, 8>& rods) {
  impl_->listener.drive(session, rods, os::monotonic_us());
}
std::uint64_t Connection::inputs_sent() const {
  return impl_->listener.inputs_sent();
}

}  // namespace client
