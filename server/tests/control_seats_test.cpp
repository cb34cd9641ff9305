// The control port on real sockets: seats that are lost and resumed, rods that people share, and
// permissions for the tuning.
#include <atomic>
#include <bit>

#include "characters/record.h"
#include "control_fixture.h"
#include "seats.h"

namespace server {
namespace {

void keep_seats(ServerOptions& o) {
  o.limits.seat_kept_us = 30'000'000;
}

TEST(Seat, OfAPlayerWhoWasLostIsKeptFromRivalsAndTakenAgainWithItsTicket) {
  Lockstep table(keep_seats);
  ProbeClient watcher(table.port());
  ASSERT_TRUE(watcher.join());
  auto player = std::make_unique<ProbeClient>(table.port());
  const auto before = player->join(0);
  ASSERT_TRUE(before);
  player->leave();  // as if the cable was unplugged
  EXPECT_NE(notice_of(watcher).find("was lost"), std::string::npos);

  ProbeClient rival(table.port()), thief(table.port()), again(table.port());
  rival.send(rival.hello(0));
  const auto refusal = rival.receive_a<wire::Refusal>();
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
  EXPECT_EQ(watcher.receive_a<wire::Notice>().value_or(wire::Notice{}).level,
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

// Two clients with one ticket would take the seat from each other forever, and all would be
// notified.
TEST(Seat, IsNotTakenAgainHundredsOfTimesASecond) {
  Lockstep table(keep_seats);
  auto holder = std::make_unique<ProbeClient>(table.port());
  const auto ticket = holder->join(0);
  ASSERT_TRUE(ticket);
  int taken = 0;
  bool refused = false;
  while (!refused && taken < 1000) {
    auto thief = std::make_unique<ProbeClient>(table.port());
    wire::Hello hello = thief->hello(0);
    hello.session = ticket->session;
    hello.ticket = ticket->token;
    ASSERT_TRUE(thief->send(hello));
    const auto answer = thief->receive();
    ASSERT_TRUE(answer);
    refused = std::holds_alternative<wire::Refusal>(*answer);
    if (refused) break;
    ++taken;
    holder = std::move(thief);
    table.tick();
  }
  EXPECT_TRUE(refused);
  EXPECT_GE(taken, Seat::kResumesAtOnce);
  table.tick();
  EXPECT_TRUE(holder->catch_up()) << "who has it keeps it";
}

// A client that resumes but does not read is dropped while it is being sent the state.
TEST(Seat, OfWhoComesBackAndReadsNothingIsNobodyElsesMeanwhile) {
  const std::string name(40, 'n');
  const auto size_of = [](const wire::ControlMessage& message) { return bytes_of(message).size(); };
  const auto notice = [](wire::Notice::Level level, const std::string& text) {
    return wire::ControlMessage(wire::Notice{level, 1'000'001, text});
  };
  const RodSet rods = rods_of_team(foosball::MatchDesc{}.layout, 0);
  const auto lost = notice(wire::Notice::Level::warning,
                           name + " was lost: rods " + to_text(rods) + " are reserved for 30 s");
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
  // A returning client also gets the tuning, once the tick has sent it.
  ASSERT_TRUE(table.tick_until([&] { return other.catch_up() && other.tuning(); }));
  player->leave();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.lost == 1; }));
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
  polite.send_goodbye();
  ASSERT_TRUE(next.join(0));
  table.tick();
  ASSERT_EQ(table->clients(), 1);
  next.leave();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.lost == 1; }));
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 0; }));
  EXPECT_TRUE(last.join(0));
}

// With unread bytes the client's end arrives as a reset. The server may detect it when it sends,
// while the client's earlier messages are still unread. The control thread writes the log between
// polling the sockets and sending, which makes the order deterministic.
TEST(Seat, IsFreeAtOnceAfterTheGoodByeOfAClientThatHasNotReadAll) {
  std::atomic<ProbeClient*> leaver = nullptr;
  std::atomic<bool> has_left = false;  // this thread uses the client again
  Lockstep table([&](ServerOptions& o) {
    keep_seats(o);
    o.log = [&](LogLevel, const std::string&) {
      ProbeClient* client = leaver.exchange(nullptr);
      if (client == nullptr) return;
      client->send_goodbye();
      has_left = true;
    };
  });
  ProbeClient player(table.port());
  ASSERT_TRUE(player.join(0));
  player.send(wire::Ping{1});
  ASSERT_TRUE(wait_readable(player.tcp(), ProbeClient::kPatienceMs));
  table.tick();
  leaver = &player;
  table->warn(Server::Topic::overload, wire::Sentence::untranslated("all are told"));
  ASSERT_TRUE(table.tick_until([&] {
    const ControlCounters seen = table->counters().control;
    return has_left && seen.left + seen.lost == 1;
  }));
  EXPECT_EQ(table->counters().control.left, 1u);
}

// --- two people, one team

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
  first.send(wire::Claim{one});
  ASSERT_TRUE(first.catch_up());
  const auto joined = second.join(0);
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->rods, rest);
  second.send(wire::Claim{all0});
  EXPECT_NE(notice_of(second).find("are taken"), std::string::npos);
  ASSERT_TRUE(first.catch_up());
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
    client.send(asked);
    return client.catch_up() && client.roster().seats.size() == 1;
  };
  ASSERT_TRUE(claim({0, wire::kWatchOnly}));
  EXPECT_EQ(client.roster().seats[0].rods, 0);
  EXPECT_EQ(client.roster().seats[0].team, wire::kWatchOnly);
  const RodSet all1 = rods_of_team(layout, 1), one = RodSet(all1 & -all1);
  ASSERT_TRUE(claim({one, 1}));
  EXPECT_EQ(client.roster().seats[0].rods, one);
  EXPECT_EQ(client.roster().seats[0].team, 1);
  // Its inputs move that rod: its socket was opened again or never closed.
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
  client.send(wire::Claim{one, 0});
  ASSERT_TRUE(client.catch_up());
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

// Two clients of one machine with one name count as one person, except against each other.
TEST(Rods, WhoChangesSidesToTheOpponentOfThatNameIsToldApart) {
  Lockstep table;
  const auto layout = foosball::MatchDesc{}.layout;
  const RodSet all0 = rods_of_team(layout, 0), one = RodSet(all0 & -all0);
  const RodSet all1 = rods_of_team(layout, 1);
  ProbeClient first(table.port()), second(table.port());
  ASSERT_TRUE(first.join(0, one) && second.join(0, RodSet(all0 & ~one)));
  const auto names = [&] {
    EXPECT_TRUE(first.catch_up());
    std::vector<std::string> found;
    for (const wire::Seat& seat : first.roster().seats) found.push_back(seat.name);
    return found;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(), (Names{"probe", "probe"}));
  second.send(wire::Claim{all1, 1});
  ASSERT_TRUE(second.catch_up());
  EXPECT_EQ(names(), (Names{"probe", "probe (2)"}));
  first.send_goodbye();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 1; }));
  second.send(wire::Claim{all0, 0});
  ASSERT_TRUE(second.catch_up());
  EXPECT_EQ(second.roster().seats.at(0).name, "probe (2)") << "not the one who has left";
}

// Results and the rules for leavers use names as keys, so several people at one window need several
// names.
TEST(Names, OfSeveralPeopleAtOneClientAreToldToAllAndChangedByNoOther) {
  Lockstep table;
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  const RodSet all1 = rods_of_team(foosball::MatchDesc{}.layout, 1);
  ProbeClient window(table.port()), rival(table.port(), "127.0.0.2");
  ASSERT_TRUE(window.join(0) && rival.join(1));
  wire::Names names{"Ann", {}};
  const auto first = static_cast<std::size_t>(std::countr_zero(all0));
  const auto theirs = static_cast<std::size_t>(std::countr_zero(all1));
  names.players[first] = " Ben\xE2\x80\x8B ";  // cleaned like the name of a Hello
  names.players[theirs] = "Dora";              // a rod that it does not have
  window.send(names);
  ASSERT_TRUE(window.catch_up());
  EXPECT_EQ(window.roster().seats.at(0).name, "Ann");
  EXPECT_EQ(window.roster().players[first], "Ben");
  EXPECT_EQ(window.roster().players[theirs], "");
  // For another machine the names are taken, and nobody may use the names reserved by the results.
  wire::Names same{"Ben", {}};
  same.players[theirs] = "Ann";
  rival.send(same);
  ASSERT_TRUE(rival.catch_up());
  EXPECT_EQ(rival.roster().seats.at(1).name, "Ben (2)");
  EXPECT_EQ(rival.roster().players[theirs], "Ann (2)");
  same.players[theirs] = "computer 5";
  rival.send(same);
  ASSERT_TRUE(rival.catch_up());
  EXPECT_EQ(rival.roster().players[theirs], "computer 5 (1)");
}

TEST(Rods, WhoeverHasRodsOfBothTeamsAsksForBoth) {
  Lockstep table;
  ProbeClient client(table.port());
  ASSERT_TRUE(client.join(0, 0xff));
  client.send(wire::MatchRequest{number(wire::RequestKind::push), 0, 0});
  ASSERT_TRUE(table.tick_until(
      [&] { return table->match().view().screen == foosball::Screen::selection; }));
  const auto character = static_cast<std::uint8_t>((table->match().view().character[1] + 1) % 3);
  client.send(wire::MatchRequest{number(wire::RequestKind::choose_character), 1, character});
  EXPECT_TRUE(
      table.tick_until([&] { return table->match().view().character[1] == character; }, 5000));
}

// A value out of range changes nothing, forged or not; neither does a request of a watcher or a
// player.
TEST(Tuning, IsToldToAllAndChangedByHostsOnlyWithinItsRange) {
  Lockstep table;
  ProbeClient host(table.port()), second(table.port()), watcher(table.port());
  ASSERT_TRUE(host.join(0));
  ASSERT_TRUE(second.join(1));
  ASSERT_TRUE(watcher.join());
  const auto all_received = [&](double gravity) {
    for (ProbeClient* client : {&host, &second, &watcher}) {
      const bool reported = table.tick_until([&] {
        return client->catch_up() && client->tuning() && client->tuning()->values[0] == gravity;
      });
      if (!reported) return false;
    }
    return true;
  };
  const double usual = foosball::Tuning{}.gravity;
  ASSERT_TRUE(all_received(usual));
  const auto tune = [](std::uint8_t value, double amount) {
    return wire::MatchRequest{number(wire::RequestKind::tune), 0, value, amount};
  };
  host.send(tune(0, 9.0));
  EXPECT_TRUE(all_received(9.0));
  // Two hosts, like all clients on this machine: the later value counts, and both receive it.
  second.send(tune(0, 10.0));
  EXPECT_TRUE(all_received(10.0));
  ProbeClient forger(table.port());
  ASSERT_TRUE(forger.join());
  forger.send(tune(0, 1e6));  // ends the connection: our clients never send it
  EXPECT_TRUE(forger.sees_close());
  table.tick(20);
  EXPECT_EQ(table->match().view().tuning.gravity, 10.0);
  ProbeClient late(table.port());
  ASSERT_TRUE(late.join());
  ASSERT_TRUE(late.catch_up());
  ASSERT_TRUE(late.tuning());
  EXPECT_EQ(late.tuning()->values[0], 10.0);
}

}  // namespace
}  // namespace server
