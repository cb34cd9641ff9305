// The control port on real sockets: floods of connections, passwords and votes.
#include "control_fixture.h"
#include "door.h"
#include "seats.h"

namespace server {
namespace {

// --- floods of connections

// 500 connections that send a byte now and then: a new client joins at once, and joined clients
// stay.
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
  EXPECT_TRUE(inside.catch_up());
  EXPECT_GE(table->counters().control.crowded_out, 400u);
}

// With one connection per address the oldest is dropped, not always that of the same address.
TEST(Door, ACrowdOfAddressesKeepsNoAddressOut) {
  Lockstep table([](ServerOptions& o) { o.limits.greeting = 3; });
  std::vector<ProbeClient> crowd;
  for (const char* from : {"127.0.0.5", "127.0.0.6"}) crowd.emplace_back(table.port(), from);
  ProbeClient first(table.port(), "127.0.0.2"), last(table.port(), "127.0.0.9");
  crowd.emplace_back(table.port(), "127.0.0.7");  // two are dropped for it and the last
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.crowded_out == 2; }));
  EXPECT_TRUE(crowd[0].sees_close() && crowd[1].sees_close());
  EXPECT_TRUE(first.join());
  EXPECT_TRUE(last.join());
}

// Names reach the log and other clients' screens: they must pass wire::clean_name().
TEST(Door, NamesShowAllThatTheyHave) {
  Lockstep table;
  const std::pair<std::string, std::string> names[] = {
      {"\x1b[2J\n", "?[2J?"},
      {"\u009b31m", "?31m"},
      {"\u200b", "unnamed"},
      {"\u2066a\ufeff", "a"},
      {"J\u00fcrgen \uae40\u2013", "J\u00fcrgen \uae40\u2013"},
  };
  for (const auto& [given, shown] : names) {
    ProbeClient client(table.port());
    wire::Hello hello = client.hello();
    hello.name = given;
    ASSERT_TRUE(client.join(hello)) << shown;
    ASSERT_TRUE(client.catch_up());
    ASSERT_FALSE(client.roster().seats.empty());
    EXPECT_EQ(client.roster().seats.back().name, shown);
    client.send_goodbye();
  }
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
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.left == 200; }));
  const std::string log = table.log();
  EXPECT_LT(std::count(log.begin(), log.end(), '\n'), 100);
}

// --- remote clients (simulated by loopback clients that are not trusted)

void want_password(ServerOptions& o) {
  o.access.trust_this_machine = false;
  o.access.password = "open sesame";
  o.access.host_password = "the host's own";
}

TEST(Password, LetsInWhoKnowsItAndNobodyElse) {
  Lockstep table(want_password);
  ProbeClient without(table.port()), wrong(table.port()), right(table.port());
  without.send(without.hello(0));
  const auto refusal = without.receive_a<wire::Refusal>();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, Code::password);

  ASSERT_TRUE(wrong.prove("open sesame!"));  // the exchange itself does not reveal it
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

// Parallel connections do not avoid the limit.
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
    guest.send_goodbye();
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
  const wire::MatchRequest restart{static_cast<std::uint8_t>(foosball::Command::Kind::restart), 0,
                                   0};
  first.send(wire::MatchRequest{push, 0, 0});
  ASSERT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
  watcher.send(restart);
  first.send(restart);
  EXPECT_NE(notice_of(second).find("1 of 2 votes"), std::string::npos);
  table.tick(5);
  EXPECT_EQ(table->match().view().screen, foosball::Screen::selection);
  EXPECT_EQ(table->counters().control.requests_dropped, 1u) << "the watcher's";
  second.send(restart);
  EXPECT_TRUE(table.tick_until(
      [&] { return table->match().view().screen != foosball::Screen::selection; }));
}

// A restart ends the match without a result, so the losing player needs the other's vote.
TEST(Votes, NobodyRestartsAloneWhileTheOpponentsSeatIsKept) {
  Lockstep table([](ServerOptions& o) {
    want_password(o);
    o.limits.seat_kept_us = 30'000'000;
  });
  ProbeClient first(table.port()), second(table.port(), "127.0.0.2");
  ASSERT_TRUE(first.prove("open sesame") && first.join(0));
  ASSERT_TRUE(second.prove("open sesame") && second.join(1));
  const auto push = static_cast<std::uint8_t>(foosball::Command::Kind::push);
  first.send(wire::MatchRequest{push, 0, 0});
  ASSERT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
  second.leave();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.lost == 1; }));
  first.send(wire::MatchRequest{static_cast<std::uint8_t>(foosball::Command::Kind::restart), 0, 0});
  std::string reported;
  for (int notice = 0; notice < 2 && reported.find("votes") == std::string::npos; ++notice) {
    reported = notice_of(first);
  }
  EXPECT_NE(reported.find("1 of 2 votes"), std::string::npos) << reported;
  table.tick(5);
  EXPECT_EQ(table->match().view().screen, foosball::Screen::selection);
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
  const wire::MatchRequest restart{static_cast<std::uint8_t>(foosball::Command::Kind::restart), 0,
                                   0};
  other.send(wire::MatchRequest{push, 1, 0});
  ASSERT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
  for (auto& seat : greedy) {
    seat->send(restart);
    EXPECT_NE(notice_of(other).find("1 of 2 votes"), std::string::npos);
  }
  table.tick(5);
  EXPECT_EQ(table->match().view().screen, foosball::Screen::selection);
  other.send(restart);
  EXPECT_TRUE(
      table.tick_until([&] { return table->match().view().screen == foosball::Screen::logo; }));
}

}  // namespace
}  // namespace server
