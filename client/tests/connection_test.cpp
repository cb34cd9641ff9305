// The connection against real sockets: joining, bad bytes, silence, loss and return.
#include "client/connection.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <functional>
#include <future>

#include "os/clock.h"
#include "os/socket_address.h"
#include "scripted_scene.h"
#include "scripted_server.h"
#include "wire/limits.h"

namespace client {
namespace {

// Polls until the condition holds. It waits for an event of another thread, with a distant
// deadline.
bool eventually(const std::function<bool()>& holds) {
  const std::int64_t deadline = os::monotonic_us() + 10'000'000;
  while (!holds()) {
    if (os::monotonic_us() > deadline) return false;
    poll(nullptr, 0, 1);
  }
  return true;
}

ConnectionOptions options_for(std::uint16_t port) {
  ConnectionOptions options;
  options.port = port;
  options.team = 0;
  options.name = "tester";
  return options;
}

wire::Snapshot snapshot(std::uint64_t session, std::uint64_t tick) {
  wire::Snapshot s = scripted_play(static_cast<double>(tick) * 1e-3);
  s.session = session;
  s.tick = tick;
  s.sequence = tick + 1;
  return s;
}

class ConnectionTest : public ::testing::Test {
 protected:
  void open() {
    options.port = server.port();
    auto opened = Connection::open(options);
    ASSERT_TRUE(opened) << opened.error();
    connection = std::move(*opened);
    connection->start();
  }
  void join(std::uint64_t session) {
    ASSERT_TRUE(server.welcome(session));
    ASSERT_TRUE(eventually([&] { return connection->status().link == Link::joined; }));
  }
  bool receives(std::uint64_t session, std::uint64_t tick) {
    const auto before = connection->counters().received;
    return eventually([&] {
      server.send_snapshot(snapshot(session, tick++));
      return connection->counters().received > before;
    });
  }
  // Between the two snapshots the listening thread has checked what to send. A repetition is due 45
  // ms after the last input; a loss and a return take longer, so it would have been sent.
  bool receives_twice(std::uint64_t session) {
    return receives(session, 20'000) && receives(session, 30'000);
  }
  ScriptedServer server;
  ConnectionOptions options = options_for(0);
  std::unique_ptr<Connection> connection;
};

TEST_F(ConnectionTest, SaysHelloWithItsLayoutAndPortAndHearsSnapshots) {
  open();
  join(42);
  EXPECT_EQ(server.hello().snapshot_layout, wire::snapshot_layout_hash());
  EXPECT_EQ(server.hello().team, 0);
  EXPECT_EQ(server.hello().name, "tester");
  EXPECT_NE(server.hello().udp_port, 0);
  EXPECT_TRUE(receives(42, 0));
  EXPECT_TRUE(connection->sample(os::monotonic_us()).any);
}

TEST_F(ConnectionTest, BadForeignAndRepeatedDatagramsAreEachCounted) {
  open();
  join(42);
  ASSERT_TRUE(receives(42, 0));
  const std::vector<std::byte> noise(300, std::byte{0x5A}), oversized(4000, std::byte{1});
  server.send_datagram(noise);
  server.send_datagram({});
  server.send_datagram(oversized);
  auto turned = server.sealed(snapshot(42, 1));
  turned.back() ^= std::byte{1};
  server.send_datagram(turned);
  server.send_snapshot(snapshot(42, 0));
  EXPECT_TRUE(eventually([&] {
    const SnapshotCounters c = connection->counters();
    return c.bad == 3 && c.foreign == 1 && c.old == 1;
  }));
  EXPECT_EQ(connection->status().link, Link::joined);
}

TEST_F(ConnectionTest, AServerThatTalksNonsenseIsLeftAndTriedAgain) {
  open();
  ASSERT_TRUE(server.accept());
  const std::vector<std::byte> nonsense(64, std::byte{0xFF});  // a length far above the limit
  server.send_bytes(nonsense);
  EXPECT_TRUE(
      eventually([&] { return connection->status().detail == "it sends invalid messages"; }));
  join(42);
}

TEST_F(ConnectionTest, AGapIsNoticedAndCostsNoSeat) {
  open();
  join(42);
  ASSERT_TRUE(receives(42, 0));
  const std::int64_t silent_since = os::monotonic_us();
  ASSERT_TRUE(eventually([&] { return connection->status().link == Link::lost; }));
  EXPECT_GE(os::monotonic_us() - silent_since, 450'000);
  EXPECT_TRUE(connection->sample(os::monotonic_us()).any);  // the last scene stays
  ASSERT_TRUE(receives(42, 600));                           // the link is back
  EXPECT_TRUE(eventually([&] { return connection->status().link == Link::joined; }));
  EXPECT_EQ(connection->status().joins, 1u) << "the connection was never let go";
}

TEST_F(ConnectionTest, ALongSilenceIsTheEndOfAConnectionAndTheSeatIsAskedForAgain) {
  options.silence_us = 50'000;
  options.gone_us = 100'000;
  open();
  ASSERT_TRUE(server.welcome(42, 77));
  const wire::Hello first = server.hello();
  EXPECT_EQ(first.ticket, 0u);
  ASSERT_TRUE(server.welcome(42, 77));  // answers the next attempt
  EXPECT_EQ(server.hello().session, 42u);
  EXPECT_EQ(server.hello().ticket, 77u);
  EXPECT_TRUE(eventually([&] { return connection->status().joins == 2; }));
}

// Each of these once froze the picture permanently, or could have.
TEST_F(ConnectionTest, NoForgedDatagramMovesTheScene) {
  open();
  join(42);
  ASSERT_TRUE(receives(42, 1000));
  ScriptedServer attacker;  // separate sockets: another address
  const auto forge = [&](const ScriptedServer& from, std::span<const std::byte> bytes) {
    const auto to = os::loopback(server.hello().udp_port);
    ::sendto(from.udp(), bytes.data(), bytes.size(), 0, to.generic(), to.size());
  };
  wire::Snapshot far = snapshot(42, wire::kMaxTick);
  far.sequence = ~std::uint64_t{0};
  std::array<std::byte, wire::kMaxDatagram> plain;
  const auto unsealed = std::span<const std::byte>(plain).first(wire::encode_snapshot(far, plain));
  std::vector<std::byte> wrong_key(unsealed.size() + wire::kSealBytes);
  wire::seal_datagram(wire::SealKey{}, server.said().client, ~std::uint64_t{0}, unsealed,
                      wrong_key);
  const auto replayed = server.sealed(snapshot(42, 1900));
  // From another address nothing is accepted, not even a correctly sealed snapshot.
  forge(attacker, unsealed);
  forge(attacker, wrong_key);
  forge(attacker, server.sealed(far));
  // From the server's address and port, as an attacker can forge any source.
  forge(server, unsealed);
  forge(server, wrong_key);
  forge(server, replayed);
  for (int i = 0; i < 10; ++i) forge(server, replayed);
  ASSERT_TRUE(eventually([&] { return connection->counters().old >= 10; }));
  const SnapshotCounters after = connection->counters();
  EXPECT_EQ(after.bad + after.foreign, 2u);
  EXPECT_EQ(after.implausible, 0u);
  // A faulty server, or a member of the group: a jump that no later snapshot confirms.
  server.send_snapshot(far);
  ASSERT_TRUE(eventually([&] { return connection->counters().implausible == 1; }));
  EXPECT_TRUE(receives(42, 1901));
  const auto scene = connection->sample(os::monotonic_us());
  EXPECT_LT(scene.state.tick, 3000u);
}

TEST_F(ConnectionTest, AFloodFromElsewhereCostsTheListenerNothing) {
  open();
  join(42);
  ASSERT_TRUE(receives(42, 0));
  const ScriptedServer attacker;
  const std::vector<std::byte> garbage(700, std::byte{0x5A});
  const auto to = os::loopback(server.hello().udp_port);
  for (int i = 0; i < 20'000; ++i) {
    ::sendto(attacker.udp(), garbage.data(), garbage.size(), 0, to.generic(), to.size());
  }
  ASSERT_TRUE(receives(42, 500));
  const SnapshotCounters c = connection->counters();
  EXPECT_EQ(c.bad + c.foreign, 0u);
}

TEST_F(ConnectionTest, AServerThatDiesAndReturnsWithANewSessionIsJoinedAgain) {
  const std::uint16_t port = server.port();
  open();
  join(42);
  ASSERT_TRUE(receives(42, 9000));
  server.drop_client();
  ASSERT_TRUE(eventually([&] { return connection->status().link == Link::lost; }));
  ASSERT_EQ(server.port(), port);
  join(43);
  EXPECT_TRUE(receives(43, 0));
  EXPECT_TRUE(
      eventually([&] { return connection->sample(os::monotonic_us()).state.session == 43; }));
  EXPECT_EQ(connection->status().joins, 2u);
  server.send_snapshot(snapshot(42, 9100));  // a late datagram of the dead session
  EXPECT_TRUE(eventually([&] { return connection->counters().foreign == 1; }));
}

TEST_F(ConnectionTest, ARefusalIsKeptForTheScreen) {
  open();
  ASSERT_TRUE(server.accept());
  ASSERT_TRUE(server.next_message());
  wire::Refusal refusal;
  refusal.code = wire::Refusal::Code::team_taken;
  refusal.reason = "Team 0 is taken: join with --team 1.";
  server.send(refusal);
  EXPECT_TRUE(eventually([&] { return connection->status().link == Link::refused; }));
  EXPECT_EQ(connection->status().detail, refusal.reason);
}

TEST_F(ConnectionTest, NoticesStandUntilCleared) {
  open();
  join(42);
  wire::Notice notice;
  notice.level = wire::Notice::Level::warning;
  notice.topic = 9;
  notice.text = "cabinet unplugged: rods 1-8 hold";
  server.send(notice);
  ASSERT_TRUE(eventually([&] { return connection->notices().size() == 1; }));
  EXPECT_EQ(connection->notices()[0].text, notice.text);
  notice.level = wire::Notice::Level::cleared;
  server.send(notice);
  EXPECT_TRUE(eventually([&] { return connection->notices().empty(); }));
}

TEST_F(ConnectionTest, NoticesOfAServerThatWasLostStandNoMore) {
  open();
  join(42);
  server.send(wire::Notice{wire::Notice::Level::warning, 1, "the server cannot keep up"});
  ASSERT_TRUE(eventually([&] { return connection->notices().size() == 1; }));
  server.drop_client();
  ASSERT_TRUE(eventually([&] { return connection->status().link == Link::lost; }));
  EXPECT_TRUE(connection->notices().empty());
}

TEST_F(ConnectionTest, InputsCarrySessionAndTokenCountUpAndAreRepeated) {
  open();
  join(42);
  std::array<wire::InputRod, 8> rods{};
  rods[3] = {true, 0.02f, 1.0f, 0.5f, 4.0f};
  connection->drive(42, rods);
  const auto first = server.next_input();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->session, 42u);
  EXPECT_EQ(first->token, 11u);
  EXPECT_TRUE(first->rods[3].driven);
  EXPECT_FALSE(first->rods[2].driven);
  EXPECT_NEAR(first->rods[3].slide, 0.02f, 1e-4f);
  const auto again = server.next_input();  // without input: still at least 20 a second
  ASSERT_TRUE(again);
  EXPECT_GT(again->sequence, first->sequence);
  EXPECT_NEAR(again->rods[3].slide, 0.02f, 1e-4f);
  EXPECT_EQ(again->rods[3].slide_rate, 0.0f);
}

TEST_F(ConnectionTest, NothingOfAnOldMatchReachesANewServer) {
  open();
  join(42);
  std::array<wire::InputRod, 8> old_rods{}, new_rods{};
  old_rods[3] = {true, 0.05f, 2.0f, 0.5f, 4.0f};
  new_rods[5] = {true, -0.02f, 0.0f, 0.0f, 0.0f};
  connection->drive(42, old_rods);
  ASSERT_TRUE(server.next_input());
  server.drop_client();
  ASSERT_TRUE(eventually([&] { return connection->status().link == Link::lost; }));
  const std::uint64_t sent = connection->inputs_sent();
  join(43);
  connection->drive(42, old_rods);  // a window that does not know of the new match yet
  connection->request(42, {0, 0, 0});
  ASSERT_TRUE(receives_twice(43));
  EXPECT_EQ(connection->inputs_sent(), sent);
  server.forget_inputs();
  connection->request(43, {2, 0, 1});
  connection->drive(43, new_rods);
  const auto input = server.next_input();
  ASSERT_TRUE(input);
  EXPECT_EQ(input->session, 43u);
  EXPECT_FALSE(input->rods[3].driven);
  EXPECT_TRUE(input->rods[5].driven);
  const auto request = server.next_message();
  ASSERT_TRUE(request && std::holds_alternative<wire::MatchRequest>(*request));
  EXPECT_EQ(std::get<wire::MatchRequest>(*request).kind, 2);
}

TEST_F(ConnectionTest, AServerJoinedAgainGetsNoInputUntilTheHandMovesAnew) {
  open();
  join(42);
  std::array<wire::InputRod, 8> rods{};
  rods[3] = {true, 0.05f, 2.0f, 0.5f, 4.0f};
  connection->drive(42, rods);
  ASSERT_TRUE(server.next_input());
  server.drop_client();
  ASSERT_TRUE(eventually([&] { return connection->status().link == Link::lost; }));
  const std::uint64_t sent = connection->inputs_sent();
  join(42);
  ASSERT_TRUE(receives_twice(42));
  EXPECT_EQ(connection->inputs_sent(), sent);
  server.forget_inputs();
  connection->drive(42, rods);  // unchanged input: still sent
  EXPECT_TRUE(server.next_input());
}

TEST_F(ConnectionTest, RequestsAndGoodByeReachTheServer) {
  open();
  join(42);
  connection->request(42, {2, 0, 1});
  const auto request = server.next_message();
  ASSERT_TRUE(request && std::holds_alternative<wire::MatchRequest>(*request));
  EXPECT_EQ(std::get<wire::MatchRequest>(*request).kind, 2);
  connection.reset();
  const auto bye = server.next_message();
  EXPECT_TRUE(bye && std::holds_alternative<wire::Bye>(*bye));
}

TEST_F(ConnectionTest, TheGameIsHeardAndAskedForInItsSessionAlone) {
  open();
  join(42);
  EXPECT_FALSE(connection->game());
  wire::Game game;
  game.goals = 5;
  server.send(game);
  ASSERT_TRUE(eventually([&] { return connection->game() == game; }));
  wire::Game training;
  training.mode = 1;
  connection->choose(41, game);  // a window that does not know of the new match yet
  connection->choose(42, training);
  const auto asked = server.next_message();
  ASSERT_TRUE(asked && std::holds_alternative<wire::Game>(*asked));
  EXPECT_EQ(std::get<wire::Game>(*asked), training);
  server.drop_client();
  EXPECT_TRUE(eventually([&] { return !connection->game(); }));
}

// The server's kernel accepts no more data: Bye waits at the client, where a reset would discard
// it.
TEST_F(ConnectionTest, TheGoodByeReachesAServerThatReadsLate) {
  server.take_little();
  open();
  join(42);
  constexpr int kRequests = 5000;
  for (int i = 0; i < kRequests; ++i) connection->request(42, {2, 0, 1});
  std::vector<std::byte> pongs;
  while (pongs.size() < 100'000) wire::encode_control(wire::Pong{1}, pongs);
  server.send_bytes(pongs);  // not all read at the end
  auto end = std::async(std::launch::async, [this] { connection.reset(); });
  end.wait_for(std::chrono::milliseconds(20));  // a client that does not wait is gone by then
  int requests = 0;
  std::optional<wire::ControlMessage> message;
  while ((message = server.next_message()) && std::holds_alternative<wire::MatchRequest>(*message))
    ++requests;
  end.wait();
  EXPECT_TRUE(message && std::holds_alternative<wire::Bye>(*message)) << requests;
}

TEST_F(ConnectionTest, APingIsAnswered) {
  open();
  join(42);
  server.send(wire::Ping{99});
  const auto pong = server.next_message();
  ASSERT_TRUE(pong && std::holds_alternative<wire::Pong>(*pong));
  EXPECT_EQ(std::get<wire::Pong>(*pong).id, 99u);
}

TEST(Connection, ANameIsLookedUpAtTheOpen) {
  ScriptedServer server;
  ConnectionOptions options = options_for(server.port());
  options.host = "localhost";
  auto connection = Connection::open(options);
  ASSERT_TRUE(connection) << connection.error();
  (*connection)->start();
  ASSERT_TRUE(server.welcome(42));
  EXPECT_TRUE(eventually([&] { return (*connection)->status().link == Link::joined; }));
}

TEST(Connection, OneThatWasNeverStartedEndsToo) {
  auto connection = Connection::open({});
  ASSERT_TRUE(connection) << connection.error();
  EXPECT_EQ((*connection)->status().link, Link::connecting);
  connection->reset();
}

TEST(Connection, AnUnknownHostIsOneSentence) {
  ConnectionOptions options;
  options.host = "no such host";
  const auto connection = Connection::open(options);
  ASSERT_FALSE(connection);
  EXPECT_NE(connection.error().find("--server HOST:PORT"), std::string::npos);
}

}  // namespace
}  // namespace client
