// The core with simulated mice, on the PC.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "host_rig.h"

namespace firmware_sim {
namespace {

constexpr std::uint8_t kAll = 0xFF;
using Bytes = std::vector<std::uint8_t>;
const Bytes kBringUp{0xFF, 0xF3, 200, 0xE8, 3, 0xEA, 0xF4};
const Bytes kAfterPowerOn{0xF3, 200, 0xE8, 3, 0xEA, 0xF4};

bool all_present(HostRig& rig, int limit_ms = 3000) {
  return rig.advance_until([&] { return rig.present() == kAll; }, limit_ms);
}

void settle(HostRig& rig) {
  rig.advance_until(
      [&] {
        return std::all_of(rig.mice.begin(), rig.mice.end(),
                           [](const SimMouse& m) { return m.settled(); });
      },
      2000);
  rig.advance_us(2000);
}

class AtEachClock : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Hertz, AtEachClock, testing::Values(10'000u, 12'500u, 14'300u, 16'700u));

// The reset command is abandoned while the mouse receives it.
TEST(BringUp, AMouseThatWakesWhileItIsAskedIsNoLineError) {
  for (std::uint32_t ms = 360; ms < 400; ++ms) {
    MouseOptions options;
    options.self_test_ms = ms;
    HostRig rig(options);
    ASSERT_TRUE(all_present(rig)) << ms;
    EXPECT_EQ(rig.frame().quality, 0) << ms;
  }
}

TEST_P(AtEachClock, AllMiceAreSetUpAndCountExactly) {
  MouseOptions options;
  options.clock_hz = GetParam();
  HostRig rig(options);
  ASSERT_TRUE(all_present(rig));
  std::mt19937 random(1);
  std::array<int, 8> slide{}, spin{};
  for (int ms = 0; ms < 1000; ++ms) {
    for (std::size_t i = 0; i < 8; ++i) {
      const int x = static_cast<int>(random() % 81) - 40, y = static_cast<int>(random() % 81) - 40;
      rig.mice[i].move(x, y);
      slide[i] += x;
      spin[i] += y;
    }
    rig.advance_us(1000);
  }
  settle(rig);
  const wire::DeviceFrame frame = rig.frame();
  EXPECT_EQ(frame.quality, 0);
  EXPECT_EQ(frame.flags, 0);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(frame.slide[i], static_cast<std::uint16_t>(slide[i]));
    EXPECT_EQ(frame.spin[i], static_cast<std::uint16_t>(spin[i]));
    EXPECT_GE(rig.mice[i].packets_sent(), 198u);
  }
}

TEST(BringUp, SendsTheWholeScriptToAMouseThatSaysNothingByItself) {
  HostRig rig;
  for (SimMouse& mouse : rig.mice) mouse.lose_announcement();
  ASSERT_TRUE(all_present(rig));
  for (const SimMouse& mouse : rig.mice) EXPECT_EQ(mouse.commands(), kBringUp);
}

TEST(BringUp, TakesTheSelfTestAfterPowerOnForTheReset) {
  HostRig rig;
  ASSERT_TRUE(all_present(rig));
  for (const SimMouse& mouse : rig.mice) EXPECT_EQ(mouse.commands(), kAfterPowerOn);
}

TEST(BringUp, EnablesAllMiceTogetherAndNotBeforeStreamingIsAllowed) {
  HostRig rig;
  for (std::size_t i = 0; i < 8; ++i) {  // each becomes ready at a different time
    MouseOptions options;
    options.self_test_ms = static_cast<std::uint32_t>(300 + 50 * i);
    rig.mice[i].set_options(options);
  }
  rig.host.allow_streaming(false);
  rig.advance_us(1'200'000);
  for (const SimMouse& mouse : rig.mice) {
    EXPECT_EQ(mouse.rate(), 200);
    EXPECT_FALSE(mouse.enabled());
  }
  rig.host.allow_streaming(true);
  int ms = 0;
  const auto enabled = [&](const SimMouse& mouse) { return mouse.enabled(); };
  while (ms < 100 && !std::any_of(rig.mice.begin(), rig.mice.end(), enabled)) {
    rig.advance_us(1000);
    ++ms;
  }
  rig.advance_us(3000);
  EXPECT_LT(ms, 10);
  EXPECT_TRUE(std::all_of(rig.mice.begin(), rig.mice.end(), enabled));
}

TEST(BringUp, MiceThatAreMissingDoNotHoldTheOthersBackForLong) {
  HostRig rig;
  rig.mice[2].unplug();
  rig.mice[5].unplug();
  EXPECT_TRUE(rig.advance_until([&] { return rig.present() == (kAll & ~0x24); }, 1700));
}

TEST(BringUp, RepeatsACommandThatTheMouseDidNotUnderstand) {
  HostRig rig;
  rig.mice[1].misread_command();
  ASSERT_TRUE(all_present(rig));
  EXPECT_EQ(rig.mice[1].rate(), 200);
  EXPECT_EQ(rig.mice[1].counts_per_mm(), 8);
}

TEST(HotPlug, AVanishedMouseIsNoticedAndItsCountsStand) {
  HostRig rig;
  ASSERT_TRUE(all_present(rig));
  rig.mice[3].move(120, -77);
  settle(rig);
  rig.mice[3].unplug();
  EXPECT_TRUE(rig.advance_until([&] { return rig.present() == (kAll & ~8); }, 500));
  EXPECT_EQ(rig.frame().slide[3], 120);
  EXPECT_EQ(rig.frame().spin[3], static_cast<std::uint16_t>(-77));
}

// Time until a mouse is enabled again after a loose contact, while its rod moves.
int ms_to_enabled(HostRig& rig, const MouseOptions& options, bool announced) {
  SimMouse& mouse = rig.mice[3];
  mouse.set_options(options);
  mouse.unplug();
  if (!announced) mouse.lose_announcement();
  rig.advance_us(5000);
  mouse.replug();
  for (int ms = 0; ms < 2000; ++ms) {
    if (mouse.enabled() && rig.present() == kAll) return ms;
    mouse.move(1, 0);
    rig.advance_us(1000);
  }
  return 2000;
}

// The self-test ends while the host requests data: by answering, the mouse would no longer announce
// that it has reset. The shortest self-tests take 300 ms, and the host requests data 250 ms after
// the last packet.
TEST(HotPlug, AMouseIsEnabledAgainWheneverItsSelfTestEnds) {
  HostRig rig;
  ASSERT_TRUE(all_present(rig));
  for (const bool announced : {true, false}) {
    for (std::uint32_t after_ms = 0; after_ms < 50; ++after_ms) {
      MouseOptions options;
      options.self_test_ms = 300 + after_ms;
      EXPECT_LT(ms_to_enabled(rig, options, announced), 1600)
          << "self-test of " << options.self_test_ms << " ms, announced: " << announced;
      settle(rig);
      options.self_test_ms = 300;
      rig.advance_us(5000ull * after_ms);
      EXPECT_LT(ms_to_enabled(rig, options, announced), 1600)
          << "after " << 5 * after_ms << " ms at rest, announced: " << announced;
      EXPECT_EQ(rig.mice[3].rate(), 200);
      settle(rig);
    }
  }
}

TEST(HotPlug, AMouseThatMovesOnlyWhenAskedIsSetUpAgainAndThatIsCounted) {
  MouseOptions options;
  options.self_test_ms = 100;  // ends unnoticed, before the host requests data
  options.counts_disabled = true;
  HostRig rig;
  ASSERT_TRUE(all_present(rig));
  (void)rig.frame();
  EXPECT_LT(ms_to_enabled(rig, options, false), 1600);
  EXPECT_EQ(rig.frame().flags, 1) << "a re-synchronisation";
}

TEST(HotPlug, AMouseIsBackWithinTwoSecondsAndDoesNotJump) {
  HostRig rig;
  ASSERT_TRUE(all_present(rig));
  rig.mice[3].move(120, -77);
  settle(rig);
  for (const std::uint64_t away_us : {20'000u, 300'000u, 2'000'000u}) {
    rig.mice[3].unplug();
    rig.advance_us(away_us);
    rig.mice[3].replug();
    ASSERT_TRUE(
        rig.advance_until([&] { return rig.mice[3].enabled() && rig.present() == kAll; }, 2000))
        << "away " << away_us << " us";
    const wire::DeviceFrame frame = rig.frame();
    EXPECT_EQ(frame.slide[3], 120);
    EXPECT_EQ(frame.spin[3], static_cast<std::uint16_t>(-77));
  }
  rig.mice[3].move(5, 6);
  settle(rig);
  EXPECT_EQ(rig.frame().slide[3], 125);
}

TEST(HotPlug, AMousePluggedInAgainAtTheGateIsSetUpAgain) {
  HostRig rig;
  rig.host.allow_streaming(false);
  ASSERT_TRUE(rig.advance_until([&] { return rig.host.link(3).waits_at_gate(); }, 2000));
  rig.mice[3].unplug();
  rig.advance_us(20'000);
  rig.mice[3].replug();
  rig.advance_us(1'000'000);
  rig.host.allow_streaming(true);
  ASSERT_TRUE(all_present(rig));
  EXPECT_TRUE(rig.mice[3].enabled());
  EXPECT_EQ(rig.mice[3].rate(), 200);
  EXPECT_EQ(rig.mice[3].counts_per_mm(), 8);
}

TEST(Streaming, AskingASilentMouseLosesNoCount) {
  // Movement that starts at every time around the request, which comes every 250 ms.
  MouseOptions options;
  options.forgets_cut_packets = true;
  HostRig rig(options);
  ASSERT_TRUE(all_present(rig));
  constexpr int kTimes = 200;
  for (int i = 0; i < kTimes; ++i) {
    rig.advance_us(250'000 + 37u * static_cast<unsigned>(i));
    rig.mice[0].move(1, 0);
  }
  settle(rig);
  const auto& commands = rig.mice[0].commands();
  EXPECT_GT(std::count(commands.begin(), commands.end(), 0xEB), 100);
  EXPECT_EQ(rig.present(), kAll);
  EXPECT_EQ(rig.frame().slide[0], kTimes);
}

TEST(Streaming, OverflowSaturatesTheDeltaAndIsReportedOnce) {
  MouseOptions options;
  options.splits_overflow = false;
  HostRig rig(options);
  ASSERT_TRUE(all_present(rig));
  rig.mice[6].move(1000, -1000);
  settle(rig);
  const wire::DeviceFrame frame = rig.frame();
  EXPECT_EQ(frame.slide[6], 255);
  EXPECT_EQ(frame.spin[6], static_cast<std::uint16_t>(-256));
  EXPECT_EQ(frame.overflow, 1u << 6);
  EXPECT_EQ(rig.frame().overflow, 0);
}

TEST(Streaming, CountersWrapAndGoOn) {
  HostRig rig;
  ASSERT_TRUE(all_present(rig));
  rig.mice[0].move(70'000, -70'000);
  settle(rig);
  const wire::DeviceFrame frame = rig.frame();
  EXPECT_EQ(frame.slide[0], static_cast<std::uint16_t>(70'000));
  EXPECT_EQ(frame.spin[0], static_cast<std::uint16_t>(-70'000));
}

TEST(Streaming, AWrongParityIsCountedAndCostsThatPacketOnly) {
  HostRig rig;
  ASSERT_TRUE(all_present(rig));
  rig.mice[4].flip_parity();
  rig.mice[4].move(10, 10);
  settle(rig);
  rig.mice[4].move(7, 8);
  settle(rig);
  const wire::DeviceFrame frame = rig.frame();
  EXPECT_EQ(frame.quality, 1);
  EXPECT_EQ(frame.flags & 1, 1);
  EXPECT_EQ(frame.slide[4], 7);
  EXPECT_EQ(frame.spin[4], 8);
  EXPECT_EQ(rig.frame().quality, 0);
}

// Corrupts each bit of a packet in turn: it is counted, and the next packet is intact.
template <class Spoil>
void expect_to_cost_one_packet(const Spoil& spoil) {
  for (int bit = 0; bit <= 10; ++bit) {
    HostRig rig;
    ASSERT_TRUE(all_present(rig));
    spoil(rig.mice[4], bit);
    rig.mice[4].move(90, 90);
    settle(rig);
    EXPECT_GE(rig.frame().quality, 1) << "bit " << bit;
    rig.mice[4].move(7, 8);
    settle(rig);
    const wire::DeviceFrame frame = rig.frame();
    EXPECT_EQ(frame.slide[4], 7) << "bit " << bit;
    EXPECT_EQ(frame.spin[4], 8) << "bit " << bit;
  }
}

TEST(Streaming, AnyLostBitCostsAtMostThePacketItWasIn) {
  expect_to_cost_one_packet([](auto& mouse, int bit) { mouse.skip_clock(bit); });
}

TEST(Streaming, AClockThatIsStretchedByLessThanAGapLosesNothing) {
  for (int bit = 0; bit <= 10; ++bit) {
    HostRig rig;
    ASSERT_TRUE(all_present(rig));
    rig.mice[4].stretch_clock(bit, 180);
    rig.mice[4].move(90, -91);
    settle(rig);
    const wire::DeviceFrame frame = rig.frame();
    EXPECT_EQ(frame.quality, 0) << "bit " << bit;
    EXPECT_EQ(frame.slide[4], 90) << "bit " << bit;
    EXPECT_EQ(frame.spin[4], static_cast<std::uint16_t>(-91)) << "bit " << bit;
  }
}

TEST(Streaming, AClockThatFallsOnceMoreWithinAByteIsCountedAndCostsThatPacketAtMost) {
  expect_to_cost_one_packet([](auto& mouse, int bit) { mouse.glitch_clock(bit, 25'000); });
}

TEST(Streaming, ALostByteCostsThatPacketOnlyEvenInAStreamOfThem) {
  HostRig rig;
  ASSERT_TRUE(all_present(rig));
  rig.mice[4].lose_byte();
  for (int packet = 0; packet < 100; ++packet) {
    rig.mice[4].move(9, 8);
    rig.advance_us(5000);
  }
  settle(rig);
  const wire::DeviceFrame frame = rig.frame();
  EXPECT_EQ(frame.flags & 1, 1);
  EXPECT_EQ(frame.slide[4], rig.mice[4].slide_sent() - 9);
  EXPECT_EQ(frame.spin[4], rig.mice[4].spin_sent() - 8);
}

TEST(Streaming, ASpikeOnTheClockIsCountedAndMovesNothing) {
  HostRig rig;
  ASSERT_TRUE(all_present(rig));
  rig.mice[7].spike(25'000);
  rig.advance_us(3000);
  EXPECT_EQ(rig.frame().quality, 1);
  rig.mice[7].move(30, 31);
  settle(rig);
  const wire::DeviceFrame frame = rig.frame();
  EXPECT_EQ(frame.slide[7], 30);
  EXPECT_EQ(frame.spin[7], 31);
}

TEST(Frames, AreNumberedAndTimed) {
  HostRig rig;
  rig.advance_us(1000);
  const wire::DeviceFrame first = rig.frame();
  rig.advance_us(1000);
  const wire::DeviceFrame second = rig.frame();
  EXPECT_EQ(second.sequence, first.sequence + 1);
  EXPECT_EQ(second.time_us, first.time_us + 1000);
  EXPECT_EQ(first.present, 0);
}

}  // namespace
}  // namespace firmware_sim
