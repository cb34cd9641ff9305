// A cabinet's controller on a socket pair: from its report to the snapshot, unplugged and plugged
// in.
#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <span>

#include "cabinet/device_source.h"
#include "cabinet/mouse_source.h"
#include "lockstep.h"
#include "wire/device_frame.h"

namespace server {
namespace {

class Controller {
 public:
  ~Controller() { unplug(); }

  cabinet::DeviceOpener opener() {
    return [this] { return std::exchange(pc_end_, -1); };
  }
  void plug_in() {
    std::array<int, 2> ends{-1, -1};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    own_end_ = ends[0];
    pc_end_ = ends[1];
  }
  void unplug() {
    if (own_end_ >= 0) ::close(own_end_);
    if (pc_end_ >= 0) ::close(pc_end_);
    own_end_ = pc_end_ = -1;
  }
  void send(std::span<const std::uint8_t> bytes) {
    ASSERT_EQ(::send(own_end_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT),
              static_cast<ssize_t>(bytes.size()));
  }
  // Sends one report; rod 2 has moved on by this many counts.
  void report(int slide_counts, std::uint8_t overflow = 0) {
    frame_.present = 0xFF;
    frame_.overflow = overflow;
    ++frame_.sequence;
    frame_.time_us += 1000;
    frame_.slide[2] = static_cast<std::uint16_t>(frame_.slide[2] + slide_counts);
    std::array<std::uint8_t, wire::kDeviceReportBytes> bytes{};
    wire::encode_device_frame(frame_, bytes.data());
    send(bytes);
  }
  // Sends one report; all rods are this far from their start [counts].
  void sweep(double slide, double spin) {
    for (int rod = 0; rod < wire::kDeviceRods; ++rod) {
      frame_.slide[rod] = static_cast<std::uint16_t>(static_cast<int>(slide));
      frame_.spin[rod] = static_cast<std::uint16_t>(static_cast<int>(spin));
    }
    report(0);
  }

 private:
  int own_end_ = -1, pc_end_ = -1;
  wire::DeviceFrame frame_{};
};

class DeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    controller.plug_in();
    cabinet::DeviceOptions options;
    options.name = "cabinet test";
    options.framing = cabinet::DeviceFraming::report;
    table->add_device(std::make_unique<cabinet::DeviceSource>(options, controller.opener()));
    ASSERT_TRUE(watcher.join());
  }
  // Sends a report before each tick.
  void run(int ticks, int counts = 0) {
    for (int i = 0; i < ticks; ++i) {
      controller.report(counts);
      table.tick();
    }
  }
  wire::Snapshot next_snapshot() {
    while (wait_readable(watcher.udp(), 0)) watcher.snapshot(0);
    table.tick();
    return watcher.snapshot().value_or(wire::Snapshot{});
  }
  std::string notice_text() {
    const auto notice = watcher.receive_a<wire::Notice>();
    return notice ? notice->text : std::string();
  }
  Controller controller;  // outlives the server
  Lockstep table;
  ProbeClient watcher{table.port()};
};

// Latency of one tick: a report is in the snapshot of the tick that follows its arrival.
TEST_F(DeviceTest, AReportIsInTheSnapshotOfTheTickItArrivedBefore) {
  run(20);
  EXPECT_FLOAT_EQ(next_snapshot().rods[2].slide, 0.0f);
  controller.report(8);  // a millimetre
  const wire::Snapshot shown = next_snapshot();
  EXPECT_EQ(shown.rods[2].source, 1);
  EXPECT_EQ(shown.rods[2].status, 1);
  EXPECT_GT(shown.rods[2].slide_rate, 0.0f);
}

TEST_F(DeviceTest, TheRodArrivesWhereTheSensorSays) {
  run(20);
  run(40, 8);  // 40 mm
  run(1000);
  EXPECT_NEAR(table->match().view().rods[2].slide, 0.040, 0.0005);
  EXPECT_NEAR(table->match().view().rods[3].slide, 0.0, 0.0005);
}

// The tick answers a host's request.
std::optional<wire::Devices> answer_to(ProbeClient& client, Lockstep& table) {
  if (!client.send(wire::DeviceQuery{})) return {};
  std::optional<wire::Devices> reported;
  table.tick_until([&] {
    reported = client.receive_a<wire::Devices>(5);
    return reported.has_value();
  });
  return reported;
}

TEST_F(DeviceTest, AHostWhoAsksIsToldWhatItDoes) {
  run(20);
  run(40, 8);  // 40 mm
  run(200);
  const auto reported = answer_to(watcher, table);
  ASSERT_TRUE(reported);
  ASSERT_EQ(reported->devices.size(), 1u);
  const wire::DeviceReport& device = reported->devices[0];
  EXPECT_EQ(device.name, "cabinet test");
  EXPECT_EQ(device.state, number(wire::DeviceState::live));
  EXPECT_EQ(device.frames, 260u);
  EXPECT_EQ(device.lost, 0u);
  EXPECT_EQ(device.rods[2].slide_counts, 320);
  EXPECT_EQ(device.rods[2].spin_counts, 0);
  EXPECT_NEAR(device.rods[2].slide, 0.040f, 0.0005f);
  EXPECT_EQ(device.rods[3].slide_counts, 0);
  EXPECT_EQ(device.rods[2].status, number(wire::RodStatus::live));

  controller.unplug();
  table.tick(100);
  const auto without = answer_to(watcher, table);
  ASSERT_TRUE(without);
  EXPECT_EQ(without->devices[0].state, number(wire::DeviceState::missing));
  EXPECT_EQ(without->devices[0].rods[2].status, number(wire::RodStatus::held));
  EXPECT_EQ(without->devices[0].rods[2].slide_counts, 320);
}

TEST_F(DeviceTest, AFloodOfQuestionsIsAnsweredAtItsPace) {
  run(20);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(watcher.send(wire::DeviceQuery{}));
  int answers = 0;
  watcher.send(wire::Ping{1});
  while (const auto message = watcher.receive()) {
    answers += std::holds_alternative<wire::Devices>(*message) ? 1 : 0;
    if (std::holds_alternative<wire::Pong>(*message)) break;
    table.tick();
  }
  table.tick(50);
  while (watcher.receive_a<wire::Devices>(20)) ++answers;
  EXPECT_GE(answers, 1);
  EXPECT_LE(answers, 5);
  EXPECT_TRUE(watcher.catch_up());
}

TEST_F(DeviceTest, UnpluggedIsToldWithin100MillisecondsAndTheRodsHold) {
  run(20);
  run(40, 8);
  run(500);
  const double where = table->match().view().rods[2].slide;
  controller.unplug();
  const std::int64_t from = table.now_us();
  while (next_snapshot().rods[2].status != 2 && table.now_us() < from + 1'000'000) {
  }
  EXPECT_LE(table.now_us() - from, 100'000);
  const auto notice = watcher.receive_a<wire::Notice>();
  ASSERT_TRUE(notice);
  EXPECT_EQ(notice->text, "cabinet test unplugged: its rods are held; plug it in again");
  table.tick(300);
  EXPECT_NEAR(table->match().view().rods[2].slide, where, 0.0005);

  controller.plug_in();
  const std::int64_t back_from = table.now_us();
  double farthest = 0.0;
  while (next_snapshot().rods[2].status != 1 && table.now_us() < back_from + 3'000'000) {
    controller.report(0);
    farthest = std::max(farthest, std::abs(table->match().view().rods[2].slide - where));
  }
  EXPECT_LE(table.now_us() - back_from, 2'000'000);
  const auto back = watcher.receive_a<wire::Notice>();
  ASSERT_TRUE(back);
  EXPECT_EQ(back->level, wire::Notice::Level::cleared);
  EXPECT_LT(farthest, 0.0005);  // no jump
}

// Messages for a person, each with a remedy.
TEST_F(DeviceTest, ADeviceThatNeverSaysAWordIsToldToBeSilent) {
  table.tick(900);
  EXPECT_FALSE(watcher.receive(0));  // it has a second to start
  table.tick(200);
  EXPECT_EQ(notice_text(),
            "cabinet test is connected but sends nothing: plug it in again, and check its "
            "firmware");
}

TEST_F(DeviceTest, ADeviceThatSendsNoFrameIsToldToBeTheWrongOne) {
  const std::array<std::uint8_t, 64> noise{0x55, 0xAA};
  for (int i = 0; i < 1100; ++i) {
    controller.send(noise);
    table.tick();
  }
  EXPECT_EQ(notice_text(),
            "cabinet test sends no valid frames: is it the right device, with our firmware?");
  EXPECT_EQ(table->devices().at(0).name, "cabinet test");
  EXPECT_EQ(table->devices().at(0).counters.bad, 1100u);
  EXPECT_EQ(table->devices().at(0).counters.frames, 0u);
  run(1);  // its first valid frame
  EXPECT_EQ(notice_text(), "cabinet test is back");
}

// The frame and the screen report it once, for as long as it lasts and a while longer.
TEST_F(DeviceTest, ASensorThatCannotFollowItsRodIsTold) {
  run(20);
  controller.report(8, 1 << 2);
  table.tick();
  EXPECT_EQ(notice_text(),
            "cabinet test: a rod moved faster than its sensor can follow; push it to both stops "
            "once");
  for (int i = 0; i < 3000; ++i) {
    controller.report(8 - 16 * (i & 1), static_cast<std::uint8_t>(i % 500 == 0 ? 1 << 2 : 0));
    table.tick();
  }
  run(5000);
  EXPECT_FALSE(watcher.receive(0)) << "it stands, and is not told again";
  run(3000);
  const auto over = watcher.receive_a<wire::Notice>();
  ASSERT_TRUE(over);
  EXPECT_EQ(over->level, wire::Notice::Level::cleared);
}

// One notice each, in any order of the faults; none while a new one has not lasted a second.
TEST_F(DeviceTest, FromOneFaultToTheNextAPersonIsToldOnce) {
  run(20);
  table.tick(60);
  EXPECT_EQ(notice_text().substr(0, 35), "cabinet test is connected but sends");
  const std::array<std::uint8_t, 64> noise{1, 2, 3};
  for (int i = 0; i < 1100; ++i) {
    controller.send(noise);
    table.tick();
  }
  EXPECT_EQ(notice_text().substr(0, 29), "cabinet test sends no valid f");
  controller.unplug();
  table.tick(1100);
  EXPECT_EQ(notice_text(), "cabinet test unplugged: its rods are held; plug it in again");
  controller.plug_in();
  table.tick(400);  // opened, but still silent
  run(2);
  EXPECT_EQ(notice_text(), "cabinet test is back");
  EXPECT_FALSE(watcher.receive(0));
}

std::optional<wire::Notice> notice_of(std::unique_ptr<cabinet::DeviceSource> device, int ticks) {
  Lockstep table;
  table->add_device(std::move(device));
  ProbeClient watcher(table.port());
  EXPECT_TRUE(watcher.join());
  table.tick(ticks);
  return watcher.receive_a<wire::Notice>();
}

TEST(DeviceWatch, SaysThatADeviceIsNotThere) {
  cabinet::DeviceOptions options;
  options.name = "cabinet nowhere";
  const auto notice =
      notice_of(std::make_unique<cabinet::DeviceSource>(options, [] { return -1; }), 1100);
  ASSERT_TRUE(notice);
  EXPECT_EQ(notice->text, "cabinet nowhere does not exist: plug it in, or give the right address");
}

TEST(DeviceWatch, SaysWhyADeviceThatIsThereCannotBeOpened) {
  const std::pair<int, const char*> reasons[] = {
      {EACCES,
       "cabinet locked cannot be opened: Permission denied; install "
       "cabinet/70-space-foosball.rules or join the device's group"},
      {EBUSY,
       "cabinet locked cannot be opened: Device or resource busy; end the other program that uses "
       "it"},
      {EIO,
       "cabinet locked cannot be opened: Input/output error; plug it in again, or give another "
       "address"},
  };
  for (const auto& [error, sentence] : reasons) {
    cabinet::DeviceOptions options;
    options.name = "cabinet locked";
    const auto notice = notice_of(std::make_unique<cabinet::DeviceSource>(options,
                                                                          [error = error] {
                                                                            errno = error;
                                                                            return -1;
                                                                          }),
                                  1100);
    ASSERT_TRUE(notice);
    EXPECT_EQ(notice->text, sentence);
  }
}

TEST(DeviceWatch, SaysThatARecordingHoldsNoFrame) {
  const std::string path = temp_path("noise.bin");
  std::ofstream(path, std::ios::binary) << std::string(5'000, 'x');
  auto device = cabinet::open_device("file:" + path, cabinet::nominal_calibration());
  std::remove(path.c_str());
  ASSERT_TRUE(device);
  const auto notice = notice_of(std::move(*device), 10);
  ASSERT_TRUE(notice);
  EXPECT_EQ(notice->text, "file:" + path + " contains no frame: give a recording of a controller");
}

// From another machine, with the players' password: the server's devices are not visible.
TEST(DevicesAsked, APlayerIsToldNothing) {
  Lockstep table([](ServerOptions& o) {
    o.access.trust_this_machine = false;
    o.access.password = "open sesame";
  });
  ProbeClient player(table.port());
  ASSERT_TRUE(player.prove("open sesame"));
  ASSERT_TRUE(player.join(0));
  ASSERT_TRUE(player.send(wire::DeviceQuery{}));
  player.send(wire::Ping{1});
  bool reported = false, ponged = false;
  while (!ponged) {
    const auto message = player.receive();
    ASSERT_TRUE(message);
    reported = reported || std::holds_alternative<wire::Devices>(*message);
    ponged = std::holds_alternative<wire::Pong>(*message);
  }
  table.tick(20);
  EXPECT_FALSE(player.receive_a<wire::Devices>(20));
  EXPECT_FALSE(reported);
  EXPECT_EQ(table->counters().control.requests_dropped, 1u);
}

// Two mice, each on a socket pair: each moves its rod, and an unplugged one is reported.
class MiceTest : public testing::Test {
 protected:
  struct Mouse {
    int own_end = -1, pc_end = -1;
  };
  void SetUp() override {
    for (std::size_t i = 0; i < mice.size(); ++i) {
      std::array<int, 2> ends{-1, -1};
      ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
      mice[i] = {ends[0], ends[1]};
      cabinet::MouseOptions options;
      options.name = "mouse " + std::to_string(i + 1);
      options.rod = kRods[i];
      table->add_device(std::make_unique<cabinet::MouseSource>(
          options, [this, i] { return std::exchange(mice[i].pc_end, -1); }));
    }
    ASSERT_TRUE(watcher.join());
    table.tick(20);
  }
  ~MiceTest() override {
    for (const Mouse& mouse : mice) {
      for (const int fd : {mouse.own_end, mouse.pc_end})
        if (fd >= 0) ::close(fd);
    }
  }
  void move(std::size_t mouse, int right) const {
    std::array<input_event, 2> events{};
    events[0].type = EV_REL;
    events[0].code = REL_X;
    events[0].value = right;
    ASSERT_EQ(::send(mice[mouse].own_end, events.data(), sizeof events, MSG_DONTWAIT),
              static_cast<ssize_t>(sizeof events));
  }
  static constexpr std::array<int, 2> kRods = {3, 5};
  std::array<Mouse, 2> mice;  // outlive the server
  Lockstep table;
  ProbeClient watcher{table.port()};
};

TEST_F(MiceTest, EachMovesItsRodAndNoOther) {
  for (int ms = 0; ms < 40; ++ms) {
    move(0, 20);
    move(1, -10);
    table.tick();
  }
  table.tick(1000);
  const double metres = 40 * 1.5 * 25.4e-6;  // of one count per millisecond
  EXPECT_NEAR(table->match().view().rods[3].slide, 20 * metres, 0.0005);
  EXPECT_NEAR(table->match().view().rods[5].slide, -10 * metres, 0.0005);
  EXPECT_NEAR(table->match().view().rods[2].slide, 0, 0.0005);
}

TEST_F(MiceTest, OneThatIsUnpluggedIsToldAndTheOtherGoesOn) {
  ::close(std::exchange(mice[0].own_end, -1));
  table.tick();
  const auto notice = watcher.receive_a<wire::Notice>();
  ASSERT_TRUE(notice);
  EXPECT_EQ(notice->text, "mouse 1 unplugged: its rods are held; plug it in again");
  move(1, 100);
  table.tick(1000);
  EXPECT_NEAR(table->match().view().rods[5].slide, 100 * 1.5 * 25.4e-6, 0.0005);
}

// A ball that hits the rods of a cabinet: the pulses of its motors, and their ticks.
TEST(CabinetHaptics, AHitIsToldInItsTickAndNoneThatIsNot) {
  struct Motors final : cabinet::HapticSink {
    explicit Motors(std::vector<cabinet::HapticPulse>& into) : felt(into) {}
    void pulse(const cabinet::HapticPulse& pulse) override { felt.push_back(pulse); }
    std::vector<cabinet::HapticPulse>& felt;
  };
  Lockstep table([](ServerOptions& o) {
    o.match.rules.goals_to_win = 99;
    o.match.rules.max_goals = 99;
  });
  std::vector<cabinet::HapticPulse> felt;
  Controller controller;
  controller.plug_in();
  cabinet::DeviceOptions options;
  options.framing = cabinet::DeviceFraming::report;
  table->add_device(std::make_unique<cabinet::DeviceSource>(options, controller.opener()));
  table->set_cabinet_haptics(std::make_unique<Motors>(felt));
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join());
  for (const auto screen : {foosball::Screen::selection, foosball::Screen::play}) {
    for (std::uint8_t team = 0; team < foosball::kTeams; ++team)
      host.send(wire::MatchRequest{number(wire::RequestKind::push), team, 0});
    ASSERT_TRUE(table.tick_until([&] {
      controller.report(0);
      return table->match().view().screen == screen;
    }));
  }
  std::size_t before = felt.size();
  int ticks_with_hits = 0;
  ASSERT_TRUE(table.tick_until([&] {
    // The last tick: a pulse in it implies a hit in it.
    bool hit = false;
    for (const foosball::Event& event : table->match().events())
      hit |= event.kind == foosball::EventKind::man_hit && event.value >= cabinet::kSoftestFelt;
    ticks_with_hits += hit;
    EXPECT_TRUE(hit || felt.size() == before) << "late";
    before = felt.size();
    const double t = 1e-6 * static_cast<double>(table.now_us());
    controller.sweep(900.0 * std::sin(4.0 * t), 700.0 * std::sin(25.0 * t));
    return felt.size() >= 3;
  }));
  EXPECT_GE(ticks_with_hits, 3);
  for (const cabinet::HapticPulse& pulse : felt) EXPECT_LE(pulse.ms, cabinet::kLongestPulseMs);
  EXPECT_EQ(table->counters().haptic_pulses, felt.size());
}

}  // namespace
}  // namespace server
