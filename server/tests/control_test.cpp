// The control port on real sockets: joining, untrusted clients, and messages to clients.
#include <sys/resource.h>

#include <bit>
#include <random>

#include "control_fixture.h"
#include "seats.h"

namespace server {
namespace {

// The server runs and accepts a new client.
void expect_alive(Lockstep& table) {
  ProbeClient client(table.port());
  EXPECT_TRUE(client.join().has_value());
  table.tick();
  EXPECT_TRUE(client.snapshot().has_value());
}

TEST(Control, WelcomesAClientWithItsSessionAndPorts) {
  Lockstep table;
  ProbeClient client(table.port());
  const auto welcome = client.join(1);
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->session, Lockstep::kSession);
  EXPECT_EQ(welcome->udp_port, table.port());
  EXPECT_EQ(welcome->team, 1);
  EXPECT_NE(welcome->token, 0u);
  table.tick();
  EXPECT_EQ(table->clients(), 1);
}

TEST(Control, RefusesAnotherVersionAndAnotherLayout) {
  Lockstep table;
  for (const bool version : {true, false}) {
    ProbeClient client(table.port());
    wire::Hello hello = client.hello();
    if (version) hello.version = wire::kControlVersion + 1;
    if (!version) hello.snapshot_layout ^= 1;
    client.send(hello);
    const auto refusal = client.receive_a<wire::Refusal>();
    ASSERT_TRUE(refusal);
    EXPECT_EQ(refusal->code, version ? Code::version : Code::layout);
    EXPECT_NE(refusal->reason.find("use the same release"), std::string::npos);
    EXPECT_TRUE(client.sees_close());
  }
  EXPECT_EQ(table->counters().control.refused, 2u);
  expect_alive(table);
}

TEST(Control, GivesATeamToOneClientUntilItLeaves) {
  Lockstep table;
  ProbeClient first(table.port()), second(table.port());
  ASSERT_TRUE(first.join(0));
  second.send(second.hello(0));
  const auto refusal = second.receive_a<wire::Refusal>();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, Code::team_taken);

  first.leave();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.left == 1; }));
  ProbeClient third(table.port());
  const auto welcome = third.join(0);
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->team, 0);
}

TEST(Control, RefusesATeamThatDoesNotExist) {
  Lockstep table;
  ProbeClient client(table.port());
  client.send(client.hello(2));
  EXPECT_TRUE(client.sees_close());
  EXPECT_EQ(table->counters().control.bad_messages, 1u);
  expect_alive(table);
}

TEST(Control, ClosesAnOversizedMessageBeforeItsBodyComes) {
  Lockstep table;
  ProbeClient client(table.port());
  const std::array<std::byte, 4> length{std::byte{1}, std::byte{0}, std::byte{1}, std::byte{0}};
  client.send_raw(length);  // 65537 bytes announced
  const auto refusal = client.receive_a<wire::Refusal>();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, Code::bad_message);
  EXPECT_TRUE(client.sees_close());
  EXPECT_EQ(table->counters().control.bad_messages, 1u);
  expect_alive(table);
}

// Random bytes, and every Hello with one flipped bit: each connection ends or was a valid Hello.
TEST(Control, SurvivesGarbageAndTurnedBits) {
  Lockstep table([](ServerOptions& o) { o.limits.hello_us = 20'000; });
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) {
    ProbeClient client(table.port());
    ASSERT_TRUE(client.connected());
    std::vector<std::byte> bytes = bytes_of(client.hello());
    if (i % 2 == 0) {
      for (std::byte& b : bytes) b = std::byte(random());
    } else {
      bytes[random() % bytes.size()] ^= std::byte(1u << random() % 8);
    }
    client.send_raw(bytes);
    const auto answer = client.receive();
    if (!answer || !std::holds_alternative<wire::Welcome>(*answer)) {
      EXPECT_TRUE(client.sees_close()) << i;
    }
  }
  const ControlCounters c = table->counters().control;
  EXPECT_EQ(c.joined + c.refused + c.bad_messages + c.timed_out, 60u);
  EXPECT_GE(c.bad_messages, 30u);
  expect_alive(table);
}

TEST(Control, CountsAHelloThatIsCutShort) {
  Lockstep table;
  const std::size_t whole = bytes_of(ProbeClient(table.port()).hello()).size();
  std::uint64_t cut = 0;
  for (std::size_t size = 1; size < whole; size += 7, ++cut) {
    ProbeClient client(table.port());
    const auto bytes = bytes_of(client.hello());
    client.send_raw(std::span(bytes).first(size));
    client.leave();
  }
  EXPECT_TRUE(table.tick_until([&] { return table->counters().control.bad_messages == cut; }));
  expect_alive(table);
}

TEST(Control, DropsWhoSaysNothing) {
  Lockstep table([](ServerOptions& o) { o.limits.hello_us = 30'000; });
  ProbeClient silent(table.port());
  EXPECT_TRUE(silent.sees_close());
  EXPECT_EQ(table->counters().control.timed_out, 1u);
  expect_alive(table);
}

TEST(Control, DropsWhoSpeaksOutOfPlace) {
  Lockstep table;
  ProbeClient early(table.port());
  early.send(wire::Ping{1});
  EXPECT_TRUE(early.sees_close());
  ProbeClient twice(table.port());
  ASSERT_TRUE(twice.join());
  twice.send(twice.hello());
  EXPECT_TRUE(twice.sees_close());
  EXPECT_EQ(table->counters().control.bad_messages, 2u);
  EXPECT_TRUE(table.tick_until([&] { return table->clients() == 0; }));
}

TEST(Control, CapsConnectionsInAllAndPerAddress) {
  Lockstep table([](ServerOptions& o) {
    o.limits.connections = 4;
    o.limits.per_local_address = 3;
  });
  std::vector<ProbeClient> inside;
  for (int i = 0; i < 3; ++i) {
    inside.emplace_back(table.port());
    ASSERT_TRUE(inside.back().join());
  }
  ProbeClient greedy(table.port());
  greedy.send(greedy.hello());
  const auto too_many = greedy.receive_a<wire::Refusal>();
  ASSERT_TRUE(too_many);
  EXPECT_NE(too_many->reason.find("from your address"), std::string::npos);

  ProbeClient neighbour(table.port(), "127.0.0.2");
  EXPECT_TRUE(neighbour.join());
  ProbeClient late(table.port(), "127.0.0.3");
  late.send(late.hello());
  const auto full = late.receive_a<wire::Refusal>();
  ASSERT_TRUE(full);
  EXPECT_EQ(full->code, Code::full);
  EXPECT_EQ(table->counters().control.refused, 2u);
}

TEST(Control, AnswersAPing) {
  Lockstep table;
  ProbeClient client(table.port());
  ASSERT_TRUE(client.join());
  client.send(wire::Ping{77});
  const auto pong = client.receive_a<wire::Pong>();
  ASSERT_TRUE(pong);
  EXPECT_EQ(pong->id, 77u);
}

// The client sends requests and never reads an answer: it is dropped once its buffer is full.
TEST(Control, DropsAClientThatDoesNotRead) {
  Lockstep table([](ServerOptions& o) { o.limits.unsent_bytes = 8 * 1024; });
  ProbeClient slow(table.port());
  ASSERT_TRUE(slow.join(0));
  std::vector<std::byte> pings;
  for (std::uint64_t i = 0; i < 1000; ++i) wire::encode_control(wire::Ping{i}, pings);
  while (slow.send_raw(pings)) {
  }
  EXPECT_TRUE(table.tick_until([&] { return table->counters().control.slow_dropped == 1; }));
  EXPECT_TRUE(table.tick_until([&] { return table->clients() == 0; }));
  expect_alive(table);
}

TEST(Control, HandsRequestsToTheMatchAndCountsThoseThatAreNotAllowed) {
  Lockstep table;
  ProbeClient player(table.port());
  ASSERT_TRUE(player.join(0));
  using Kind = foosball::Command::Kind;
  player.send(
      wire::MatchRequest{static_cast<std::uint8_t>(Kind::push), 1, 0});  // of the other team
  player.send(wire::MatchRequest{static_cast<std::uint8_t>(Kind::push), 0, 0});
  EXPECT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
  const ControlCounters c = table->counters().control;
  EXPECT_EQ(c.requests, 1u);
  EXPECT_EQ(c.requests_dropped, 1u);
}

TEST(Control, LetsAWatcherAtThisMachineMakeRequests) {
  Lockstep table;
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  watcher.send(wire::MatchRequest{static_cast<std::uint8_t>(foosball::Command::Kind::push), 1, 0});
  EXPECT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
}

// A hundred requests at once: as many count as a person could make, the rest are dropped.
TEST(Control, TakesNoMoreRequestsOfAClientThanAHandCanMake) {
  Lockstep table;
  ProbeClient watcher(table.port()), other(table.port());
  ASSERT_TRUE(watcher.join() && other.join());
  const wire::MatchRequest restart{static_cast<std::uint8_t>(foosball::Command::Kind::restart), 0,
                                   0};
  std::vector<std::byte> flood;
  for (int i = 0; i < 100; ++i) wire::encode_control(restart, flood);
  const auto began = std::chrono::steady_clock::now();
  ASSERT_TRUE(watcher.send_raw(flood));
  const auto counted = [&] {
    const ControlCounters c = table->counters().control;
    return c.requests + c.requests_dropped;
  };
  ASSERT_TRUE(table.tick_until([&] { return counted() == 100; }));
  const auto took = std::chrono::steady_clock::now() - began;
  const auto earned = static_cast<std::uint64_t>(took / std::chrono::milliseconds(50)) + 1;
  const std::uint64_t taken = table->counters().control.requests;
  EXPECT_GE(taken, 16u);
  EXPECT_LE(taken, 16u + earned);
  other.send(restart);  // a request of another client
  EXPECT_TRUE(table.wait_until([&] { return table->counters().control.requests > taken; }));
}

// Starts a match in play, as a local watcher.
void start_play(Lockstep& table, ProbeClient& watcher) {
  const auto push = static_cast<std::uint8_t>(foosball::Command::Kind::push);
  for (const std::uint8_t team : std::array<std::uint8_t, 3>{0, 0, 1})
    watcher.send(wire::MatchRequest{push, team, 0});
  ASSERT_TRUE(
      table.tick_until([&] { return table->match().view().screen == foosball::Screen::play; }));
}

TEST(Control, APauseEndsWhenTheLastPlayerLeaves) {
  Lockstep table;
  ProbeClient watcher(table.port()), first(table.port()), second(table.port());
  ASSERT_TRUE(watcher.join() && first.join(0) && second.join(1));
  start_play(table, watcher);
  const auto paused = [&] { return table->match().view().paused; };
  first.send(wire::MatchRequest{static_cast<std::uint8_t>(foosball::Command::Kind::pause), 0, 1});
  ASSERT_TRUE(table.tick_until(paused));
  first.leave();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 2; }));
  table.tick(3);
  EXPECT_TRUE(paused()) << "another player is there, who may go on with it";
  second.leave();
  EXPECT_TRUE(table.tick_until([&] { return !paused(); }));
}

TEST(Control, AHostsPauseOutlastsThePlayers) {
  Lockstep table;
  ProbeClient host(table.port()), player(table.port());
  ASSERT_TRUE(host.join() && player.join(0));
  start_play(table, host);
  const auto paused = [&] { return table->match().view().paused; };
  const std::uint64_t requests = table->counters().control.requests;
  host.send(wire::MatchRequest{static_cast<std::uint8_t>(foosball::Command::Kind::pause), 0, 1});
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.requests > requests; }));
  table.tick(2);
  ASSERT_TRUE(paused());
  player.send_goodbye();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 1; }));
  table.tick(3);
  EXPECT_TRUE(paused());
  host.send_goodbye();
  EXPECT_TRUE(table.tick_until([&] { return !paused(); }));
}

TEST(Control, APauseEndsWhenTheLastWatcherLeavesAnExhibition) {
  Lockstep table;
  ProbeClient watcher(table.port()), another(table.port());
  ASSERT_TRUE(watcher.join() && another.join());
  start_play(table, watcher);
  const auto paused = [&] { return table->match().view().paused; };
  watcher.send(wire::MatchRequest{static_cast<std::uint8_t>(foosball::Command::Kind::pause), 0, 1});
  ASSERT_TRUE(table.tick_until(paused));
  watcher.leave();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 1; }));
  table.tick(3);
  EXPECT_TRUE(paused());
  another.leave();
  EXPECT_TRUE(table.tick_until([&] { return !paused(); }));
}

TEST(Control, ADepartedPlayersTokenDrivesNothing) {
  Lockstep table;
  ProbeClient first(table.port()), second(table.port());
  const auto old = first.join(0);
  ASSERT_TRUE(old);
  table.tick();
  first.leave();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 0; }));
  ASSERT_TRUE(second.join(0));
  wire::InputDatagram input;
  input.session = old->session;
  input.token = old->token;
  input.sequence = 1;
  for (auto& rod : input.rods) rod = {true, 0.05f, 0.0f, 0.0f, 0.0f};
  ASSERT_TRUE(second.send_input(input));
  EXPECT_TRUE(table.tick_until([&] { return table->counters().input.foreign == 1; }));
  EXPECT_EQ(table->counters().input.accepted, 0u);
}

TEST(Control, TellsEveryoneANoticeAndThoseWhoJoinLaterUntilItIsCleared) {
  Lockstep table;
  ProbeClient first(table.port());
  ASSERT_TRUE(first.join());
  table->warn(Server::Topic::overload, wire::Sentence::untranslated("slow"));
  const auto reported = first.receive_a<wire::Notice>();
  ASSERT_TRUE(reported);
  EXPECT_EQ(reported->text, "slow");

  ProbeClient second(table.port());
  ASSERT_TRUE(second.join());
  EXPECT_EQ(second.receive_a<wire::Notice>().value_or(wire::Notice{}).text, "slow");

  table->clear(Server::Topic::overload, "fast again");
  const auto cleared = first.receive_a<wire::Notice>();
  ASSERT_TRUE(cleared);
  EXPECT_EQ(cleared->level, wire::Notice::Level::cleared);
  ProbeClient third(table.port());
  ASSERT_TRUE(third.join());
  third.send(wire::Ping{1});
  const auto answer = third.receive();  // no notice in between
  ASSERT_TRUE(answer);
  EXPECT_TRUE(std::holds_alternative<wire::Pong>(*answer));
}

TEST(Control, SaysByeBeforeItEnds) {
  Lockstep table;
  ProbeClient client(table.port());
  ASSERT_TRUE(client.join());
  table->finish(wire::Sentence::untranslated("closing time"));
  const auto bye = client.receive_a<wire::Bye>();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->reason, "closing time");
  EXPECT_TRUE(client.sees_close());
}

// Nobody's Bye waits until those before have acknowledged theirs, which takes them up to 40 ms
// each.
TEST(Control, SaysByeToEachOfMany) {
  constexpr int kClients = 16;
  Lockstep table;
  std::vector<ProbeClient> clients;
  for (int i = 0; i < kClients; ++i) {
    clients.emplace_back(table.port());
    ASSERT_TRUE(clients.back().join());
  }
  table->finish(wire::Sentence::untranslated("closing time"));
  for (ProbeClient& client : clients) {
    const auto bye = client.receive_a<wire::Bye>();
    ASSERT_TRUE(bye);
    EXPECT_EQ(bye->reason, "closing time");
  }
}

// Limits the descriptors to those open now, plus a number.
class DescriptorLimit {
 public:
  explicit DescriptorLimit(rlim_t more) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const int lowest_free = ::dup(0);
    ::close(lowest_free);
    const rlimit limit{static_cast<rlim_t>(lowest_free) + more, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &limit);
  }
  ~DescriptorLimit() { ::setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
};

TEST(Control, StartsWholeOrSaysWhyNotHoweverFewDescriptorsAreLeft) {
  const std::string journal = temp_path("journal");
  const auto record = [&](ServerOptions& o) {
    o.record = journal;
    o.overwrite = true;
  };
  // First without a limit: a sanitizer's first use of a class takes descriptors of its own.
  Lockstep(record).started();
  int more = 0;
  for (; more < 20; ++more) {
    auto limit = std::make_unique<DescriptorLimit>(more);
    Lockstep table(record);
    limit.reset();
    if (table.started()) {
      expect_alive(table);
      break;
    }
    EXPECT_FALSE(table.error().sentence.empty()) << more;
  }
  ::unlink(journal.c_str());
  // Two ports, the control thread's and the journal's wake-up, the journal's file.
  EXPECT_EQ(more, 5);
}

TEST(Control, SaysWhichPortIsInUseAndWhatToDo) {
  Lockstep table;
  Lockstep second([&](ServerOptions& o) { o.network.port = table.port(); });
  ASSERT_FALSE(second.started());
  EXPECT_EQ(second.error().kind, StartError::Kind::port_taken);
  EXPECT_NE(second.error().sentence.find(std::to_string(table.port())), std::string::npos);
  EXPECT_NE(second.error().sentence.find("--port"), std::string::npos);
}

}  // namespace
}  // namespace server
