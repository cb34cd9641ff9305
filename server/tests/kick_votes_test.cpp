// Votes against a player, without sockets, in fake time.
#include "kick_votes.h"

#include <gtest/gtest.h>

namespace server {
namespace {

using Machines = std::vector<std::string>;
constexpr std::uint32_t kTarget = 7;
const Machines kThree{"a", "b", "c"}, kTwo{"a", "b"};

TEST(KickVotes, MoreThanHalfOfTheOthersDecideAndNeverOneAlone) {
  KickVotes votes;
  EXPECT_EQ(votes.cast("a", kTarget, "x", kTwo, 0).needed, 2);
  EXPECT_TRUE(votes.cast("b", kTarget, "x", kTwo, 1).passed());
  EXPECT_FALSE(votes.any());
  const Machines five{"a", "b", "c", "d", "e"};
  KickVotes more;
  EXPECT_EQ(more.cast("a", kTarget, "x", five, 0).needed, 3);
  EXPECT_FALSE(more.cast("b", kTarget, "x", five, 0).passed());
  EXPECT_TRUE(more.cast("c", kTarget, "x", five, 0).passed());
  KickVotes again;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(again.cast("a", kTarget, "x", kThree, i).passed());
}

TEST(KickVotes, AMachineBeginsOneVoteAMinuteAndAgreesAtAnyTime) {
  KickVotes votes;
  EXPECT_TRUE(votes.cast("a", 1, "x", kThree, 0).taken);
  EXPECT_FALSE(votes.cast("a", 2, "y", kThree, 1).taken) << "another victim is another vote";
  EXPECT_TRUE(votes.cast("b", 2, "y", kThree, 1).taken);
  EXPECT_TRUE(votes.cast("a", 2, "y", kThree, 2).passed());
  EXPECT_EQ(votes.expire(KickVotes::kOpenUs), 1u);
  EXPECT_FALSE(votes.cast("a", 1, "x", kThree, KickVotes::kEveryUs - 1).taken);
  EXPECT_TRUE(votes.cast("a", 1, "x", kThree, KickVotes::kEveryUs).taken);
}

TEST(KickVotes, OfThoseWhoHaveLeftNoVoteCounts) {
  KickVotes votes;
  votes.cast("gone", kTarget, "x", Machines{"gone", "a", "b"}, 0);
  EXPECT_EQ(votes.cast("a", kTarget, "x", kTwo, 1).votes, 1);
}

TEST(KickVotes, WhoLeavesAndComesAnewIsStillTheOne) {
  KickVotes votes;
  votes.cast("a", kTarget, "x", kThree, 0);
  const auto nobody = [](std::uint32_t) { return false; };
  EXPECT_EQ(votes.carry_over("y", 8, nobody), 0u) << "from elsewhere";
  EXPECT_EQ(votes.carry_over("x", 8, [](std::uint32_t) { return true; }), 0u) << "it is there";
  EXPECT_EQ(votes.carry_over("x", 8, nobody), kTarget);
  EXPECT_TRUE(votes.cast("b", 8, "x", kThree, 1).passed());
}

TEST(KickVotes, WhatWasDecidedHoldsUntilTheMatchIsOver) {
  KickVotes votes;
  votes.put_out("x");
  EXPECT_TRUE(votes.is_out("x"));
  EXPECT_FALSE(votes.is_out("y"));
  votes.begin_anew();
  EXPECT_FALSE(votes.is_out("x"));
}

TEST(KickVotes, AVoteOfOneMatchIsOverInTheNext) {
  KickVotes votes;
  votes.cast("a", kTarget, "x", kThree, 0);
  EXPECT_EQ(votes.expire(1), 0u);
  votes.begin_anew();
  EXPECT_EQ(votes.expire(1), kTarget);
  EXPECT_EQ(votes.cast("b", kTarget, "x", kThree, 2).votes, 1) << "a's vote was of the other match";
}

}  // namespace
}  // namespace server
