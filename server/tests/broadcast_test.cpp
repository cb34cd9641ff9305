// Snapshots and input datagrams on real sockets.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "lockstep.h"
#include "os/file_descriptor.h"
#include "os/socket_address.h"
#include "wire/device_frame.h"

namespace server {
namespace {

// Receives n snapshots; each must follow the one before.
void expect_in_order(ProbeClient& client, int n) {
  std::uint64_t last = 0;
  for (int i = 0; i < n; ++i) {
    const auto snapshot = client.snapshot();
    ASSERT_TRUE(snapshot) << i;
    if (last != 0) {
      ASSERT_EQ(snapshot->tick, last + 1);
    }
    last = snapshot->tick;
  }
}

TEST(Broadcast, SendsEveryListenerASnapshotForEveryTickInOrder) {
  Lockstep table([](ServerOptions& o) { o.computer = {true, true}; });
  std::vector<ProbeClient> listeners;
  for (int i = 0; i < 10; ++i) {
    listeners.emplace_back(table.port());
    ASSERT_TRUE(listeners.back().join());
  }
  table.tick(500);
  for (ProbeClient& listener : listeners) expect_in_order(listener, 500);
  EXPECT_EQ(table->counters().snapshots_sent, 5000u);
  EXPECT_EQ(table->counters().send_errors, 0u);
  EXPECT_LE(table->counters().snapshot_bytes, 5000u * (wire::kMaxDatagram + wire::kSealBytes));
}

TEST(Broadcast, StopsForWhoHasLeft) {
  Lockstep table;
  ProbeClient stays(table.port()), goes(table.port());
  ASSERT_TRUE(stays.join());
  ASSERT_TRUE(goes.join());
  table.tick(3);
  expect_in_order(goes, 3);
  goes.leave();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 1; }));
  while (wait_readable(goes.udp(), 0)) goes.snapshot(0);
  const std::uint64_t before = table->counters().snapshots_sent;
  table.tick(5);
  EXPECT_EQ(table->counters().snapshots_sent, before + 5);
  EXPECT_FALSE(wait_readable(goes.udp(), 0));
}

TEST(Broadcast, ListenerIsInStepFromTheTickAfterItsWelcome) {
  Lockstep table;
  table.tick(100);
  ProbeClient client(table.port());
  ASSERT_TRUE(client.join());
  table.tick();
  const auto snapshot = client.snapshot();
  ASSERT_TRUE(snapshot);
  EXPECT_EQ(snapshot->tick, 101u);
}

TEST(Broadcast, ReachesAMulticastGroupOnLoopback) {
  const Endpoint group{"239.255.77.1", 47531};
  Lockstep table([&](ServerOptions& o) { o.network.multicast = group; });
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_port = htons(group.port);
  ASSERT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&any), sizeof any), 0);
  ip_mreq membership{};
  ::inet_pton(AF_INET, group.address.c_str(), &membership.imr_multiaddr);
  membership.imr_interface.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(::setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership), 0);

  ProbeClient client(table.port());
  const auto welcome = client.join();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->multicast, group.address);
  EXPECT_EQ(welcome->multicast_port, group.port);
  table.tick();
  ASSERT_TRUE(wait_readable(fd, ProbeClient::kPatienceMs));
  std::array<std::byte, 1500> bytes;
  const ssize_t size = ::recv(fd, bytes.data(), bytes.size(), 0);
  wire::DatagramOpener opener(welcome->snapshot_key, 0);
  std::array<std::byte, wire::kMaxDatagram> plain;
  std::size_t plain_size = 0;
  ASSERT_EQ(opener.open({bytes.data(), static_cast<std::size_t>(size)}, plain, plain_size),
            wire::SealVerdict::good);
  wire::Snapshot snapshot;
  EXPECT_TRUE(wire::decode_snapshot(std::span(plain).first(plain_size), snapshot));
  EXPECT_EQ(snapshot.session, Lockstep::kSession);
  EXPECT_FALSE(wait_readable(client.udp(), 0));  // not twice
  ::close(fd);
}

class InputTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto answer = player.join(0);
    ASSERT_TRUE(answer);
    welcome = *answer;
    table.tick();
  }
  wire::InputDatagram input(std::uint32_t sequence, float slide) const {
    wire::InputDatagram in;
    in.session = welcome.session;
    in.token = welcome.token;
    in.sequence = sequence;
    in.rods[0] = {true, slide, 0.0, 0.0f, 0.0f};
    in.rods[7] = {true, slide, 0.0, 0.0f, 0.0f};  // the other team's
    return in;
  }
  // On loopback a datagram has arrived when sendto() returns.
  InputCounters counters() {
    table.tick();
    return table->counters().input;
  }
  Lockstep table;
  ProbeClient player{table.port()};
  wire::Welcome welcome;
};

TEST_F(InputTest, IsInTheSnapshotOfTheVeryNextTick) {
  table.tick(10);
  while (wait_readable(player.udp(), 0)) player.snapshot(0);
  ASSERT_TRUE(player.send_input(input(1, 0.02f)));
  table.tick();
  const auto snapshot = player.snapshot();
  ASSERT_TRUE(snapshot);
  EXPECT_EQ(snapshot->rods[0].status, 1);  // live
  EXPECT_EQ(snapshot->rods[0].source, 2);  // a client
  EXPECT_GT(snapshot->rods[0].slide_rate, 0.0f);
  EXPECT_EQ(snapshot->rods[7].source, 0);
  // The rod moves to a new driver's position within a second, without a jump.
  for (std::uint32_t i = 2; i < 52; ++i) {
    player.send_input(input(i, 0.02f));
    table.tick(20);
  }
  EXPECT_NEAR(table->match().view().rods[0].slide, 0.02, 5e-4);
  EXPECT_NEAR(table->match().view().rods[7].slide, 0.0, 5e-4);
}

TEST_F(InputTest, CountsAndIgnoresWhatIsOldOrSentTwice) {
  player.send_input(input(5, 0.01f));
  player.send_input(input(4, 0.02f));
  player.send_input(input(5, 0.02f));
  const InputCounters c = counters();
  EXPECT_EQ(c.accepted, 1u);
  EXPECT_EQ(c.stale, 2u);
}

TEST_F(InputTest, CountsAndIgnoresStrangersAndWatchers) {
  ProbeClient watcher(table.port());
  const auto watching = watcher.join();
  ASSERT_TRUE(watching);
  table.tick();
  wire::InputDatagram wrong_token = input(1, 0.1f);
  wrong_token.token ^= 1;
  wire::InputDatagram wrong_session = input(2, 0.1f);
  wrong_session.session ^= 1;
  wire::InputDatagram a_watchers = input(3, 0.1f);
  a_watchers.token = watching->token;
  for (const auto& in : {wrong_token, wrong_session, a_watchers}) player.send_input(in);
  const InputCounters c = counters();
  EXPECT_EQ(c.foreign, 3u);
  EXPECT_EQ(c.accepted, 0u);
}

// All datagrams that an attacker may have, by kind.
std::vector<std::pair<std::string, std::vector<std::byte>>> requests_of_a_stranger(
    ProbeClient& player, const wire::InputDatagram& input) {
  std::vector<std::pair<std::string, std::vector<std::byte>>> all;
  for (const std::size_t size : {0, 1, 2, 8, 15, 16, 17, 24, 32, 40, 64, 120, 200, 512, 1400, 9000})
    all.emplace_back(std::to_string(size) + " bytes", std::vector(size, std::byte{0x5A}));
  std::vector<std::byte> clear(wire::kMaxInputDatagram);
  clear.resize(wire::encode_input(input, clear));
  all.emplace_back("an input in the clear", clear);
  all.emplace_back("a player's sealed input", player.sealed(input));
  auto turned = player.sealed(input);
  turned.back() ^= std::byte{1};
  all.emplace_back("a forged input", turned);
  std::vector<std::byte> snapshot(wire::kMaxDatagram + wire::kSealBytes);
  const ssize_t received = ::recv(player.udp(), snapshot.data(), snapshot.size(), MSG_DONTWAIT);
  EXPECT_GT(received, 0);
  snapshot.resize(static_cast<std::size_t>(std::max<ssize_t>(received, 0)));
  all.emplace_back("a snapshot sent back", snapshot);
  wire::DeviceFrame frame{};
  std::array<std::uint8_t, wire::kDeviceFrameBytes> device{};
  wire::encode_device_frame(frame, device.data());
  const auto bytes = std::as_bytes(std::span(device));
  all.emplace_back("a device frame", std::vector(bytes.begin(), bytes.end()));
  wire::Knock knock;
  wire::Ping ping;
  const wire::Hello hello = player.hello(0);
  for (const wire::ControlMessage& message :
       {wire::ControlMessage(hello), wire::ControlMessage(knock), wire::ControlMessage(ping)}) {
    std::vector<std::byte> control;
    wire::encode_control(message, control);
    all.emplace_back("control message " + std::to_string(message.index()), control);
  }
  return all;
}

// docs/decisions/0040: a datagram with a forged source address cannot flood the owner of that
// address.
TEST_F(InputTest, NoDatagramOfAStrangerIsAnsweredByMoreThanItself) {
  const os::FileDescriptor stranger(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const auto any = os::loopback(0), server = os::loopback(table.port());
  ASSERT_EQ(::bind(stranger.get(), any.generic(), any.size()), 0);
  std::uint64_t sent = 0;
  for (const auto& [what, request] : requests_of_a_stranger(player, input(1, 0.02f))) {
    ASSERT_EQ(::sendto(stranger.get(), request.data(), request.size(), 0, server.generic(),
                       server.size()),
              static_cast<ssize_t>(request.size()))
        << what;
    ++sent;
    const InputCounters c = counters();
    ASSERT_EQ(c.bad + c.foreign, sent) << what << " was read";
    table.tick(5);
    std::size_t answered = 0;
    std::array<std::byte, 65536> bytes;
    for (ssize_t got; (got = ::recv(stranger.get(), bytes.data(), bytes.size(), MSG_DONTWAIT)) > 0;)
      answered += static_cast<std::size_t>(got);
    EXPECT_LE(answered, request.size()) << what;
  }
  EXPECT_EQ(counters().accepted, 0u);
}

TEST_F(InputTest, CountsEveryTruncationTurnedBitAndOversize) {
  const auto good = player.sealed(input(1, 0.02f));
  std::uint64_t refused = 0;
  for (std::size_t cut = 0; cut < good.size(); cut += 3, ++refused) {
    player.send_datagram(std::span(good).first(cut));
  }
  for (std::size_t bit = 0; bit < good.size() * 8; bit += 13, ++refused) {
    auto turned = good;
    turned[bit / 8] ^= std::byte(1u << bit % 8);
    player.send_datagram(turned);
    if (refused % 25 == 0) table.tick();
  }
  const std::vector<std::byte> oversized(1400, std::byte{0x5A});
  player.send_datagram(oversized);
  ++refused;
  table.tick(4);  // a tick reads a limited number
  const InputCounters c = counters();
  EXPECT_EQ(c.bad + c.foreign, refused);  // foreign: a flipped bit in the key's id
  EXPECT_EQ(c.accepted, 0u);
  player.send_datagram(good);
  EXPECT_EQ(counters().accepted, 1u) << "what was refused moved nothing";
}

TEST_F(InputTest, HoldsTheRodsWhenThePlayerVanishesAndLetsTheNextOneTakeThem) {
  player.send_input(input(1, 0.02f));
  table.tick(200);
  player.leave();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 0; }));
  // The rod was still moving to its target of 20 mm, and would move 4 mm further if it did not
  // hold.
  const double where = table->match().view().rods[0].slide;
  EXPECT_LT(where, 0.018);
  table.tick(200);
  EXPECT_NEAR(table->match().view().rods[0].slide, where, 1e-3);

  ProbeClient next(table.port());
  const auto again = next.join(0);
  ASSERT_TRUE(again);
  table.tick();
  wire::InputDatagram in = input(1, -0.02f);
  in.token = again->token;
  next.send_input(in);
  EXPECT_EQ(counters().accepted, 2u);
}

TEST(ComputerPlayers, PlayATeamThatNoPersonHasAndOnlyThen) {
  Lockstep table([](ServerOptions& o) { o.computer = {false, true}; });
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  const auto source_of_rod_7 = [&] {
    while (wait_readable(watcher.udp(), 0)) watcher.snapshot(0);
    table.tick();
    return watcher.snapshot().value_or(wire::Snapshot{}).rods[7].source;
  };
  EXPECT_EQ(source_of_rod_7(), 3);  // computer
  {
    ProbeClient player(table.port());
    ASSERT_TRUE(player.join(1));
    EXPECT_EQ(source_of_rod_7(), 0);  // its player has not moved yet: the rods hold
  }
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 1; }));
  EXPECT_EQ(source_of_rod_7(), 3);
}

}  // namespace
}  // namespace server
