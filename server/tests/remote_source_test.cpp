#include "remote_source.h"

#include <gtest/gtest.h>

namespace server {
namespace {

using cabinet::RodStatus;

class RemoteSourceTest : public testing::Test {
 protected:
  static wire::InputDatagram input(std::uint32_t sequence, float slide) {
    wire::InputDatagram in;
    in.sequence = sequence;
    for (auto& rod : in.rods) rod = {true, slide, 0.5, 0.25f, 2.0f};
    return in;
  }
  static constexpr std::uint8_t kMine = 0b0001'0111;
  void SetUp() override { source.set_rods(kMine); }
  RemoteSource source{"client"};
};

TEST_F(RemoteSourceTest, DrivesItsOwnRodsOnly) {
  ASSERT_TRUE(source.accept(input(1, 0.03f), 1000));
  for (int rod = 0; rod < cabinet::kRods; ++rod) {
    const bool own = (kMine >> rod & 1) != 0;
    EXPECT_EQ(source.rods()[rod].status, own ? RodStatus::live : RodStatus::absent) << rod;
  }
}

TEST_F(RemoteSourceTest, DropsWhatIsOlderOrTheSame) {
  ASSERT_TRUE(source.accept(input(10, 0.01f), 1000));
  EXPECT_FALSE(source.accept(input(10, 0.02f), 2000));
  EXPECT_FALSE(source.accept(input(9, 0.02f), 2000));
  ASSERT_TRUE(source.accept(input(13, 0.03f), 3000));
  EXPECT_EQ(source.counters().stale, 2u);
  EXPECT_EQ(source.counters().lost, 2u);
  EXPECT_FLOAT_EQ(static_cast<float>(source.rods()[0].slide), 0.03f);
}

TEST_F(RemoteSourceTest, GoesOnWhenTheSequenceWraps) {
  ASSERT_TRUE(source.accept(input(0xFFFFFFFFu, 0.01f), 1000));
  EXPECT_TRUE(source.accept(input(0, 0.02f), 2000));
  EXPECT_EQ(source.counters().lost, 0u);
}

TEST_F(RemoteSourceTest, HoldsItsRodsAfterSilenceAndGoesOnWithTheNextWord) {
  ASSERT_TRUE(source.accept(input(1, 0.03f), 1000));
  source.poll(1000 + RemoteSource::kSilenceUs - 1);
  EXPECT_EQ(source.rods()[0].status, RodStatus::live);
  source.poll(1000 + RemoteSource::kSilenceUs);
  EXPECT_EQ(source.rods()[0].status, RodStatus::held);
  EXPECT_FLOAT_EQ(static_cast<float>(source.rods()[0].slide), 0.03f);
  EXPECT_EQ(source.rods()[0].angle_rate, 0.0);
  ASSERT_TRUE(source.accept(input(2, 0.04f), 400'000));
  EXPECT_EQ(source.rods()[0].status, RodStatus::live);
}

TEST_F(RemoteSourceTest, HoldsARodThatIsNoLongerDrivenAndLeavesAloneOneThatNeverWas) {
  wire::InputDatagram in = input(1, 0.03f);
  in.rods[1].driven = false;
  ASSERT_TRUE(source.accept(in, 1000));
  in = input(2, 0.05f);
  in.rods[0].driven = in.rods[1].driven = false;
  ASSERT_TRUE(source.accept(in, 2000));
  const cabinet::RodInput& rod = source.rods()[0];
  EXPECT_EQ(rod.status, RodStatus::held);
  EXPECT_FLOAT_EQ(static_cast<float>(rod.slide), 0.03f);
  EXPECT_EQ(rod.slide_rate, 0.0);
  EXPECT_EQ(rod.angle_rate, 0.0);
  EXPECT_EQ(source.rods()[1].status, RodStatus::absent);
  ASSERT_TRUE(source.accept(input(3, 0.04f), 3000));
  EXPECT_EQ(rod.status, RodStatus::live);
}

TEST_F(RemoteSourceTest, TakesANewClientsSequenceFromItsStart) {
  ASSERT_TRUE(source.accept(input(500, 0.03f), 1000));
  source.reset(1500);
  source.set_rods(kMine);
  EXPECT_EQ(source.rods()[0].status, RodStatus::absent);
  EXPECT_TRUE(source.accept(input(1, 0.01f), 2000));
}

TEST_F(RemoteSourceTest, IsSilentFromItsComingOnAndNoReturnEndsThat) {
  source.reset(1000);
  source.set_rods(kMine);
  EXPECT_EQ(source.silent_us(5000), 4000);
  ASSERT_TRUE(source.accept(input(1, 0.03f), 6000));
  EXPECT_EQ(source.silent_us(9000), 3000);
  source.resume();
  EXPECT_EQ(source.silent_us(9000), 3000);
  ASSERT_TRUE(source.accept(input(1, 0.03f), 10'000));
  EXPECT_EQ(source.silent_us(10'000), 0);
}

TEST_F(RemoteSourceTest, GivesUpARodWithoutLettingGoOfTheOthers) {
  ASSERT_TRUE(source.accept(input(1, 0.03f), 1000));
  source.set_rods(0b0010'0001);
  EXPECT_EQ(source.rods()[0].status, RodStatus::live);
  EXPECT_EQ(source.rods()[1].status, RodStatus::absent);
  EXPECT_EQ(source.rods()[5].status, RodStatus::absent) << "not heard of yet";
  ASSERT_TRUE(source.accept(input(2, 0.04f), 2000));
  EXPECT_EQ(source.rods()[1].status, RodStatus::absent);
  EXPECT_EQ(source.rods()[5].status, RodStatus::live);
}

TEST_F(RemoteSourceTest, AfterAReturnItsRodsStandAndItsCountBeginsAnew) {
  ASSERT_TRUE(source.accept(input(500, 0.03f), 1000));
  source.poll(900'000);
  source.resume();
  EXPECT_EQ(source.rods()[0].status, RodStatus::held);
  EXPECT_FLOAT_EQ(static_cast<float>(source.rods()[0].slide), 0.03f);
  EXPECT_TRUE(source.accept(input(1, 0.01f), 950'000));
}

}  // namespace
}  // namespace server
