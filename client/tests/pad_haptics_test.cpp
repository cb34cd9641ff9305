#include "core/pad_haptics.h"

#include <gtest/gtest.h>

#include "wire/enums.h"

namespace client {
namespace {

wire::EventSnapshot hit(std::uint8_t rod, float impulse) {
  wire::EventSnapshot event;
  event.kind = number(wire::EventKind::man_hit);
  event.rod = rod;
  event.value = impulse;
  return event;
}

class PadHapticsTest : public testing::Test {
 protected:
  std::vector<cabinet::HapticPulse> feel(std::vector<wire::EventSnapshot> events,
                                         std::uint8_t rods) {
    now_us += 1'000'000;
    return haptics.feel(events, scene, characters, tuning, rods, now_us);
  }
  PadHaptics haptics;
  wire::Snapshot scene;
  foosball::Characters characters = foosball::built_in_characters();
  foosball::Tuning tuning;
  std::int64_t now_us = 0;
};

TEST_F(PadHapticsTest, AHitOfAnOwnRodIsFeltAsTheServerHasItForPhones) {
  const auto pulses = feel({hit(3, 0.2f)}, 0b1000);
  ASSERT_EQ(pulses.size(), 1u);
  const auto& body = foosball::nearest(characters, scene.character[0]).body;
  EXPECT_EQ(pulses[0], *cabinet::haptic_pulse(3, static_cast<double>(0.2f),
                                              body.restitution * tuning.man_restitution));
}

TEST_F(PadHapticsTest, OthersRodsWallsAndSoftTouchesAreNotFelt) {
  EXPECT_TRUE(feel({hit(3, 0.2f)}, 0b0100).empty());
  EXPECT_TRUE(feel({hit(3, 0.005f)}, 0b1000).empty());
  wire::EventSnapshot wall = hit(3, 0.2f);
  wall.kind = number(wire::EventKind::wall_hit);
  EXPECT_TRUE(feel({wall}, 0b1000).empty());
  scene.attract = true;
  EXPECT_TRUE(feel({hit(3, 0.2f)}, 0b1000).empty()) << "nobody plays";
}

TEST_F(PadHapticsTest, NumbersOfAServerThatAreNoneDoNothing) {
  wire::EventSnapshot event = hit(200, 0.2f);
  EXPECT_TRUE(feel({event}, 0xFF).empty());
  event = hit(3, 0.2f);
  event.team = 9;
  EXPECT_TRUE(feel({event}, 0xFF).empty());
  scene.character = {255, 255};
  EXPECT_EQ(feel({hit(3, 0.2f)}, 0xFF).size(), 1u);
}

}  // namespace
}  // namespace client
