// The control port on real sockets: who may join, what a stranger can do, what clients are told.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <bit>
#include <random>

#include "characters/record.h"
#include "door.h"
#include "lockstep.h"
#include "seats.h"

namespace server {
namespace {

using Code = wire::Refusal::Code;

std::vector<std::byte> bytes_of(const wire::ControlMessage& message) {
  std::vector<std::byte> bytes;
  wire::encode_control(message, bytes);
  return bytes;
}

// The server lives and takes a new client.
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
    client.say(hello);
    const auto refusal = client.hear_a<wire::Refusal>();
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
  second.say(second.hello(0));
  const auto refusal = second.hear_a<wire::Refusal>();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, Code::team_taken);

  first.leave();
  ASSERT_TRUE(table.tick_until([&] { return table->counters().control.left == 1; }));
  ProbeClient third(table.port());
  const auto welcome = third.join(0);
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->team, 0);
}

TEST(Control, RefusesATeamThatDoesNotExist) {
  Lockstep table;
  ProbeClient client(table.port());
  client.say(client.hello(2));
  EXPECT_TRUE(client.sees_close());
  EXPECT_EQ(table->counters().control.bad_messages, 1u);
  expect_alive(table);
}

TEST(Control, ClosesAnOversizedMessageBeforeItsBodyComes) {
  Lockstep table;
  ProbeClient client(table.port());
  const std::array<std::byte, 4> length{std::byte{1}, std::byte{0}, std::byte{1}, std::byte{0}};
  client.send_raw(length);  // 65537 bytes announced
  const auto refusal = client.hear_a<wire::Refusal>();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, Code::bad_message);
  EXPECT_TRUE(client.sees_close());
  EXPECT_EQ(table->counters().control.bad_messages, 1u);
  expect_alive(table);
}

// Random bytes, and every Hello with one bit turned: each connection ends or was a Hello after all.
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
    const auto answer = client.hear();
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
  early.say(wire::Ping{1});
  EXPECT_TRUE(early.sees_close());
  ProbeClient twice(table.port());
  ASSERT_TRUE(twice.join());
  twice.say(twice.hello());
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
  greedy.say(greedy.hello());
  const auto too_many = greedy.hear_a<wire::Refusal>();
  ASSERT_TRUE(too_many);
  EXPECT_NE(too_many->reason.find("from your address"), std::string::npos);

  ProbeClient neighbour(table.port(), "127.0.0.2");
  EXPECT_TRUE(neighbour.join());
  ProbeClient late(table.port(), "127.0.0.3");
  late.say(late.hello());
  const auto full = late.hear_a<wire::Refusal>();
  ASSERT_TRUE(full);
  EXPECT_EQ(full->code, Code::full);
  EXPECT_EQ(table->counters().control.refused, 2u);
}

TEST(Control, AnswersAPing) {
  Lockstep table;
  ProbeClient client(table.port());
  ASSERT_TRUE(client.join());
  client.say(wire::Ping{77});
  const auto pong = client.hear_a<wire::Pong>();
  ASSERT_TRUE(pong);
  EXPECT_EQ(pong->id, 77u);
}

// It asks and asks and never reads an answer: dropped once its share of memory is full.
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

TEST(Control, HandsWishesToTheMatchAndCountsThoseThatAreNotAllowed) {
  Lockstep table;
  ProbeClient player(table.port());
  ASSERT_TRUE(player.join(0));
  using Kind = foosball::Command::Kind;
  player.say(wire::Wish{static_cast<std::uint8_t>(Kind::push), 1, 0});  // the other team's
  player.say(wire::Wish{static_cast<std::uint8_t>(Kind::push), 0, 0});
  EXPECT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
  const ControlCounters c = table->counters().control;
  EXPECT_EQ(c.wishes, 1u);
  EXPECT_EQ(c.wishes_dropped, 1u);
}

TEST(Control, LetsAWatcherAtThisMachineWish) {
  Lockstep table;
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  watcher.say(wire::Wish{static_cast<std::uint8_t>(foosball::Command::Kind::push), 1, 0});
  EXPECT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
}

// A hundred wishes at once: the few that a hand could have made count, the rest are dropped.
TEST(Control, TakesNoMoreWishesOfAClientThanAHandCanMake) {
  Lockstep table;
  ProbeClient watcher(table.port()), other(table.port());
  ASSERT_TRUE(watcher.join() && other.join());
  const wire::Wish restart{static_cast<std::uint8_t>(foosball::Command::Kind::restart), 0, 0};
  std::vector<std::byte> flood;
  for (int i = 0; i < 100; ++i) wire::encode_control(restart, flood);
  const auto began = std::chrono::steady_clock::now();
  ASSERT_TRUE(watcher.send_raw(flood));
  const auto counted = [&] {
    const ControlCounters c = table->counters().control;
    return c.wishes + c.wishes_dropped;
  };
  ASSERT_TRUE(table.tick_until([&] { return counted() == 100; }));
  const auto took = std::chrono::steady_clock::now() - began;
  const auto earned = static_cast<std::uint64_t>(took / std::chrono::milliseconds(50)) + 1;
  const std::uint64_t taken = table->counters().control.wishes;
  EXPECT_GE(taken, 16u);
  EXPECT_LE(taken, 16u + earned);
  other.say(restart);  // another client's is not among them
  EXPECT_TRUE(table.tick_until([&] { return table->counters().control.wishes > taken; }));
}

// A match in play, as a local watcher starts it.
void start_play(Lockstep& table, ProbeClient& watcher) {
  const auto push = static_cast<std::uint8_t>(foosball::Command::Kind::push);
  for (const std::uint8_t team : std::array<std::uint8_t, 3>{0, 0, 1})
    watcher.say(wire::Wish{push, team, 0});
  ASSERT_TRUE(
      table.tick_until([&] { return table->match().view().screen == foosball::Screen::play; }));
}

TEST(Control, APauseEndsWhenTheLastPlayerLeaves) {
  Lockstep table;
  ProbeClient watcher(table.port()), first(table.port()), second(table.port());
  ASSERT_TRUE(watcher.join() && first.join(0) && second.join(1));
  start_play(table, watcher);
  const auto paused = [&] { return table->match().view().paused; };
  first.say(wire::Wish{static_cast<std::uint8_t>(foosball::Command::Kind::pause), 0, 1});
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
  host.say(wire::Wish{static_cast<std::uint8_t>(foosball::Command::Kind::pause), 0, 1});
  ASSERT_TRUE(table.tick_until(paused));
  player.say_goodbye();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 1; }));
  table.tick(3);
  EXPECT_TRUE(paused());
  host.say_goodbye();
  EXPECT_TRUE(table.tick_until([&] { return !paused(); }));
}

TEST(Control, APauseEndsWhenTheLastWatcherLeavesAnExhibition) {
  Lockstep table;
  ProbeClient watcher(table.port()), another(table.port());
  ASSERT_TRUE(watcher.join() && another.join());
  start_play(table, watcher);
  const auto paused = [&] { return table->match().view().paused; };
  watcher.say(wire::Wish{static_cast<std::uint8_t>(foosball::Command::Kind::pause), 0, 1});
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
  table->warn(Server::Topic::overload, "slow");
  const auto told = first.hear_a<wire::Notice>();
  ASSERT_TRUE(told);
  EXPECT_EQ(told->text, "slow");

  ProbeClient second(table.port());
  ASSERT_TRUE(second.join());
  EXPECT_EQ(second.hear_a<wire::Notice>().value_or(wire::Notice{}).text, "slow");

  table->clear(Server::Topic::overload, "fast again");
  const auto cleared = first.hear_a<wire::Notice>();
  ASSERT_TRUE(cleared);
  EXPECT_EQ(cleared->level, wire::Notice::Level::cleared);
  ProbeClient third(table.port());
  ASSERT_TRUE(third.join());
  third.say(wire::Ping{1});
  const auto answer = third.hear();  // no notice in between
  ASSERT_TRUE(answer);
  EXPECT_TRUE(std::holds_alternative<wire::Pong>(*answer));
}

TEST(Control, SaysByeBeforeItEnds) {
  Lockstep table;
  ProbeClient client(table.port());
  ASSERT_TRUE(client.join());
  table->finish("closing time");
  const auto bye = client.hear_a<wire::Bye>();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->reason, "closing time");
  EXPECT_TRUE(client.sees_close());
}

// As many descriptors as there are now, and so many more.
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
  // Once with all it wants: a sanitizer's first look at a class takes descriptors of its own.
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

// --- lost and back
// --------------------------------------------------------------------------------

void keep_seats(ServerOptions& o) {
  o.limits.seat_kept_us = 30'000'000;
}

std::string notice_of(ProbeClient& client) {
  return client.hear_a<wire::Notice>().value_or(wire::Notice{}).text;
}

TEST(Seat, OfAPlayerWhoWasLostIsKeptFromRivalsAndTakenAgainWithItsTicket) {
  Lockstep table(keep_seats);
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  auto player = std::make_unique<ProbeClient>(table.port());
  const auto before = player->join(0);
  ASSERT_TRUE(before);
  player->leave();  // the cable is drawn
  EXPECT_NE(notice_of(watcher).find("was lost"), std::string::npos);

  ProbeClient rival(table.port()), thief(table.port()), again(table.port());
  rival.say(rival.hello(0));
  const auto refusal = rival.hear_a<wire::Refusal>();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, Code::team_taken);
  wire::Welcome guess = *before;
  guess.token ^= 1;
  EXPECT_FALSE(thief.resume(guess)) << "with another ticket it is a stranger";

  const auto back = again.resume(*before);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->client, before->client);
  EXPECT_EQ(back->rods, before->rods);
  EXPECT_NE(back->input_key, before->input_key);
  EXPECT_EQ(watcher.hear_a<wire::Notice>().value_or(wire::Notice{}).level,
            wire::Notice::Level::cleared);
  table.tick();
  EXPECT_TRUE(again.snapshot());
  wire::InputDatagram input;
  input.session = back->session;
  input.token = back->token;
  ASSERT_TRUE(again.send_input(input));
  EXPECT_TRUE(table.tick_until([&] { return table->counters().input.accepted == 1; }));
  EXPECT_EQ(table->clients(), 2);
}

TEST(Seat, IsTakenAgainThoughTheServerHasNotNoticedTheLoss) {
  Lockstep table(keep_seats);
  ProbeClient player(table.port()), again(table.port());
  const auto before = player.join(1);
  ASSERT_TRUE(before);
  ASSERT_TRUE(again.resume(*before));
  EXPECT_TRUE(player.sees_close()) << "the old connection is no more";
  table.tick();
  EXPECT_TRUE(again.snapshot());
  EXPECT_EQ(table->clients(), 1);
}

// Who comes back and does not read goes again, in the middle of being told so.
TEST(Seat, OfWhoComesBackAndReadsNothingIsNobodyElsesMeanwhile) {
  const std::string name(40, 'n');
  const auto size_of = [](const wire::ControlMessage& message) { return bytes_of(message).size(); };
  const auto notice = [](wire::Notice::Level level, const std::string& text) {
    return wire::ControlMessage(wire::Notice{level, 1'000'001, text});
  };
  const RodSet rods = rods_of_team(foosball::MatchDesc{}.layout, 0);
  const auto lost = notice(wire::Notice::Level::warning,
                           name + " was lost: rods " + to_text(rods) + " are kept for 30 s");
  const auto back = notice(wire::Notice::Level::cleared, name + " is back");
  Lockstep table([&](ServerOptions& o) {
    keep_seats(o);
    o.limits.unsent_bytes = size_of(wire::Welcome{}) + size_of(wire::Tuning{}) +
                            size_of(characters::to_record(foosball::built_in_characters())) +
                            size_of(lost) + size_of(back) - 1;
  });
  auto player = std::make_unique<ProbeClient>(table.port());
  wire::Hello hello = player->hello(0);
  hello.name = name;
  const auto before = player->join(hello);
  ProbeClient other(table.port()), again(table.port());
  ASSERT_TRUE(before && other.join(1));
  // What comes back is sent the tuning too, once the tick has told it.
  ASSERT_TRUE(table.tick_until([&] {
    other.say(wire::Ping{1});
    return other.hear_a<wire::Pong>() && other.tuning();
  }));
  player->leave();
  ASSERT_TRUE(table.tick_until([&] { return table->counters().control.lost == 1; }));
  again.resume(*before);
  ASSERT_TRUE(table.tick_until([&] { return table->counters().control.slow_dropped == 1; }));
  const std::string log = table.log();
  EXPECT_NE(log.find(name + " at 127.0.0.1"), std::string::npos);
  EXPECT_NE(log.find(" is back"), std::string::npos);
  std::size_t named = 0;
  for (std::size_t at = log.find(" is back"); at != std::string::npos;
       at = log.find(" is back", at + 1)) {
    const std::size_t line = log.rfind('\n', at) + 1;
    named += log.compare(line, name.size(), name) == 0 ? 1 : 0;
  }
  EXPECT_EQ(named, 1u) << log;
  EXPECT_TRUE(table.tick_until([&] { return table->clients() == 1; }));
}

TEST(Seat, IsFreeAtOnceAfterAGoodByeAndInTimeWithoutOne) {
  Lockstep table([](ServerOptions& o) { o.limits.seat_kept_us = 100'000; });
  ProbeClient polite(table.port()), next(table.port()), last(table.port());
  ASSERT_TRUE(polite.join(0));
  polite.say_goodbye();
  ASSERT_TRUE(next.join(0));
  table.tick();
  ASSERT_EQ(table->clients(), 1);
  next.leave();
  ASSERT_TRUE(table.tick_until([&] { return table->counters().control.lost == 1; }));
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 0; }));
  EXPECT_TRUE(last.join(0));
}

// --- crowds
// ---------------------------------------------------------------------------------------

// 500 connections that send a byte now and then: a newcomer is in at once, and who is in stays in.
TEST(Door, ACrowdOfSlowConnectionsKeepsNobodyOut) {
  Lockstep table;
  ProbeClient inside(table.port());
  ASSERT_TRUE(inside.join(0));
  std::vector<std::unique_ptr<ProbeClient>> crowd;
  for (int i = 0; i < 500; ++i) {
    crowd.push_back(std::make_unique<ProbeClient>(table.port()));
    const auto bytes = bytes_of(crowd.back()->hello());
    crowd.back()->send_raw(std::span(bytes).first(1));
    if (i % 100 == 99) {
      ProbeClient newcomer(table.port());
      EXPECT_TRUE(newcomer.join()) << i;
    }
  }
  ProbeClient neighbour(table.port(), "127.0.0.2");
  EXPECT_TRUE(neighbour.join(1));
  inside.say(wire::Ping{5});
  EXPECT_TRUE(inside.hear_a<wire::Pong>());
  EXPECT_GE(table->counters().control.crowded_out, 400u);
}

TEST(Door, AHelloThatTricklesInIsCutOffAtItsDeadline) {
  Lockstep table([](ServerOptions& o) { o.limits.hello_us = 200'000; });
  ProbeClient slow(table.port());
  const auto bytes = bytes_of(slow.hello());
  const auto begun = std::chrono::steady_clock::now();
  std::size_t sent = 0;
  while (sent < bytes.size() && slow.send_raw(std::span(bytes).subspan(sent, 1))) {
    ++sent;
    if (slow.sees_close(20)) break;
  }
  EXPECT_LT(sent, bytes.size());
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5));
  EXPECT_EQ(table->counters().control.timed_out, 1u);
}

TEST(Door, TheLogIsSparedACrowdsLines) {
  Lockstep table;
  for (int i = 0; i < 200; ++i) ProbeClient(table.port()).join();
  ASSERT_TRUE(table.tick_until([&] { return table->counters().control.left == 200; }));
  const std::string log = table.log();
  EXPECT_LT(std::count(log.begin(), log.end(), '\n'), 100);
}

// --- beyond this machine (where loopback is not trusted, it stands for one)
// ------------------------

void want_password(ServerOptions& o) {
  o.access.trust_this_machine = false;
  o.access.password = "open sesame";
  o.access.host_password = "the host's own";
}

TEST(Password, LetsInWhoKnowsItAndNobodyElse) {
  Lockstep table(want_password);
  ProbeClient without(table.port()), wrong(table.port()), right(table.port());
  without.say(without.hello(0));
  const auto refusal = without.hear_a<wire::Refusal>();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, Code::password);

  ASSERT_TRUE(wrong.prove("open sesame!"));  // the exchange itself tells nobody
  EXPECT_FALSE(wrong.join(0));
  EXPECT_TRUE(table.tick_until([&] { return table->counters().control.wrong_passwords == 1; }));

  ASSERT_TRUE(right.prove("open sesame"));
  const auto welcome = right.join(0);
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->role, number(wire::Role::player));
  table.tick();
  EXPECT_TRUE(right.snapshot());
}

TEST(Password, OfAGuestMakesNoHost) {
  Lockstep table(want_password);
  ProbeClient guest(table.port()), host(table.port());
  ASSERT_TRUE(guest.prove("open sesame", wire::Role::host));
  EXPECT_FALSE(guest.join());
  ASSERT_TRUE(host.prove("the host's own", wire::Role::host));
  const auto welcome = host.join();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->role, number(wire::Role::host));
}

TEST(Password, IsGuessedSlowly) {
  Lockstep table(want_password);
  for (int i = 0; i < PasswordTries::kAtOnce; ++i) {
    ProbeClient guess(table.port());
    ASSERT_TRUE(guess.prove("guess " + std::to_string(i)));
    EXPECT_FALSE(guess.join());
  }
  ProbeClient one_more(table.port()), neighbour(table.port(), "127.0.0.2");
  EXPECT_FALSE(one_more.prove("open sesame")) << "not even with the right one, for a while";
  EXPECT_TRUE(neighbour.prove("open sesame") && neighbour.join(0)) << "from another machine";
}

// Many connections at once are no way round the limit.
TEST(Password, IsChargedWhenItIsTriedAndNotWhenItIsFoundWrong) {
  Lockstep table(want_password);
  std::vector<std::unique_ptr<ProbeClient>> guesses;
  int answered = 0;
  for (int i = 0; i < 3 * PasswordTries::kAtOnce; ++i) {
    guesses.push_back(std::make_unique<ProbeClient>(table.port()));
    answered += guesses.back()->prove("guess " + std::to_string(i)) ? 1 : 0;
  }
  EXPECT_EQ(answered, PasswordTries::kAtOnce);
}

TEST(Password, ThatIsRightCostsNothing) {
  Lockstep table(want_password);
  for (int i = 0; i < 3 * PasswordTries::kAtOnce; ++i) {
    ProbeClient guest(table.port());
    ASSERT_TRUE(guest.prove("open sesame") && guest.join()) << i;
    guest.say_goodbye();
    ASSERT_TRUE(table.tick_until(
        [&] { return table->counters().control.left == static_cast<std::uint64_t>(i) + 1; }));
  }
}

TEST(Password, WithoutOneNobodyJoinsFromAfar) {
  Lockstep table([](ServerOptions& o) { o.access.trust_this_machine = false; });
  ProbeClient client(table.port());
  EXPECT_FALSE(client.prove(""));
}

TEST(Password, WhatIsSealedAndThenTurnedEndsTheConnection) {
  Lockstep table(want_password);
  ProbeClient client(table.port());
  ASSERT_TRUE(client.prove("open sesame"));
  ASSERT_TRUE(client.join());
  const std::vector<std::byte> garbage(40, std::byte{1});
  client.send_raw(garbage);
  EXPECT_TRUE(client.sees_close());
}

TEST(Votes, TwoPlayersFromAfarRestartTogetherAndAWatcherNever) {
  Lockstep table(want_password);
  ProbeClient first(table.port()), second(table.port(), "127.0.0.2"), watcher(table.port());
  ASSERT_TRUE(first.prove("open sesame") && first.join(0));
  ASSERT_TRUE(second.prove("open sesame") && second.join(1));
  ASSERT_TRUE(watcher.prove("open sesame") && watcher.join());
  const auto push = static_cast<std::uint8_t>(foosball::Command::Kind::push);
  const wire::Wish restart{static_cast<std::uint8_t>(foosball::Command::Kind::restart), 0, 0};
  first.say(wire::Wish{push, 0, 0});
  ASSERT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
  watcher.say(restart);
  first.say(restart);
  EXPECT_NE(notice_of(second).find("1 of 2 votes"), std::string::npos);
  table.tick(5);
  EXPECT_EQ(table->match().view().screen, foosball::Screen::selection);
  EXPECT_EQ(table->counters().control.wishes_dropped, 1u) << "the watcher's";
  second.say(restart);
  EXPECT_TRUE(table.tick_until(
      [&] { return table->match().view().screen != foosball::Screen::selection; }));
}

TEST(Votes, AGuestWithSeveralSeatsHasOneVote) {
  Lockstep table(want_password);
  std::vector<std::unique_ptr<ProbeClient>> greedy;
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if ((all0 >> rod & 1) == 0) continue;
    greedy.push_back(std::make_unique<ProbeClient>(table.port()));
    ASSERT_TRUE(greedy.back()->prove("open sesame") && greedy.back()->join(0, RodSet(1u << rod)));
  }
  ProbeClient other(table.port(), "127.0.0.2");
  ASSERT_TRUE(other.prove("open sesame") && other.join(1));
  const auto push = static_cast<std::uint8_t>(foosball::Command::Kind::push);
  const wire::Wish restart{static_cast<std::uint8_t>(foosball::Command::Kind::restart), 0, 0};
  other.say(wire::Wish{push, 1, 0});
  ASSERT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
  for (auto& seat : greedy) {
    seat->say(restart);
    EXPECT_NE(notice_of(other).find("1 of 2 votes"), std::string::npos);
  }
  table.tick(5);
  EXPECT_EQ(table->match().view().screen, foosball::Screen::selection);
  other.say(restart);
  EXPECT_TRUE(
      table.tick_until([&] { return table->match().view().screen == foosball::Screen::logo; }));
}

// --- two people, one team
// -------------------------------------------------------------------------

TEST(Rods, TwoPeopleShareATeamAndEachDrivesTheirOwn) {
  Lockstep table;
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  const RodSet one = RodSet(all0 & -all0), rest = RodSet(all0 & ~one);
  ProbeClient goalie(table.port()), striker(table.port()), third(table.port());
  const auto a = goalie.join(0, one), b = striker.join(0);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->rods, one);
  EXPECT_EQ(b->rods, rest);
  EXPECT_FALSE(third.join(0)) << "no rod is left";
  table.tick();
  const auto drive = [&](ProbeClient& client, const wire::Welcome& welcome, float slide) {
    wire::InputDatagram in;
    in.session = welcome.session;
    in.token = welcome.token;
    for (auto& rod : in.rods) rod = {true, slide, 0.0, 0.0f, 0.0f};
    in.sequence = 1;
    ASSERT_TRUE(client.send_input(in));
  };
  drive(goalie, *a, 0.01f);
  drive(striker, *b, -0.01f);
  table.tick();
  std::optional<wire::Snapshot> newest;
  while (wait_readable(goalie.udp(), 0)) newest = goalie.snapshot(0);
  ASSERT_TRUE(newest);
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if ((all0 >> rod & 1) == 0) continue;
    EXPECT_EQ(newest->rods[rod].source, number(wire::RodSource::client)) << rod;
    EXPECT_EQ(newest->rods[rod].slide_rate > 0, (one >> rod & 1) != 0) << rod;
  }
}

TEST(Rods, AreClaimedAndGivenUpWhileTheGameGoesOnAndAllAreTold) {
  Lockstep table;
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  const RodSet one = RodSet(all0 & -all0), rest = RodSet(all0 & ~one);
  ProbeClient first(table.port()), second(table.port());
  ASSERT_TRUE(first.join(0));
  first.say(wire::Claim{one});
  first.say(wire::Ping{1});
  ASSERT_TRUE(first.hear_a<wire::Pong>());
  const auto joined = second.join(0);
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->rods, rest);
  second.say(wire::Claim{all0});
  EXPECT_NE(notice_of(second).find("are taken"), std::string::npos);
  first.say(wire::Ping{2});
  ASSERT_TRUE(first.hear_a<wire::Pong>());
  ASSERT_EQ(first.roster().seats.size(), 2u);
  EXPECT_EQ(first.roster().seats[0].rods, one);
  EXPECT_EQ(first.roster().seats[1].rods, rest);
}

TEST(Rods, AreGivenUpToWatchAndTakenAgainOnTheOtherTeam) {
  Lockstep table;
  const auto layout = foosball::MatchDesc{}.layout;
  ProbeClient client(table.port());
  const auto welcome = client.join(0);
  ASSERT_TRUE(welcome);
  const auto claim = [&](wire::Claim asked) {
    client.say(asked);
    client.say(wire::Ping{1});
    return client.hear_a<wire::Pong>() && client.roster().seats.size() == 1;
  };
  ASSERT_TRUE(claim({0, wire::kWatchOnly}));
  EXPECT_EQ(client.roster().seats[0].rods, 0);
  EXPECT_EQ(client.roster().seats[0].team, wire::kWatchOnly);
  const RodSet all1 = rods_of_team(layout, 1), one = RodSet(all1 & -all1);
  ASSERT_TRUE(claim({one, 1}));
  EXPECT_EQ(client.roster().seats[0].rods, one);
  EXPECT_EQ(client.roster().seats[0].team, 1);
  // Its inputs move that rod: the socket for them was opened anew or never closed.
  wire::InputDatagram input{.session = welcome->session, .token = welcome->token, .sequence = 9};
  for (wire::InputRod& rod : input.rods) rod = {true, 0.05f, 0.0, 0.0f, 0.0f};
  for (int ms = 0; ms < 300; ++ms) {
    ++input.sequence;
    ASSERT_TRUE(client.send_input(input));
    table.tick();
  }
  EXPECT_GT(table->match().view().rods[std::countr_zero(one)].slide, 0.03);
}

TEST(Rods, AWatcherTakesOneAndIsHeard) {
  Lockstep table;
  ProbeClient client(table.port());
  const auto welcome = client.join();
  ASSERT_TRUE(welcome);
  const RodSet one = 1;
  client.say(wire::Claim{one, 0});
  client.say(wire::Ping{1});
  ASSERT_TRUE(client.hear_a<wire::Pong>());
  ASSERT_EQ(client.roster().seats.at(0).rods, one);
  table.tick();
  wire::InputDatagram input{.session = welcome->session, .token = welcome->token, .sequence = 9};
  input.rods[0] = {true, 0.05f, 0.0, 0.0f, 0.0f};
  for (int ms = 0; ms < 300; ++ms) {
    ++input.sequence;
    ASSERT_TRUE(client.send_input(input));
    table.tick();
  }
  EXPECT_GT(table->match().view().rods[0].slide, 0.03);
}

TEST(Rods, WhoeverHasRodsOfBothTeamsAsksForBoth) {
  Lockstep table;
  ProbeClient client(table.port());
  ASSERT_TRUE(client.join(0, 0xff));
  client.say(wire::Wish{number(wire::WishKind::push), 0, 0});
  ASSERT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
  const auto character = static_cast<std::uint8_t>((table->match().view().character[1] + 1) % 3);
  client.say(wire::Wish{number(wire::WishKind::choose_character), 1, character});
  EXPECT_TRUE(
      table.tick_until([&] { return table->match().view().character[1] == character; }, 5000));
}

// Forged or not: a value out of its range changes nothing, a watcher's and a player's neither.
TEST(Tuning, IsToldToAllAndChangedByHostsOnlyWithinItsRange) {
  Lockstep table;
  ProbeClient host(table.port()), second(table.port()), watcher(table.port());
  ASSERT_TRUE(host.join(0));
  ASSERT_TRUE(second.join(1));
  ASSERT_TRUE(watcher.join());
  const auto all_told = [&](double gravity) {
    for (ProbeClient* client : {&host, &second, &watcher}) {
      const bool told = table.tick_until([&] {
        client->say(wire::Ping{1});
        return client->hear_a<wire::Pong>() && client->tuning() &&
               client->tuning()->values[0] == gravity;
      });
      if (!told) return false;
    }
    return true;
  };
  const double usual = foosball::Tuning{}.gravity;
  ASSERT_TRUE(all_told(usual));
  const auto tune = [](std::uint8_t value, double amount) {
    return wire::Wish{number(wire::WishKind::tune), 0, value, amount};
  };
  host.say(tune(0, 9.0));
  EXPECT_TRUE(all_told(9.0));
  // Two hosts, as all at this machine are: the later word counts, and both are told.
  second.say(tune(0, 10.0));
  EXPECT_TRUE(all_told(10.0));
  ProbeClient forger(table.port());
  ASSERT_TRUE(forger.join());
  forger.say(tune(0, 1e6));  // ends the connection: no client of ours sends it
  EXPECT_TRUE(forger.sees_close());
  table.tick(20);
  EXPECT_EQ(table->match().view().tuning.gravity, 10.0);
  ProbeClient late(table.port());
  ASSERT_TRUE(late.join());
  late.say(wire::Ping{1});
  ASSERT_TRUE(late.hear_a<wire::Pong>());
  ASSERT_TRUE(late.tuning());
  EXPECT_EQ(late.tuning()->values[0], 10.0);
}

}  // namespace
}  // namespace server
