// The real client against the real server: passwords, gaps, cut connections, both address families.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <mutex>
#include <thread>

#include "client/connection.h"
#include "client/player_input.h"
#include "os/clock.h"
#include "os/file_descriptor.h"
#include "os/socket_address.h"
#include "server/server.h"
#include "wire/enums.h"

namespace end_to_end {
namespace {

using client::Connection;
using client::Link;

bool eventually(const std::function<bool()>& holds) {
  const std::int64_t deadline = os::monotonic_us() + 20'000'000;
  while (!holds()) {
    if (os::monotonic_us() > deadline) return false;
    ::poll(nullptr, 0, 1);
  }
  return true;
}

// A server on a thread that ticks about once a millisecond, unless paused by hold().
class Table {
 public:
  explicit Table(const std::function<void(server::ServerOptions&)>& change) {
    server::ServerOptions options;
    options.session = 0x7AB1E;
    options.random = [token = std::uint64_t{1}]() mutable { return token++; };
    change(options);
    auto made = server::Server::create(std::move(options));
    if (!made) {
      ADD_FAILURE() << made.error().sentence;
      return;
    }
    server_ = std::move(*made);
    ticks_ = std::thread([this] { run(); });
  }
  ~Table() {
    stop_ = true;
    if (ticks_.joinable()) ticks_.join();
  }
  std::uint16_t port() const { return server_->port(); }
  void hold(bool held) { held_ = held; }
  foosball::MatchView view() {
    const std::lock_guard guard(mutex_);
    return server_->match().view();
  }
  server::ControlCounters control() {
    const std::lock_guard guard(mutex_);
    return server_->counters().control;
  }

 private:
  void run() {
    while (!stop_) {
      ::poll(nullptr, 0, 1);
      if (held_) continue;
      const std::lock_guard guard(mutex_);
      server_->tick(os::monotonic_us());
    }
  }
  std::mutex mutex_;
  std::unique_ptr<server::Server> server_;
  std::atomic<bool> stop_{false}, held_{false};
  std::thread ticks_;
};

// A relay in the control connection that can be cut; the next connection passes again.
class Cable {
 public:
  explicit Cable(std::uint16_t to) : to_(to), listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const auto any = os::loopback(0);
    EXPECT_EQ(::bind(listener_.get(), any.generic(), any.size()), 0);
    ::listen(listener_.get(), 8);
    thread_ = std::thread([this] { run(); });
  }
  ~Cable() {
    stop_ = true;
    thread_.join();
  }
  std::uint16_t port() const { return os::local_address(listener_.get()).port(); }
  void cut() { cut_ = true; }

 private:
  void run() {
    os::FileDescriptor near, far;
    while (!stop_) {
      std::array<pollfd, 3> polled{{{listener_.get(), POLLIN, 0},
                                    {near ? near.get() : -1, POLLIN, 0},
                                    {far ? far.get() : -1, POLLIN, 0}}};
      ::poll(polled.data(), polled.size(), 5);
      if (cut_.exchange(false)) near.reset(), far.reset();
      if (polled[0].revents != 0) {
        near = os::FileDescriptor(::accept(listener_.get(), nullptr, nullptr));
        far = os::FileDescriptor(::socket(AF_INET, SOCK_STREAM, 0));
        const auto server = os::loopback(to_);
        ::connect(far.get(), server.generic(), server.size());
        continue;
      }
      const auto pass = [&](const pollfd& from, os::FileDescriptor& in, os::FileDescriptor& out) {
        std::array<char, 4096> bytes;
        if (from.revents == 0 || !in) return;
        const ssize_t size = ::recv(in.get(), bytes.data(), bytes.size(), 0);
        if (size <= 0) return near.reset(), far.reset();
        ::send(out.get(), bytes.data(), static_cast<std::size_t>(size), MSG_NOSIGNAL);
      };
      pass(polled[1], near, far);
      pass(polled[2], far, near);
    }
  }
  std::uint16_t to_;
  os::FileDescriptor listener_;
  std::atomic<bool> stop_{false}, cut_{false};
  std::thread thread_;
};

client::ConnectionOptions player_at(std::uint16_t port) {
  client::ConnectionOptions options;
  options.port = port;
  options.team = 0;
  options.name = "Ann";
  return options;
}

std::unique_ptr<Connection> started(const client::ConnectionOptions& options) {
  auto connection = Connection::open(options);
  if (!connection) {
    ADD_FAILURE() << connection.error();
    return nullptr;
  }
  (*connection)->start();
  return std::move(*connection);
}

bool in_play(Connection& connection) {
  return eventually([&] {
    return connection.status().link == Link::joined && connection.sample(os::monotonic_us()).any;
  });
}

void from_afar(server::ServerOptions& o) {
  o.access.trust_this_machine = false;  // loopback stands for another machine
  o.access.password = "open sesame";
  o.access.host_password = "the host's own";
}

TEST(Network, APlayerFromAfarJoinsWithThePasswordSeesAndDrives) {
  Table table(from_afar);
  auto options = player_at(table.port());
  options.trust_this_machine = false;
  options.password = "open sesame";
  const auto ann = started(options);
  ASSERT_TRUE(ann && in_play(*ann));
  EXPECT_EQ(ann->status().welcome.role, number(wire::Role::player));
  std::array<wire::InputRod, 8> rods{};
  rods[0] = {true, 0.02f, 0.0, 0.0f, 0.0f};
  ann->drive(ann->status().welcome.session, rods);
  EXPECT_TRUE(eventually([&] {
    return ann->sample(os::monotonic_us()).state.rods[0].source == number(wire::RodSource::client);
  }));
  ASSERT_TRUE(eventually([&] { return ann->roster().seats.size() == 1; }));
  EXPECT_EQ(ann->roster().seats[0].name, "Ann");
}

TEST(Network, AWrongPasswordIsSaidAndLetsNobodyIn) {
  Table table(from_afar);
  auto options = player_at(table.port());
  options.trust_this_machine = false;
  options.password = "open sesam";
  const auto eve = started(options);
  ASSERT_TRUE(eve);
  ASSERT_TRUE(eventually([&] { return eve->status().link == Link::refused; }));
  EXPECT_NE(eve->status().detail.find("password"), std::string::npos) << eve->status().detail;
  EXPECT_EQ(table.control().joined, 0u);
  options.trust_this_machine = true;  // without any password
  const auto mallory = started(options);
  ASSERT_TRUE(eventually([&] { return mallory->status().link == Link::refused; }));
  EXPECT_NE(mallory->status().detail.find("password is needed"), std::string::npos);
}

TEST(Network, AHostFromAfarIsHost) {
  Table table(from_afar);
  auto options = player_at(table.port());
  options.trust_this_machine = false;
  options.password = "the host's own";
  options.as_host = true;
  const auto host = started(options);
  ASSERT_TRUE(host && in_play(*host));
  EXPECT_EQ(host->status().welcome.role, number(wire::Role::host));
}

// A bug cost the player the team, and a rival took it.
TEST(Network, AGapOf700MsCostsNothing) {
  Table table([](server::ServerOptions&) {});
  const auto ann = started(player_at(table.port()));
  ASSERT_TRUE(ann && in_play(*ann));
  table.hold(true);
  ASSERT_TRUE(eventually([&] { return ann->status().link == Link::lost; }));
  const auto rival = started(player_at(table.port()));
  ASSERT_TRUE(eventually([&] { return rival->status().link == Link::refused; }));
  ::poll(nullptr, 0, 200);  // 0.7 s in total
  table.hold(false);
  ASSERT_TRUE(in_play(*ann));
  EXPECT_EQ(ann->status().joins, 1u);
  EXPECT_EQ(table.control().lost, 0u);
}

TEST(Network, AConnectionThatIsCutIsJoinedAgainToTheSameSeat) {
  Table table([](server::ServerOptions&) {});
  Cable cable(table.port());
  const auto ann = started(player_at(cable.port()));
  ASSERT_TRUE(ann && in_play(*ann));
  const auto before = ann->status().welcome;
  for (std::uint64_t cut = 1; cut <= 3; ++cut) {
    cable.cut();
    ASSERT_TRUE(eventually([&] { return ann->status().joins == cut + 1; }));
    ASSERT_TRUE(in_play(*ann));
  }
  EXPECT_EQ(ann->status().welcome.client, before.client);
  EXPECT_EQ(ann->status().welcome.rods, before.rods);
  EXPECT_EQ(table.control().resumed, 3u);
  EXPECT_EQ(table.control().joined, 1u);
  EXPECT_EQ(table.control().left, 0u);
}

bool has_ipv6() {
  const os::FileDescriptor probe(::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const auto here = *os::parse_address("::1", 0);
  return probe && ::bind(probe.get(), here.generic(), here.size()) == 0;
}

// In attract mode the client must return the rods' computer-driven poses as its targets. Otherwise
// it looks as if a person had touched them.
TEST(Network, AMatchThatIsShownIsNotEndedByAClientWhoseHandRests) {
  Table table([](server::ServerOptions& o) { o.match.rules.attract_seconds = 0.3; });
  const auto ann = started(player_at(table.port()));
  ASSERT_TRUE(ann && in_play(*ann));
  const std::uint64_t session = ann->status().welcome.session;
  client::PlayerInput hand(session, 0, foosball::Layout::tournament);
  double farthest = 0.0;
  const auto shown = [&] {
    const std::int64_t now = os::monotonic_us();
    const auto sample = ann->sample(now);
    hand.update({}, sample.any ? &sample.state : nullptr, now);
    ann->drive(session, hand.rods());
    for (const auto& rod : sample.state.rods)
      if (sample.state.attract) farthest = std::max(farthest, std::fabs(double{rod.slide}));
    return sample.any && sample.state.attract;
  };
  ASSERT_TRUE(eventually(shown));
  const std::int64_t until = os::monotonic_us() + 20'000'000;
  while (farthest < 0.03 && os::monotonic_us() < until) {
    ::poll(nullptr, 0, 2);
    ASSERT_TRUE(shown()) << "after rods had moved by " << farthest << " m";
  }
  EXPECT_GE(farthest, 0.03);
  for (int i = 0; i < 150; ++i) {  // time for a round trip to the server
    ::poll(nullptr, 0, 2);
    ASSERT_TRUE(shown());
  }
}

// Regression: no client could request it. From a person's keys to the serve.
TEST(Network, InTrainingAKeyChoosesTheManToWhomTheBallIsServed) {
  Table table([](server::ServerOptions& o) { o.match.mode = foosball::Mode::training; });
  const auto ann = started(player_at(table.port()));
  ASSERT_TRUE(ann && in_play(*ann));
  const std::uint64_t session = ann->status().welcome.session;
  client::PlayerInput hand(session, 0, foosball::Layout::tournament);
  int served_rod = -1, served_man = -1;
  const auto frame = [&](const client::InputEvents& events) {
    const std::int64_t now = os::monotonic_us();
    const auto sample = ann->sample(now);
    hand.update(events, sample.any ? &sample.state : nullptr, now);
    for (const wire::MatchRequest& request : hand.requests()) ann->request(session, request);
    ann->drive(session, hand.rods());
    for (const wire::EventSnapshot& event : ann->take_events()) {
      if (event.kind != number(wire::EventKind::serve)) continue;
      served_rod = event.rod;
      served_man = event.man;
    }
    return sample.state;
  };
  const auto seen = [&](const std::function<bool(const wire::Snapshot&)>& holds) {
    return eventually([&] { return holds(frame({})); });
  };
  const auto shows = [](wire::Screen screen) {
    return [screen](const wire::Snapshot& s) { return s.screen == number(screen); };
  };
  client::InputEvents push, next_man;
  push.push = true;
  next_man.presses[client::index_of(client::Action::feed)] = 1;
  frame({});
  frame(push);
  ASSERT_TRUE(seen(shows(wire::Screen::selection)));
  frame(push);
  ASSERT_TRUE(seen(shows(wire::Screen::play)));
  const auto& spec = foosball::table_spec(foosball::Layout::tournament);
  client::InputEvents defence;
  defence.choose_line = static_cast<int>(foosball::Line::defence);
  frame(defence);
  for (int man = 0; man < 2; ++man) {
    frame(next_man);
    ASSERT_TRUE(seen([&](const wire::Snapshot& s) {
      return s.feed_rod == hand.active_rod() && s.feed_man == man && s.ball_in_play;
    })) << man;
    ASSERT_TRUE(seen([&](const wire::Snapshot&) {
      return served_rod == hand.active_rod() && served_man == man;
    })) << man;
    EXPECT_EQ(spec.rods[static_cast<std::size_t>(served_rod)].line, foosball::Line::defence);
    EXPECT_EQ(table.view().feed_man, man);
  }
}

TEST(Network, ByIpv6) {
  if (!has_ipv6()) GTEST_SKIP() << "this machine has no IPv6";
  Table table([](server::ServerOptions& o) { o.network.listen = "::1"; });
  auto options = player_at(table.port());
  options.host = "::1";
  const auto ann = started(options);
  ASSERT_TRUE(ann && in_play(*ann));
}

TEST(Network, ByAnAddressOfItsOwnThatIsNoLoopback) {
  if (!has_ipv6()) GTEST_SKIP() << "this machine has no IPv6";
  // The server listens on all addresses; it must answer from the address that the client used.
  Table table([](server::ServerOptions& o) {
    from_afar(o);
    o.network.listen = "::";
  });
  auto options = player_at(table.port());
  options.trust_this_machine = false;
  options.password = "open sesame";
  options.host = "127.0.0.2";
  const auto ann = started(options);
  ASSERT_TRUE(ann && in_play(*ann));
}

TEST(Network, TwoPeopleShareATeam) {
  Table table([](server::ServerOptions&) {});
  const auto ann = started(player_at(table.port()));
  ASSERT_TRUE(ann && in_play(*ann));
  const std::uint8_t all = ann->status().welcome.rods, one = all & -all;
  ann->claim(ann->status().welcome.session, {.rods = one});
  ASSERT_TRUE(eventually([&] {
    const auto seats = ann->roster().seats;
    return seats.size() == 1 && seats[0].rods == one;
  }));
  const auto bob = started(player_at(table.port()));
  ASSERT_TRUE(bob && in_play(*bob));
  EXPECT_EQ(bob->status().welcome.rods, all & ~one);
}

}  // namespace
}  // namespace end_to_end
