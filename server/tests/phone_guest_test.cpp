#include "phone_guest.h"

#include <gtest/gtest.h>

#include <bit>

#include "wire/enums.h"

namespace server {
namespace {

using wire::number;
using wire::RodPair;

template <class Message>
const Message* only(const std::vector<wire::ControlMessage>& messages) {
  return messages.size() == 1 ? std::get_if<Message>(&messages[0]) : nullptr;
}
template <class Message>
const Message* only(const std::vector<wire::PhoneReply>& messages) {
  return messages.size() == 1 ? std::get_if<Message>(&messages[0]) : nullptr;
}

wire::PhoneRequest claim(int team, RodPair pair) {
  return wire::PhoneClaim{static_cast<std::uint8_t>(team), number(pair)};
}

wire::Roster roster(std::vector<wire::Seat> seats) {
  wire::Roster all;
  all.seats = std::move(seats);
  return all;
}

// A phone that has joined as client 7, and has these rods.
class PhoneAtATable : public testing::TestWithParam<foosball::Layout> {
 protected:
  void let_in(RodSet rods = 0, std::uint8_t team = wire::kWatchOnly) {
    guest.handle(wire::PhoneRequest(wire::PhoneHello{}));
    wire::Welcome welcome;
    welcome.session = 11;
    welcome.token = 22;
    welcome.client = 7;
    guest.handle(wire::ControlMessage(welcome));
    guest.handle(wire::ControlMessage(roster({{7, "Ann", team, rods, 1, false}})));
  }
  PhoneGuest guest{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Layouts, PhoneAtATable,
                         testing::Values(foosball::Layout::paper, foosball::Layout::tournament));

TEST_P(PhoneAtATable, TheFourPairsAreTheEightRodsEachOfOneTeam) {
  RodSet all = 0;
  for (std::uint8_t team = 0; team < foosball::kTeams; ++team) {
    for (const RodPair pair : {RodPair::defence, RodPair::attack}) {
      const RodPairOf rods = rods_of_pair(GetParam(), team, pair);
      EXPECT_EQ(std::popcount(rods.rods), 2);
      EXPECT_EQ(rods.rods & all, 0);
      EXPECT_EQ(rods.rods & ~rods_of_team(GetParam(), team), 0);
      EXPECT_LT(rods.by_x[0], rods.by_x[1]);
      all |= rods.rods;
    }
  }
  EXPECT_EQ(all, 0xFF);
}

TEST_P(PhoneAtATable, SaysHelloAsAWatcherWithTheTicketThatItHas) {
  const auto out = guest.handle(wire::PhoneRequest(wire::PhoneHello{11, 22, "Ann"}));
  const auto* hello = only<wire::Hello>(out.to_control);
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->name, "Ann");
  EXPECT_EQ(hello->session, 11u);
  EXPECT_EQ(hello->ticket, 22u);
  EXPECT_EQ(hello->team, wire::kWatchOnly);
  EXPECT_EQ(hello->udp_port, 0u) << "snapshots are not for phones";
  EXPECT_FALSE(out.end);
}

TEST_P(PhoneAtATable, IsToldOfPairsThatNobodyElseHas) {
  guest.handle(wire::PhoneRequest(wire::PhoneHello{}));
  wire::Welcome welcome;
  welcome.client = 7;
  welcome.session = 11;
  welcome.token = 22;
  guest.handle(wire::ControlMessage(welcome));
  const RodSet one_rod =
      static_cast<RodSet>(1u << rods_of_pair(GetParam(), 1, RodPair::attack).by_x[0]);
  const auto out = guest.handle(wire::ControlMessage(
      roster({{3, "Ben", 1, one_rod, 1, false}, {7, "Ann", wire::kWatchOnly, 0, 0, false}})));
  const auto* state = only<wire::PhoneState>(out.to_phone);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->free, 0b0111);
  EXPECT_EQ(state->pair, number(RodPair::none));
  EXPECT_EQ(state->name, "Ann");
  EXPECT_EQ(state->session, 11u);
  EXPECT_EQ(state->ticket, 22u);
  // An equal roster sends nothing.
  EXPECT_TRUE(guest
                  .handle(wire::ControlMessage(roster({{3, "Ben", 1, one_rod, 1, false},
                                                       {7, "Ann", wire::kWatchOnly, 0, 0, false}})))
                  .to_phone.empty());
}

TEST_P(PhoneAtATable, DrivesTheTwoRodsThatItHasAndNoOther) {
  for (std::uint8_t team = 0; team < foosball::kTeams; ++team) {
    for (const RodPair pair : {RodPair::defence, RodPair::attack}) {
      PhoneGuest fresh(GetParam());
      guest = fresh;
      const RodPairOf mine = rods_of_pair(GetParam(), team, pair);
      let_in(mine.rods, team);
      wire::PhoneInput input{.sequence = 1};
      input.rods[0] = {true, 0.01f, 1.0, 0.1f, 2.0f};
      input.rods[1] = {true, -0.02f, -3.0, -0.2f, -4.0f};
      const auto out = guest.handle(wire::PhoneRequest(input));
      ASSERT_TRUE(out.input);
      EXPECT_EQ(out.input->client, 7u);
      for (int rod = 0; rod < foosball::kRods; ++rod) {
        const auto& wanted = out.input->input.rods[static_cast<std::size_t>(rod)];
        EXPECT_EQ(wanted.driven, (mine.rods >> rod & 1) != 0) << rod;
      }
      EXPECT_EQ(out.input->input.rods[static_cast<std::size_t>(mine.by_x[0])].slide, 0.01f);
      EXPECT_EQ(out.input->input.rods[static_cast<std::size_t>(mine.by_x[1])].angle, -3.0);
      EXPECT_EQ(guest.index_of(mine.by_x[1]), 1);
      EXPECT_EQ(guest.index_of((mine.by_x[1] + 1) % foosball::kRods), std::nullopt);
    }
  }
}

TEST_P(PhoneAtATable, WithoutRodsItDrivesNothing) {
  let_in();
  EXPECT_FALSE(guest.handle(wire::PhoneRequest(wire::PhoneInput{.sequence = 1})).input);
}

TEST_P(PhoneAtATable, AnOlderInputIsDropped) {
  let_in(rods_of_pair(GetParam(), 0, RodPair::attack).rods, 0);
  EXPECT_TRUE(guest.handle(wire::PhoneRequest(wire::PhoneInput{.sequence = 0xFFFFFFFF})).input);
  EXPECT_FALSE(guest.handle(wire::PhoneRequest(wire::PhoneInput{.sequence = 0xFFFFFFFF})).input);
  const auto wrapped = guest.handle(wire::PhoneRequest(wire::PhoneInput{.sequence = 1}));
  ASSERT_TRUE(wrapped.input);
  EXPECT_EQ(wrapped.input->input.sequence, 2u);
}

TEST_P(PhoneAtATable, AClaimIsOfThePairsRodsAndNoneGivesUp) {
  EXPECT_TRUE(PhoneGuest(GetParam()).handle(claim(0, RodPair::attack)).end) << "before the hello";
  let_in();
  const auto asked = guest.handle(claim(1, RodPair::defence));
  const auto* claimed = only<wire::Claim>(asked.to_control);
  ASSERT_TRUE(claimed);
  EXPECT_EQ(claimed->team, 1);
  EXPECT_EQ(claimed->rods, rods_of_pair(GetParam(), 1, RodPair::defence).rods);
  const auto given = guest.handle(claim(1, RodPair::none));
  ASSERT_TRUE(only<wire::Claim>(given.to_control));
  EXPECT_EQ(only<wire::Claim>(given.to_control)->rods, 0);
}

TEST_P(PhoneAtATable, ASecondHelloARefusalAndAGoodbyeEndIt) {
  let_in();
  EXPECT_TRUE(guest.handle(wire::PhoneRequest(wire::PhoneHello{})).end);
  for (const wire::ControlMessage& message :
       {wire::ControlMessage(wire::Refusal{wire::Refusal::Code::not_allowed, "no"}),
        wire::ControlMessage(wire::Bye{"no"})}) {
    const auto out = guest.handle(message);
    EXPECT_TRUE(out.end);
    const auto* notice = only<wire::PhoneNotice>(out.to_phone);
    ASSERT_TRUE(notice);
    EXPECT_EQ(notice->text, "no");
    EXPECT_EQ(notice->level, number(wire::PhoneNotice::Level::end));
  }
}

}  // namespace
}  // namespace server
