// Mice with the kernel's events, replayed through a socket pair. The tests pass the clock in.
#include "cabinet/mouse_source.h"

#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <random>
#include <utility>

#include "simulated_device.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

constexpr double kMetres = 1.5 * 25.4e-6, kRadians = 60 * 25.4e-6;  // per count

struct Desk {
  Descriptor mouse;
  int pc_end = -1;
  int error = ENOENT;
  std::int64_t now_us = 50'000'000;
  MouseSource source;

  explicit Desk(MouseOptions options = {})
      : source(std::move(options), [this] {
          errno = error;
          return std::exchange(pc_end, -1);
        }) {
    plug_in();
    source.poll(now_us);
  }
  void plug_in() {
    int ends[2] = {-1, -1};
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    mouse.fd = ends[0];
    pc_end = ends[1];
  }
  void send(std::uint16_t type, std::uint16_t code, int value, std::int64_t at_us) const {
    mouse.send(event(type, code, value, at_us));
  }
  static Bytes event(std::uint16_t type, std::uint16_t code, int value, std::int64_t at_us) {
    input_event made{};
    made.input_event_sec = at_us / 1'000'000;
    made.input_event_usec = at_us % 1'000'000;
    made.type = type;
    made.code = code;
    made.value = value;
    Bytes bytes(sizeof made);
    std::memcpy(bytes.data(), &made, sizeof made);
    return bytes;
  }
  void move(int right, int forward, std::int64_t at_us) const {
    if (right != 0) send(EV_REL, REL_X, right, at_us);
    if (forward != 0) send(EV_REL, REL_Y, -forward, at_us);
    send(EV_SYN, SYN_REPORT, 0, at_us);
  }
  void step(std::int64_t by_us = 1'000) {
    now_us += by_us;
    source.poll(now_us);
  }
  void rest() {
    for (int ms = 0; ms < 20; ++ms) step();
  }
  const RodInput& rod() const { return source.rods()[3]; }
};

TEST(MouseSource, AMouseMovesItsRodAndNoOther) {
  Desk desk;
  desk.move(100, -40, desk.now_us);
  desk.rest();
  EXPECT_NEAR(desk.rod().slide, 100 * kMetres, 1e-12);
  EXPECT_NEAR(desk.rod().angle, -40 * kRadians, 1e-12);
  for (int rod = 0; rod < kRods; ++rod) {
    EXPECT_EQ(desk.source.rods()[static_cast<std::size_t>(rod)].status,
              rod == 3 ? RodStatus::live : RodStatus::absent);
  }
}

TEST(MouseSource, TwoMiceAreTwoRods) {
  MouseOptions other;
  other.rod = 5;
  Desk left, right(other);
  left.move(10, 0, left.now_us);
  right.move(-20, 0, right.now_us);
  left.rest();
  right.rest();
  EXPECT_NEAR(left.source.rods()[3].slide, 10 * kMetres, 1e-12);
  EXPECT_NEAR(right.source.rods()[5].slide, -20 * kMetres, 1e-12);
  EXPECT_EQ(right.source.rods()[3].status, RodStatus::absent);
}

// A mouse with 125 reports a second, moved at 0.4 m/s: the rod is where the hand is at the poll.
TEST(MouseSource, GoesOnBetweenReportsByTheKernelsTime) {
  Desk desk;
  const std::int64_t began = desk.now_us;
  const double counts_per_us = 0.4 / 25.4;  // 0.4 m/s
  std::int64_t due = began + 8'000, sent = 0;
  double worst = 0;
  for (int ms = 1; ms < 300; ++ms) {
    for (; due <= desk.now_us + 1'000; due += 8'000) {
      const auto counts =
          static_cast<std::int64_t>(counts_per_us * static_cast<double>(due - began));
      desk.move(static_cast<int>(counts - sent), 0, due);
      sent = counts;
    }
    desk.step();
    const double hand = counts_per_us * static_cast<double>(desk.now_us - began) * kMetres;
    if (ms > 60) worst = std::max(worst, std::abs(desk.rod().slide - hand));
  }
  EXPECT_LT(worst, 0.0006);  // 4.8 mm per report; the assumed braking takes 0.48 mm
}

TEST(MouseSource, AHandThatStopsIsAtRestWhenItsNextReportDoesNotCome) {
  Desk desk;
  for (int report = 0; report < 10; ++report) {
    desk.move(0, 20, desk.now_us + 1'000);
    desk.step();
  }
  EXPECT_GT(desk.rod().angle_rate, 20);
  desk.step();
  desk.step();
  EXPECT_EQ(desk.rod().angle_rate, 0);
  EXPECT_NEAR(desk.rod().angle, 200 * kRadians, 1e-12);
}

TEST(MouseSource, LatencyIsCountedFromTheKernelsStamp) {
  Desk desk;
  desk.move(1, 0, desk.now_us + 300);
  desk.step();  // 700 us later
  desk.move(1, 0, desk.now_us + 900);
  desk.step();  // 100
  EXPECT_EQ(desk.source.counters().stamped, 2u);
  EXPECT_EQ(desk.source.counters().latency_sum_us, 800u);
  EXPECT_EQ(desk.source.counters().latency_max_us, 700u);
}

TEST(MouseSource, AStampOfNoTimeCountsAsNow) {
  Desk desk;
  for (const std::int64_t stamp : {std::int64_t{0}, std::int64_t{-5'000'000}, desk.now_us + 900'000,
                                   desk.now_us - 2'000'000, std::int64_t{9'000'000'000'000'000}}) {
    desk.move(1, 0, stamp);
    desk.step();
  }
  EXPECT_EQ(desk.source.counters().stale, 5u);
  EXPECT_EQ(desk.source.counters().latency_max_us, 0u);
  desk.rest();
  EXPECT_NEAR(desk.rod().slide, 5 * kMetres, 1e-12);
}

TEST(MouseSource, WhatTheKernelDroppedMovesNothingAndIsCounted) {
  Desk desk;
  desk.send(EV_REL, REL_X, 50, desk.now_us);
  desk.send(EV_SYN, SYN_DROPPED, 0, desk.now_us);
  desk.send(EV_REL, REL_X, 7, desk.now_us);
  desk.send(EV_SYN, SYN_REPORT, 0, desk.now_us);
  desk.step();
  EXPECT_EQ(desk.rod().slide, 0);
  EXPECT_EQ(desk.source.counters().lost, 1u);
  desk.move(3, 0, desk.now_us);
  desk.rest();
  EXPECT_NEAR(desk.rod().slide, 3 * kMetres, 1e-12);
}

TEST(MouseSource, MotionsThatNoRodCanMakeMoveNothing) {
  Desk desk;
  for (const int counts : {2'147'483'647, -2'147'483'647, 100'000}) {
    desk.move(counts, 0, desk.now_us);
    desk.step();
    desk.move(0, counts, desk.now_us);
    desk.step();
  }
  EXPECT_EQ(desk.source.counters().impossible, 6u);
  EXPECT_EQ(desk.rod().slide, 0);
  EXPECT_EQ(desk.rod().angle, 0);
}

TEST(MouseSource, UnpluggedItsRodHoldsAndGoesOnWhenItIsBack) {
  Desk desk;
  desk.move(100, 0, desk.now_us);
  desk.step();
  desk.mouse.close();
  desk.step();
  EXPECT_EQ(desk.source.state(), DeviceState::missing);
  EXPECT_EQ(desk.rod().status, RodStatus::held);
  EXPECT_EQ(desk.rod().slide_rate, 0);
  EXPECT_NEAR(desk.rod().slide, 100 * kMetres, 1e-12);
  desk.plug_in();
  for (int ms = 0; ms < 250; ++ms) desk.step();
  EXPECT_EQ(desk.source.state(), DeviceState::live);
  EXPECT_EQ(desk.source.counters().reopened, 1u);
  desk.move(-100, 0, desk.now_us);
  desk.rest();
  EXPECT_NEAR(desk.rod().slide, 0, 1e-12);
}

TEST(MouseSource, TheStopTakesOutWhatGoesBeyondIt) {
  MouseOptions options;
  options.slide_limit = 0.01;
  Desk desk(options);
  for (int i = 0; i < 10; ++i) {
    desk.move(100, 0, desk.now_us);
    desk.step();
    EXPECT_LE(desk.rod().slide, 0.01);
  }
  desk.rest();
  EXPECT_EQ(desk.rod().slide, 0.01);
  desk.move(-100, 0, desk.now_us);
  desk.rest();
  EXPECT_NEAR(desk.rod().slide, 0.01 - 100 * kMetres, 1e-12);
}

TEST(MouseSource, WhyItIsNotOpenIsSaid) {
  Desk desk;
  desk.mouse.close();
  desk.step();
  desk.error = EACCES;
  desk.step(300'000);
  EXPECT_EQ(desk.source.state(), DeviceState::refused);
  EXPECT_EQ(desk.source.open_error(), EACCES);
}

TEST(MouseSource, EventsCutAnywhereArriveWhole) {
  Desk desk;
  const Bytes move = Desk::event(EV_REL, REL_X, 5, desk.now_us);
  const Bytes end = Desk::event(EV_SYN, SYN_REPORT, 0, desk.now_us);
  for (std::size_t at = 1; at < move.size(); ++at) {
    desk.mouse.send(Bytes(move.begin(), move.begin() + static_cast<std::ptrdiff_t>(at)));
    desk.step();
    desk.mouse.send(Bytes(move.begin() + static_cast<std::ptrdiff_t>(at), move.end()));
    desk.mouse.send(end);
    desk.step();
  }
  desk.rest();
  EXPECT_NEAR(desk.rod().slide, 5 * static_cast<double>(move.size() - 1) * kMetres, 1e-9);
}

TEST(MouseSource, RandomBytesAreCountedAndKeepRodsWhereARodCanBe) {
  Desk desk;
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    Bytes noise(480);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random() % 4 == 0 ? random() % 4 : 0);
    desk.mouse.send(noise);
    desk.step();
    ASSERT_TRUE(std::isfinite(desk.rod().slide) && std::isfinite(desk.rod().slide_rate));
    ASSERT_LE(std::abs(desk.rod().slide), 10 * 0.02 * 20 * (i + 1));
  }
}

TEST(MouseAddress, NamesAMouseAndARod) {
  const auto plain = parse_mouse_address("evdev:/dev/input/event5");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->path, "/dev/input/event5");
  EXPECT_EQ(plain->rod, -1);
  const auto rod = parse_mouse_address("evdev:/dev/input/by-path/pci-0000:00:14.0-event-mouse:8");
  ASSERT_TRUE(rod);
  EXPECT_EQ(rod->path, "/dev/input/by-path/pci-0000:00:14.0-event-mouse");
  EXPECT_EQ(rod->rod, 7);
  for (const char* wrong : {"evdev:", "evdev:event5", "hid:/dev/hidraw0", "evdev::4", ""}) {
    const auto address = parse_mouse_address(wrong);
    ASSERT_FALSE(address) << wrong;
    EXPECT_NE(address.error().find("write evdev:/dev/input/eventN"), std::string::npos);
  }
  for (const char* wrong :
       {"evdev:/dev/input/event5:0", "evdev:/dev/input/event5:9", "evdev:/dev/input/event5:1.5",
        "evdev:/dev/input/event5:1,2", "evdev:/dev/input/event5:a", "evdev:/dev/input/event5:-1"}) {
    ASSERT_FALSE(parse_mouse_address(wrong)) << wrong;
    EXPECT_NE(parse_mouse_address(wrong).error().find("has no rod: append one from 1"),
              std::string::npos);
  }
}

TEST(OpenMouse, WhatIsNoMouseIsRefusedWithASentence) {
  const auto sentence = [](const char* path) {
    MouseOptions options;
    options.name = path;
    const auto source = open_mouse(path, options);
    return source ? std::string() : source.error();
  };
  EXPECT_NE(sentence("/etc/passwd").find("not a device; space-foosball-doctor"), std::string::npos);
  EXPECT_NE(sentence("/dev/null").find("not a mouse; space-foosball-doctor"), std::string::npos);
  EXPECT_EQ(sentence("/dev/input/event-that-comes-later"), "");
}

}  // namespace
