// From a sensor to the snapshot that the renderer receives; all parts are real except the mice and
// the clock.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "cabinet_rig.h"
#include "foosball/match.h"
#include "foosball/table.h"

namespace {

using end_to_end::CabinetRig;

constexpr double kPi = 3.14159265358979323846;
constexpr double kCountsPerMetre = 8000;  // 8 counts per millimetre of surface
constexpr double kRodRadius = 0.008;      // [m]

int slide_counts(double metres) {
  return static_cast<int>(std::lround(metres * kCountsPerMetre));
}
int spin_counts(double radians) {
  return static_cast<int>(std::lround(radians * kRodRadius * kCountsPerMetre));
}

bool shows(const wire::RodSnapshot& rod, double slide, double angle) {
  return std::abs(rod.slide - slide) <= 0.0005 && std::abs(rod.angle - angle) <= kPi / 180;
}

TEST(CabinetToSnapshot, MouseThreeMovesRodThreeAndNoOther) {
  CabinetRig rig(foosball::Layout::tournament);
  const wire::Snapshot before = rig.step();
  firmware_sim::SimMouse& mouse = rig.cabinet().mouse(3);

  // A stroke of 80 ms: 40 mm along, 90 degrees around.
  constexpr int kStrokeMs = 80;
  const int slide = slide_counts(0.040), spin = spin_counts(kPi / 2);
  std::uint64_t first_packet_us = 0;
  int first_sign_ticks = -1, settled_ticks = -1;
  const std::uint64_t packets = mouse.packets_sent();
  int given_slide = 0, given_spin = 0;
  for (int ms = 1; ms <= kStrokeMs + 1000; ++ms) {
    const int part = std::min(ms, kStrokeMs);
    const int to_slide = slide * part / kStrokeMs, to_spin = spin * part / kStrokeMs;
    mouse.move(to_slide - given_slide, to_spin - given_spin);
    given_slide = to_slide;
    given_spin = to_spin;

    const wire::Snapshot& now = rig.step();
    const std::uint64_t now_us = rig.cabinet().now_us();
    if (first_packet_us == 0 && mouse.packets_sent() > packets) {
      first_packet_us = mouse.last_packet_us();
    }
    if (first_sign_ticks < 0 && std::abs(now.rods[3].slide - before.rods[3].slide) > 5e-5) {
      first_sign_ticks = static_cast<int>((now_us - first_packet_us + 999) / 1000);
    }
    if (ms > kStrokeMs && mouse.settled() && settled_ticks < 0 &&
        shows(now.rods[3], before.rods[3].slide + 0.040, before.rods[3].angle + kPi / 2)) {
      settled_ticks = static_cast<int>((now_us - mouse.last_packet_us() + 999) / 1000);
    }
  }
  const wire::Snapshot& after = rig.step();

  EXPECT_NEAR(after.rods[3].slide - before.rods[3].slide, 0.040, 0.0005);
  EXPECT_NEAR(after.rods[3].angle - before.rods[3].angle, kPi / 2, kPi / 180);
  for (int rod = 0; rod < 8; ++rod) {
    if (rod == 3) continue;
    EXPECT_NEAR(after.rods[rod].slide, before.rods[rod].slide, 2e-5) << "rod " << rod;
    EXPECT_NEAR(after.rods[rod].angle, before.rods[rod].angle, 2e-4) << "rod " << rod;
  }
  EXPECT_EQ(rig.snapshots_missed(), 0);
  ASSERT_GE(first_sign_ticks, 0) << "the rod never stirred";
  ASSERT_GE(settled_ticks, 0) << "the rod never arrived";
  EXPECT_LE(settled_ticks, 50);  // measured: 3 to 30, depending on the phase of the last packet
  // The report after the packet, the tick after the report, and the acceleration of the rod.
  EXPECT_LE(first_sign_ticks, 5);
  std::printf(
      "from the first PS/2 packet to a snapshot in which the rod has moved 0.05 mm: %d ticks\n"
      "from the last PS/2 packet to the first snapshot with 40 mm +-0.5 and 90 degrees +-1: %d "
      "ticks\n",
      first_sign_ticks, settled_ticks);
}

constexpr std::uint8_t kHeld = static_cast<std::uint8_t>(cabinet::RodStatus::held);
constexpr std::uint8_t kLive = static_cast<std::uint8_t>(cabinet::RodStatus::live);

// Steps until every rod has the status; returns the number of ticks, or -1 after `most`.
int ticks_until(CabinetRig& rig, std::uint8_t status, int max) {
  for (int tick = 1; tick <= max; ++tick) {
    const wire::Snapshot& now = rig.step();
    if (std::all_of(now.rods.begin(), now.rods.end(),
                    [&](const wire::RodSnapshot& rod) { return rod.status == status; })) {
      return tick;
    }
  }
  return -1;
}

// The text of the next notice of this level that names the cabinet.
std::string notice_of_cabinet(CabinetRig& rig, wire::Notice::Level level) {
  while (const auto notice = rig.next_notice()) {
    if (notice->level == level && notice->text.find("cabinet") != std::string::npos) {
      return notice->text;
    }
  }
  return {};
}

TEST(CabinetToSnapshot, AnUnpluggedCabinetHoldsItsRodsIsNamedAndComesBackWithoutAJump) {
  CabinetRig rig(foosball::Layout::tournament);
  rig.cabinet().mouse(3).move(slide_counts(0.03), spin_counts(1.0));
  for (int ms = 0; ms < 500; ++ms) rig.step();
  const wire::Snapshot before = rig.step();
  ASSERT_NEAR(before.rods[3].slide, 0.03, 0.0005);
  rig.notices();

  rig.unplug();
  const int noticed = ticks_until(rig, kHeld, 1000);
  ASSERT_GE(noticed, 0) << "the server never noticed";
  EXPECT_LE(noticed, 100);
  EXPECT_NE(notice_of_cabinet(rig, wire::Notice::Level::warning), "")
      << "no client was told which device is gone";
  rig.cabinet().mouse(3).move(slide_counts(-0.05), 0);  // a hand continues to pull
  for (int ms = 0; ms < 1000; ++ms) rig.step();
  EXPECT_NEAR(rig.step().rods[3].slide, before.rods[3].slide, 0.0005);

  rig.plug_in();
  const int back = ticks_until(rig, kLive, 5000);
  ASSERT_GE(back, 0) << "it never came back";
  EXPECT_LE(back, 2000);
  EXPECT_NE(notice_of_cabinet(rig, wire::Notice::Level::cleared), "")
      << "no client was told that it is back";
  for (int ms = 0; ms < 300; ++ms) {
    const wire::RodSnapshot& rod = rig.step().rods[3];
    ASSERT_NEAR(rod.slide, before.rods[3].slide, 0.0005) << "it jumped";
    ASSERT_NEAR(rod.angle, before.rods[3].angle, kPi / 180) << "it jumped";
  }
  rig.cabinet().mouse(3).move(slide_counts(0.01), 0);
  for (int ms = 0; ms < 300; ++ms) rig.step();
  EXPECT_NEAR(rig.step().rods[3].slide, before.rods[3].slide + 0.01, 0.0005);
  std::printf("unplugged: held after %d ticks; plugged in again: live after %d\n", noticed, back);
}

TEST(CabinetToSnapshot, EightMiceAtOnceLoseNoCountInTenSeconds) {
  CabinetRig rig(foosball::Layout::tournament);
  rig.step();
  const cabinet::RodInputs begin = rig.tap().rods();
  const foosball::TableSpec& table = foosball::table_spec(foosball::Layout::tournament);
  std::mt19937_64 random(2);
  std::array<int, 8> slide{}, spin{};
  for (int ms = 0; ms < 10'000; ++ms) {
    for (int rod = 0; rod < 8; ++rod) {
      const int reach = slide_counts(0.9 * table.rods[static_cast<std::size_t>(rod)].slide_limit);
      const int along = static_cast<int>(random() % 9) - 4;  // up to 0.5 m/s
      const int around =
          static_cast<int>(random() % 20) - 5;  // 70 rad/s on average, so that the counts wrap
      if (std::abs(slide[rod] + along) > reach) continue;
      rig.cabinet().mouse(rod).move(along, around);
      slide[rod] += along;
      spin[rod] += around;
    }
    rig.step();
  }
  for (int ms = 0; ms < 1000; ++ms) rig.step();

  std::uint64_t reports = 0;
  for (int rod = 0; rod < 8; ++rod) {
    const cabinet::RodInput& end = rig.tap().rods()[static_cast<std::size_t>(rod)];
    const cabinet::RodInput& start = begin[static_cast<std::size_t>(rod)];
    EXPECT_EQ(std::lround((end.slide - start.slide) * kCountsPerMetre), slide[rod])
        << "rod " << rod;
    EXPECT_EQ(std::lround((end.angle - start.angle) * kRodRadius * kCountsPerMetre), spin[rod])
        << "rod " << rod;
    reports += rig.cabinet().mouse(rod).packets_sent();
    const wire::RodSnapshot& drawn = rig.step().rods[static_cast<std::size_t>(rod)];
    EXPECT_NEAR(drawn.slide, slide[rod] / kCountsPerMetre, 0.0005) << "rod " << rod;
  }
  EXPECT_GE(reports, 8u * 10u * 190u) << "the mice did not report at 200 a second";
  EXPECT_EQ(rig.tap().counters().bad, 0u);
  EXPECT_EQ(rig.tap().counters().lost, 0u);
  EXPECT_EQ(rig.tap().counters().line_errors, 0u);
  EXPECT_EQ(rig.snapshots_missed(), 0);
  std::printf("8 mice, 10 s: %llu packets, no count lost\n",
              static_cast<unsigned long long>(reports));
}

// From a hit in the physics through the server's command and the controller's real firmware to a
// motor.
TEST(CabinetToSnapshot, AHitIsFeltAtTheMotorOfItsRod) {
  CabinetRig rig(foosball::Layout::tournament);
  firmware_sim::MotorBus& motors = rig.cabinet().motors();
  const auto played = [&] {
    return std::ranges::count_if(motors.writes(), [](const firmware_sim::MotorBus::Write& write) {
      return write.address == 2 && write.value != 0;
    });
  };
  // Slides of 0.12 m begin the match; then the men rotate continuously.
  bool playing = false;
  unsigned hit = 0;  // rods, one bit each
  for (int ms = 0; ms < 30'000 && played() < 5; ++ms) {
    const int along = playing ? (ms / 50 % 2 == 0 ? 2 : -2) : (ms / 100 % 2 == 0 ? 10 : -10);
    for (int rod = 0; rod < 8; ++rod) rig.cabinet().mouse(rod).move(along, playing ? 3 : 0);
    const wire::Snapshot& now = rig.step();
    playing = now.ball_in_play || playing;
    for (const wire::EventSnapshot& event : now.events) {
      if (event.kind == static_cast<std::uint8_t>(foosball::EventKind::man_hit))
        hit |= 1u << event.rod;
    }
  }
  for (const firmware_sim::MotorBus::Write& write : motors.writes()) {
    if (write.address == 2 && write.value != 0) {
      EXPECT_NE(hit >> write.rod & 1u, 0u) << "rod " << write.rod;
    }
  }
  EXPECT_GE(played(), 5);
  EXPECT_GE(static_cast<std::ptrdiff_t>(rig.haptic_pulses()), played());
  EXPECT_EQ(motors.violations(), std::vector<std::string>{});
  EXPECT_EQ(rig.tap().counters().line_errors, 0u);
}

}  // namespace
