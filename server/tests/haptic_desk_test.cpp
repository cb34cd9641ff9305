#include "haptic_desk.h"

#include <gtest/gtest.h>

#include <vector>

#include "seats.h"

namespace server {
namespace {

using cabinet::HapticPulse;

struct Motors final : cabinet::HapticSink {
  void pulse(const HapticPulse& pulse) override { felt.push_back(pulse); }
  std::vector<HapticPulse> felt;
};

foosball::Event hit(int rod, double impulse, int team) {
  foosball::Event event{};
  event.kind = foosball::EventKind::man_hit;
  event.rod = static_cast<std::uint8_t>(rod);
  event.team = static_cast<std::uint8_t>(team);
  event.value = impulse;
  return event;
}

class HapticDeskTest : public testing::Test {
 protected:
  HapticDeskTest() {
    haptics.to_cabinet(&motors);
    haptics.to_clients([this](std::uint32_t client, const HapticPulse& pulse) {
      clients.emplace_back(client, pulse);
    });
  }
  void feel(const std::vector<foosball::Event>& events) {
    now_us += 1'000'000;
    desk.poll(now_us);
    haptics.feel(events, match.view(), desk, now_us);
  }
  // The client drives these rods.
  void drive(std::uint32_t client, RodSet rods) {
    RemoteSource* source = desk.seat(client, rods, now_us);
    wire::InputDatagram input{.sequence = 1};
    for (wire::InputRod& rod : input.rods) rod.driven = true;
    ASSERT_TRUE(source->accept(input, now_us + 1'000'000));
  }

  foosball::MatchDesc desc;
  foosball::Match match = std::move(*foosball::Match::create(desc));
  RodDesk desk{desc, {false, true}, false, {}, match.view()};
  HapticDesk haptics{true};
  Motors motors;
  std::vector<std::pair<std::uint32_t, HapticPulse>> clients;
  std::int64_t now_us = 1'000'000;
};

TEST_F(HapticDeskTest, AHitIsFeltByTheClientThatHasTheRodBeforeTheCallReturns) {
  drive(7, 0b1);
  feel({hit(0, 0.2, 0)});
  ASSERT_EQ(clients.size(), 1u);
  EXPECT_EQ(clients[0].first, 7u);
  const double restitution =
      match.view().bodies[0].restitution * match.view().tuning.man_restitution;
  EXPECT_EQ(clients[0].second, *cabinet::haptic_pulse(0, 0.2, restitution));
  EXPECT_TRUE(motors.felt.empty());
  EXPECT_EQ(haptics.pulses(), 1u);
}

TEST_F(HapticDeskTest, NobodyFeelsRodsOfTheComputerOrOfNobodyNorWhatIsNoMansHit) {
  drive(7, 0b1);
  const int computers = foosball::rods_of_team(foosball::table_spec(desc.layout), 1)[0];
  foosball::Event wall = hit(0, 0.2, 0);
  wall.kind = foosball::EventKind::wall_hit;
  feel({hit(computers, 0.2, 1), hit(1, 0.2, 0), wall, hit(0, 0.001, 0)});
  EXPECT_TRUE(clients.empty());
  EXPECT_TRUE(motors.felt.empty());
  EXPECT_EQ(haptics.pulses(), 0u);
}

TEST_F(HapticDeskTest, SwitchedOffOrWithNothingAttachedNothingHappens) {
  drive(7, 0b1);
  HapticDesk off(false);
  off.to_clients([](std::uint32_t, const HapticPulse&) { FAIL(); });
  off.feel(std::vector{hit(0, 0.2, 0)}, match.view(), desk, now_us);
  HapticDesk nothing(true);
  desk.poll(now_us += 1'000'000);
  nothing.feel(std::vector{hit(0, 0.2, 0)}, match.view(), desk, now_us);
  EXPECT_EQ(off.pulses(), 0u);
}

TEST_F(HapticDeskTest, ABallThatIsPinchedIsBounded) {
  drive(7, 0b1);
  const std::vector events{hit(0, 0.6, 0)};
  desk.poll(now_us += 1'000'000);
  double energy_ms = 0.0;
  for (int tick = 0; tick < 10'000; ++tick)
    haptics.feel(events, match.view(), desk, now_us += 1'000);
  for (const auto& [client, pulse] : clients)
    energy_ms += static_cast<double>(pulse.strength * pulse.strength) * pulse.ms;
  EXPECT_GT(energy_ms, 1'000.0);
  EXPECT_LE(energy_ms, 10'000.0 * cabinet::HapticLimiter::kMeanPower +
                           cabinet::HapticLimiter::kPulseEnergyMs + 1.0);
}

}  // namespace
}  // namespace server
