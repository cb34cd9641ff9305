// Votes against a player, without sockets, in simulated time.
#include "kick_votes.h"

#include <gtest/gtest.h>

namespace server {
namespace {

using Machines = std::vector<std::string>;
const KickVotes::Target kTarget{7, "Bad", "x"}, kOther{2, "Other", "y"};
const Machines kThree{"a", "b", "c"}, kTwo{"a", "b"};

TEST(KickVotes, MoreThanHalfOfTheOthersDecideAndNeverOneAlone) {
  KickVotes votes;
  EXPECT_EQ(votes.cast("a", kTarget, kTwo, 0).needed, 2);
  EXPECT_TRUE(votes.cast("b", kTarget, kTwo, 1).passed());
  EXPECT_FALSE(votes.any());
  const Machines five{"a", "b", "c", "d", "e"};
  KickVotes more;
  EXPECT_EQ(more.cast("a", kTarget, five, 0).needed, 3);
  EXPECT_FALSE(more.cast("b", kTarget, five, 0).passed());
  EXPECT_TRUE(more.cast("c", kTarget, five, 0).passed());
  KickVotes again;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(again.cast("a", kTarget, kThree, i).passed());
}

TEST(KickVotes, AMachineBeginsOneVoteAMinuteAndAgreesAtAnyTime) {
  KickVotes votes;
  EXPECT_TRUE(votes.cast("a", kTarget, kThree, 0).taken);
  EXPECT_FALSE(votes.cast("a", kOther, kThree, 1).taken) << "another victim is another vote";
  EXPECT_TRUE(votes.cast("b", kOther, kThree, 1).taken);
  EXPECT_TRUE(votes.cast("a", kOther, kThree, 2).passed());
  EXPECT_EQ(votes.expire(KickVotes::kOpenUs), 7u);
  EXPECT_FALSE(votes.cast("a", kTarget, kThree, KickVotes::kEveryUs - 1).taken);
  EXPECT_TRUE(votes.cast("a", kTarget, kThree, KickVotes::kEveryUs).taken);
}

TEST(KickVotes, OfThoseWhoHaveLeftNoVoteCounts) {
  KickVotes votes;
  votes.cast("gone", kTarget, Machines{"gone", "a", "b"}, 0);
  EXPECT_EQ(votes.cast("a", kTarget, kTwo, 1).votes, 1);
}

constexpr auto nobody = [](std::uint32_t) { return false; };
constexpr auto everybody = [](std::uint32_t) { return true; };

TEST(KickVotes, WhoLeavesAndComesAnewIsStillTheOne) {
  KickVotes votes;
  votes.cast("a", kTarget, kThree, 0);
  EXPECT_FALSE(votes.carry_over({8, "New", "y"}, nobody)) << "from elsewhere";
  EXPECT_FALSE(votes.carry_over({8, "New", "x"}, everybody)) << "it is there";
  const auto before = votes.carry_over({8, "New", "x"}, nobody);
  ASSERT_TRUE(before);
  EXPECT_EQ(before->client, kTarget.client);
  EXPECT_EQ(before->name, "Bad");
  EXPECT_TRUE(votes.open_against(8));
  EXPECT_FALSE(votes.open_against(kTarget.client));
  EXPECT_TRUE(votes.cast("b", {8, "New", "x"}, kThree, 1).passed());
  EXPECT_FALSE(votes.open_against(8));
}

TEST(KickVotes, WhoGoesOnFromAnotherMachineIsOutAtBoth) {
  KickVotes votes;
  votes.cast("a", kTarget, kThree, 0);
  votes.moved(kTarget.client, "z");
  votes.moved(99, "not concerned");
  EXPECT_TRUE(votes.cast("b", {7, "Bad", "z"}, kThree, 1).passed());
  EXPECT_GT(votes.out_us("x", 1), 0);
  EXPECT_GT(votes.out_us("z", 1), 0);
  EXPECT_EQ(votes.out_us("not concerned", 1), 0);
}

TEST(KickVotes, ConcernsTheOthersOfTheMachineWhileTheTargetIsThere) {
  KickVotes votes;
  votes.cast("a", kTarget, kThree, 0);
  EXPECT_TRUE(votes.open_against_another("x", 8, everybody));
  EXPECT_FALSE(votes.open_against_another("x", kTarget.client, everybody)) << "its own";
  EXPECT_FALSE(votes.open_against_another("x", 8, nobody)) << "then it is carried over";
  EXPECT_FALSE(votes.open_against_another("y", 8, everybody));
  votes.close(kTarget.client);
  EXPECT_FALSE(votes.open_against_another("x", 8, everybody));
}

TEST(KickVotes, WhatWasDecidedHoldsUntilAMatchIsOverAndNotForever) {
  KickVotes votes;
  votes.put_out("x", 5);
  EXPECT_EQ(votes.out_us("x", 5), KickVotes::kOutUs);
  EXPECT_EQ(votes.out_us("y", 5), 0);
  EXPECT_EQ(votes.out_us("x", 4 + KickVotes::kOutUs), 1);
  EXPECT_EQ(votes.out_us("x", 5 + KickVotes::kOutUs), 0);
  votes.put_out("x", 5);
  votes.begin_anew();
  EXPECT_EQ(votes.out_us("x", 6), 0);
}

TEST(KickVotes, AVoteOfOneMatchIsOverInTheNext) {
  KickVotes votes;
  votes.cast("a", kTarget, kThree, 0);
  EXPECT_EQ(votes.expire(1), 0u);
  votes.begin_anew();
  EXPECT_EQ(votes.expire(1), kTarget.client);
  EXPECT_EQ(votes.cast("b", kTarget, kThree, 2).votes, 1) << "a's vote was of the other match";
}

}  // namespace
}  // namespace server
