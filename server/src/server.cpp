#include "server/server.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "characters/record.h"
#include "os/clock.h"
#include "os/socket_address.h"
#include "server/match_record.h"
#include "server_impl.h"
#include "snapshot_builder.h"

namespace server {
namespace {

// A restart's serve rebuilds the match's world: this bounds them to two per tick.
constexpr std::size_t kMaxCommands = 8;
static_assert(kMaxCommands <= wire::kMaxJournalCommands);

StartError port_error(const NetworkOptions& network, const SocketError& error) {
  return {error.occupied() ? StartError::Kind::port_taken : StartError::Kind::bad_option,
          sentence(network, error)};
}

tl::expected<std::unique_ptr<PhonePort>, StartError> open_phones(const ServerOptions& options) {
  using Kind = StartError::Kind;
  const std::string& listen =
      options.phones.listen.empty() ? options.network.listen : options.phones.listen;
  PhonePortOptions wanted;
  wanted.listen = listen;
  wanted.port = options.phones.port;
  wanted.limits = options.phones.limits;
  wanted.layout = options.match.layout;
  wanted.random = options.random;
  wanted.log = options.log;
  auto opened = PhonePort::open(std::move(wanted));
  if (opened) return std::move(*opened);
  const SocketError& error = opened.error();
  return tl::unexpected(
      StartError{error.occupied() ? Kind::port_taken : Kind::bad_option,
                 "cannot listen for phones at port " + std::to_string(options.phones.port) +
                     " on " + listen + ": " + std::strerror(error.number) +
                     "; choose another port with --phone-port, or omit --phones"});
}

}  // namespace

Server::Impl::Impl(ServerOptions&& given, foosball::Match&& made, PortPair&& opened,
                   os::FileDescriptor&& wake, std::unique_ptr<Recorder>&& journal,
                   std::unique_ptr<PhonePort>&& for_phones)
    : options(std::move(given)),
      group_key(options.network.multicast ? random_key(options.random) : wire::SealKey{}),
      everywhere(os::parse_address(options.network.listen, 0)->is_any()),
      match(std::move(made)),
      port(opened.port),
      udp(std::move(opened.udp)),
      input(udp.get(), options.session, foosball::kRods),
      broadcaster(udp.get(), static_cast<std::size_t>(options.limits.connections) + 1,
                  options.send_priority),
      desk(options.match, options.computer, options.computer_fills, options.computer_player,
           match.view()),
      haptics(options.haptics),
      recorder(std::move(journal)),
      scribe(options.match),
      opponent(opponent_of(options.computer_player)),
      phones(std::move(for_phones)),
      control(control_options(), std::move(opened.tcp), std::move(wake)) {
  if (phones) {
    phones->start([this](VouchedConnection&& phone) { return control.adopt(std::move(phone)); });
    haptics.to_clients([this](std::uint32_t client, const cabinet::HapticPulse& pulse) {
      const auto strength = static_cast<std::uint8_t>(std::lround(255.0f * pulse.strength));
      phones->pulse({client, pulse.rod, strength, pulse.ms});
    });
  }
  clients.reserve(static_cast<std::size_t>(options.limits.connections));
  next.commands.reserve(wire::kMaxJournalCommands);
  snapshot.session = options.session;
  snapshot.events.reserve(wire::kMaxEvents);
  if (options.network.multicast) {
    const auto& group = *options.network.multicast;
    broadcaster.add({.client = 0,
                     .to = *os::parse_address(group.address, group.port),
                     .from = {},
                     .key = group_key});
  }
  if (!options.results.empty() && !options.replay) {
    results = std::make_unique<ResultsLog>(ResultsLogOptions{.path = options.results});
  }
}

ControlOptions Server::Impl::control_options() const {
  ControlOptions out;
  out.limits = options.limits;
  out.access = options.access;
  out.session = options.session;
  out.udp = udp.get();
  out.udp_port = port;
  out.group_key = group_key;
  out.layout = options.match.layout;
  out.characters = characters::to_record(options.match.characters);
  const bool computer = options.computer[0] || options.computer[1];
  out.site = site_of(options.match, computer, options.cabinet);
  out.date = options.date;
  out.challenge_date = options.challenge_date;
  out.multicast = options.network.multicast;
  out.teams_open = options.replay == nullptr;
  if (phones) out.phones = phones->url();
  out.random = options.random;
  out.log = options.log;
  return out;
}

// --- inputs

void Server::Impl::take_control_events() {
  next.commands.clear();
  ControlEvent event;
  // Each event makes at most one command. Further events wait in the queue for the next tick.
  while (next.commands.size() < kMaxCommands && control.next_event(event)) {
    switch (event.kind) {
      case ControlEvent::Kind::joined:
        admit(event);
        break;
      case ControlEvent::Kind::away:
        remember_name(event.client);
        desk.lost(event.client);
        input.remove(event.client);
        broadcaster.remove(event.client);
        break;
      case ControlEvent::Kind::back:
        take_back(event);
        break;
      case ControlEvent::Kind::rods:
        change_rods(event);
        break;
      case ControlEvent::Kind::name:
        change_name(event);
        break;
      case ControlEvent::Kind::left:
        dismiss(event.client, event.put_out);
        break;
      case ControlEvent::Kind::request:
        take_request(event);
        break;
      case ControlEvent::Kind::game:
        take_game(event.game);
        break;
      case ControlEvent::Kind::answers:
        keep_answers(event);
        break;
    }
  }
}

// Receives the client's inputs, and sends it snapshots.
void Server::Impl::listen_to(ControlEvent& event) {
  RemoteSource* source = desk.remote(event.client);
  if (source != nullptr && event.socket) {
    input.add({event.client, event.token, event.input_key}, std::move(event.socket), *source);
  }
  const bool unicast = !options.network.multicast && event.listener.port() != 0;
  if (!unicast) return;
  broadcaster.add({.client = event.client,
                   .to = event.listener,
                   .from = everywhere ? event.local_address : os::SocketAddress(),
                   .key = event.snapshot_key});
}

wire::SealKey Server::Impl::random_key(const std::function<std::uint64_t()>& random) {
  wire::SealKey key;
  for (std::size_t i = 0; i < key.size(); i += 8) {
    const std::uint64_t bits = random();
    for (std::size_t k = 0; k < 8; ++k) key[i + k] = static_cast<std::byte>(bits >> 8 * k);
  }
  return key;
}

void Server::Impl::take_request(const ControlEvent& event) {
  if (options.replay) return;
  if (event.request.kind == foosball::Command::Kind::pause) {
    const bool pause = event.request.value != 0;
    if (pause) paused_by_watcher = event.client != 0 && !plays(event.client);
    pause_outlasts_wait = waiting && pause;
    if (waiting) return;  // already paused until a player is heard
  }
  next.commands.push_back(to_record(event.request));
}

void Server::Impl::take_game(const wire::Game& asked) {
  if (options.replay) return;
  foosball::Command command{foosball::Command::Kind::set_up};
  command.setup = setup_of(asked, asked.date);
  next.commands.push_back(to_record(command));
  if (asked.level == 0) return;
  opponent = {asked.level, asked.style};
  desk.choose_player(player_of(opponent));
}

// A bounded number per tick, as for a client's socket; the rest waits.
void Server::Impl::take_phone_inputs(std::int64_t now_us) {
  constexpr int kMaxPerTick = 64;
  PhoneInputEvent event;
  for (int i = 0; i < kMaxPerTick && phones && phones->next_input(event); ++i) {
    if (RemoteSource* source = desk.remote(event.client)) source->accept(event.input, now_us);
  }
}

// False if there is no tick to step: still waiting for a client, or a recording is over.
bool Server::Impl::gather(std::int64_t now_us) {
  input.receive(now_us);
  take_phone_inputs(now_us);
  const bool begun = !options.await_client || clients_ever > 0;
  if (!options.replay) {
    gather_live(now_us);  // even before the first tick, so that devices do not overflow
    return begun;
  }
  if (!begun) return false;
  if (replay_over) return false;
  const wire::JournalTick* recorded = options.replay->next(match);
  if (recorded == nullptr) {
    replay_over = true;
    return false;
  }
  next = *recorded;
  return true;
}

void Server::Impl::gather_live(std::int64_t now_us) {
  desk.show_match(match.view().attract);
  desk.follow(match.view());
  watch_absences();
  desk.poll(now_us);
  add_commands();
  next.tick = ticks;
  for (int rod = 0; rod < foosball::kRods; ++rod) next.rods[rod] = to_grid(desk.rods()[rod]);
  device_watch.look(desk.devices(), now_us,
                    [this](auto index, const auto& fault, const auto& is_well) {
                      notify(Topic::devices, fault, is_well, index);
                    });
  device_watch.look_at_sensors(desk.devices(), now_us,
                               [this](auto index, const auto& fault, const auto& is_well) {
                                 notify(Topic::saturation, fault, is_well, index);
                               });
}

// --- outputs

void Server::Impl::put_drivers(wire::Snapshot& out) const {
  if (options.replay) return put_replay_drivers(next, out);
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    out.rods[rod].status = static_cast<std::uint8_t>(desk.rods()[rod].status);
    out.rods[rod].source = static_cast<std::uint8_t>(desk.driver(rod));
  }
}

void Server::Impl::broadcast(std::int64_t now_us, std::int64_t tick_ns) {
  ++snapshot.sequence;
  snapshot.send_time_us = now_us;
  build_snapshot(match.view(), snapshot);
  put_drivers(snapshot);
  events.fill(snapshot.events);
  const std::size_t size = wire::encode_snapshot(snapshot, datagram);
  broadcaster.send(std::span(datagram).first(size), snapshot.sequence, tick_ns);
}

void Server::Impl::watch_journal() {
  if (!recorder || journal_failure_reported || !recorder->file().failed()) return;
  journal_failure_reported = true;
  notify(Topic::journal, recorder->file().problem());
}

// Clients show it, and use it to predict their own rods.
void Server::Impl::watch_tuning() {
  const foosball::Tuning& now = match.view().tuning;
  if (sent_tuning == now) return;
  wire::Tuning tuning;
  for (std::size_t i = 0; i < tuning.values.size(); ++i)
    tuning.values[i] = now.*foosball::kTuningFields[i].value;
  if (control.send_tuning(tuning)) sent_tuning = now;
}

// Clients show it, and use it as the start of a choice.
void Server::Impl::watch_game() {
  const foosball::MatchView& view = match.view();
  const wire::Game now = to_game(view.setup, opponent, view.setup_waits || desk.player_waits());
  if (sent_game == now) return;
  if (control.send_game(now)) sent_game = now;
}

void Server::Impl::show_devices(std::int64_t now_us) {
  if (!control.devices_asked()) return;
  fill(device_table, desk.devices(), now_us);
  control.report_devices(device_table);
}

// Checks once a second whether any snapshot was sent.
void Server::Impl::watch_sending() {
  constexpr std::uint64_t kEveryTicks = 1000;
  if (snapshot.sequence % kEveryTicks != 0) return;
  const std::uint64_t sent = broadcaster.sent(), errors = broadcaster.errors();
  const bool failing = errors > errors_seen && sent == sent_seen;
  sent_seen = sent;
  errors_seen = errors;
  if (failing == std::exchange(sending_fails, failing)) return;
  notify(Topic::sending,
         failing ? wire::make_sentence<wire::SentenceId::nothing_is_sent>(
                       std::strerror(broadcaster.last_error()))
                 : wire::Sentence(),
         "snapshots are sent again");
}

void Server::Impl::notify(Topic topic, const wire::Sentence& text, const std::string& over,
                          std::uint32_t index) {
  const std::uint32_t number = static_cast<std::uint32_t>(topic) + index;
  if (text.empty()) return control.clear(number, over);
  control.notify(wire::Notice::Level::warning, number, text);
}

// --- public interface

tl::expected<std::unique_ptr<Server>, StartError> Server::create(ServerOptions options) {
  using Kind = StartError::Kind;
  if (options.replay) options.match = options.replay->match();
  const wire::JournalHeader header = to_header(options.match);
  options.match = from_header(header);
  auto match = foosball::Match::create(options.match);
  if (!match) return tl::unexpected(StartError{Kind::failed, match.error().message});
  if (const auto& group = options.network.multicast) {
    const auto reachable = can_reach(*group, options.network);
    if (!reachable) return tl::unexpected(StartError{Kind::bad_option, reachable.error()});
  }
  auto ports = open_ports(options.network);
  if (!ports) return tl::unexpected(port_error(options.network, ports.error()));
  os::FileDescriptor wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake) {
    return tl::unexpected(StartError{
        Kind::failed, "cannot start the control port: " + std::string(std::strerror(errno)) +
                          "; close other programs and try again"});
  }

  std::unique_ptr<PhonePort> phones;
  if (options.phones.open) {
    auto opened = open_phones(options);
    if (!opened) return tl::unexpected(opened.error());
    phones = std::move(*opened);
  }

  std::unique_ptr<Recorder> recorder;
  if (!options.record.empty()) {
    JournalFileOptions wanted{.path = options.record, .overwrite = options.overwrite};
    if (options.record_by_default_bytes > 0) wanted.max_bytes = options.record_by_default_bytes;
    auto file = JournalFile::create(wanted);
    if (file) {
      recorder = std::make_unique<Recorder>(std::move(*file), header);
    } else if (options.record_by_default_bytes == 0) {
      return tl::unexpected(StartError{Kind::bad_option, file.error()});
    } else {
      options.log(LogLevel::warning, file.error());
      options.record.clear();
    }
  }
  return std::unique_ptr<Server>(
      new Server(std::make_unique<Impl>(std::move(options), std::move(*match), std::move(*ports),
                                        std::move(wake), std::move(recorder), std::move(phones))));
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Server::~Server() {
  finish(wire::make_sentence<wire::SentenceId::server_ends>());
}

void Server::add_device(std::unique_ptr<cabinet::Device> device) {
  impl_->desk.add_device(std::move(device));
}

void Server::set_cabinet_haptics(std::unique_ptr<cabinet::HapticSink> sink) {
  impl_->haptics.to_cabinet(sink.get());
  impl_->cabinet_haptics = std::move(sink);
}

void Server::tick(std::int64_t now_us) {
  Impl& s = *impl_;
  const std::int64_t began_ns = os::monotonic_ns();  // for measurement only
  s.tick_us = now_us;
  s.take_control_events();
  s.broadcaster.expect();
  if (s.gather(now_us)) {
    step_recorded(s.match, s.next);
    ++s.ticks;
    s.events.add(s.match.events());
    s.broadcast(now_us, began_ns);  // first, to minimise latency
    if (!s.options.replay) s.haptics.feel(s.match.events(), s.match.view(), s.desk, now_us);
    if (s.recorder) s.recorder->add(s.next, s.match);
    const foosball::MatchView& view = s.match.view();
    if (view.screen == foosball::Screen::play && !view.attract) s.was_played = s.playing = true;
    // A demonstration match, or choosing characters, does not end a match.
    if (view.screen == foosball::Screen::logo && std::exchange(s.playing, false))
      s.control.match_is_over();
    if (s.results) s.keep_result();
  } else {
    s.broadcast(now_us, began_ns);
  }
  s.watch_journal();
  s.watch_results();
  s.send_report();
  s.watch_sending();
  s.watch_tuning();
  s.watch_game();
  s.show_devices(now_us);
}

void Server::wait_sent() {
  impl_->broadcaster.wait_sent();
}

void Server::warn(Topic topic, const wire::Sentence& text) {
  impl_->notify(topic, text);
}

void Server::clear(Topic topic, const std::string& text) {
  impl_->notify(topic, {}, text);
}

void Server::finish(const wire::Sentence& reason) {
  if (impl_->finished) return;
  impl_->finished = true;
  impl_->broadcaster.close();  // sends the last snapshot before the Bye
  impl_->control.stop(reason);
  if (impl_->phones) impl_->phones->stop();  // sends them the reason
  if (impl_->recorder) impl_->recorder->finish(impl_->match);
  if (impl_->recorder && impl_->options.record_by_default_bytes > 0 && !impl_->was_played)
    ::unlink(impl_->options.record.c_str());
  if (impl_->results) impl_->results->close();
}

std::uint16_t Server::port() const {
  return impl_->port;
}
std::string Server::phones() const {
  return impl_->phones ? impl_->phones->url() : std::string{};
}
const foosball::Match& Server::match() const {
  return impl_->match;
}
bool Server::replay_over() const {
  return impl_->replay_over;
}
const Playback* Server::replay() const {
  return impl_->options.replay.get();
}
int Server::clients() const {
  return static_cast<int>(impl_->clients.size());
}
std::uint64_t Server::clients_ever() const {
  return impl_->clients_ever;
}
std::uint64_t Server::ticks() const {
  return impl_->ticks;
}

std::string Server::journal_problem() const {
  return impl_->recorder ? impl_->recorder->file().problem().text() : std::string{};
}

std::string Server::results_problem() const {
  return impl_->results ? impl_->results->problem() : std::string{};
}

Counters Server::counters() const {
  const Impl& s = *impl_;
  Counters out;
  out.ticks = s.ticks;
  out.snapshots_sent = s.broadcaster.sent();
  out.snapshot_bytes = s.broadcaster.bytes();
  out.send_errors = s.broadcaster.errors();
  out.last_send_error = s.broadcaster.last_error();
  out.events_dropped = s.events.dropped();
  out.match_events_dropped = s.match.view().events_dropped;
  if (s.recorder) {
    out.journal_bytes = s.recorder->file().bytes_written();
    out.journal_dropped = s.recorder->file().entries_dropped();
  }
  if (s.results) {
    out.results_kept = s.results->kept();
    out.answers_kept = s.results->answers();
  }
  out.input = s.input.counters();
  out.control = s.control.counters();
  if (s.phones) out.phones = s.phones->counters();
  out.haptic_pulses = s.haptics.pulses();
  return out;
}

std::vector<DeviceCounters> Server::devices() const {
  std::vector<DeviceCounters> out;
  for (const auto& device : impl_->desk.devices()) {
    out.push_back({device->name(), device->counters()});
  }
  return out;
}

const SendStats& Server::sending() const {
  return impl_->broadcaster.stats();
}

}  // namespace server
