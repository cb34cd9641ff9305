// The rods as gamepads: the ATmega32U4's own USB controller with a simulated host that parses the
// report descriptors itself. The ATmega2560 has no USB of its own.
#include <cmath>
#include <cstdio>
#include <map>

#include "commands_fixture.h"
#include "firmware_sim/hid_descriptor.h"

namespace firmware_sim {
namespace {

wire::DeviceCommand gamepads_command(bool on, std::uint8_t brightness = 64) {
  wire::DeviceCommand command = settings_command(brightness);
  command.switches = on ? wire::kGamepads : 0;
  return command;
}

wire::DeviceCommand stick_command(int rod, int travel, int turn, int reversed = 0) {
  wire::DeviceCommand command{};
  command.kind = wire::kStickCommand;
  command.rod = static_cast<std::uint8_t>(rod);
  command.travel = static_cast<std::uint16_t>(travel);
  command.turn = static_cast<std::uint16_t>(turn);
  command.reversed = static_cast<std::uint8_t>(reversed);
  return command;
}

int product(const CabinetSim& sim) {
  const auto& device = sim.device_descriptor();
  return device[10] | device[11] << 8;
}

// A 32U4 whose gamepads are read as by Linux: values by interface and event code.
class PadCabinet : public MotorCabinet {
 public:
  explicit PadCabinet(const CabinetOptions& options = {})
      : MotorCabinet(Board::mega32u4, options) {}

  bool switch_gamepads(bool on) {
    const int before = sim.usb_enumerations();
    send(gamepads_command(on));
    if (!advance_until([&] { return sim.usb_enumerations() > before; }, 1500)) return false;
    describe();
    return true;
  }
  void describe() {
    descriptions_.clear();
    for (int i = 1; i < sim.usb_interfaces(); ++i)
      descriptions_[i] = hid::parse(sim.report_descriptor(i));
  }
  const std::map<int, hid::Description>& descriptions() const { return descriptions_; }

  void take_pads() {
    for (const PadReport& report : sim.take_pad_reports()) {
      ++reports[report.interface];
      const hid::Description& description = descriptions_.at(report.interface);
      EXPECT_EQ(8 * report.bytes.size(), description.input_bits);
      for (const hid::Field& field : description.inputs) {
        const auto code = hid::linux_code(field);
        if (code) values_[{report.interface, code->code}] = hid::value_of(field, report.bytes);
      }
    }
  }
  int value(int interface, int code) {
    take_pads();
    return values_[{interface, code}];
  }

  std::map<int, int> reports;  // by interface

 private:
  std::map<int, hid::Description> descriptions_;
  std::map<std::pair<int, int>, int> values_;
};

struct GamepadsOf32u4 : testing::Test {
  PadCabinet cabinet;
  void SetUp() override {
    ASSERT_TRUE(cabinet.start());
    ASSERT_TRUE(cabinet.switch_gamepads(true));
    cabinet.sim.advance_us(20'000);
    cabinet.take();
  }
};

TEST_F(GamepadsOf32u4, AreAnotherProductWhichEnumeratesBesideTheFramesAndTheyGoOn) {
  EXPECT_EQ(product(cabinet.sim), 0x0002);
  ASSERT_EQ(cabinet.sim.usb_interfaces(), 5);
  Cabinet before(Board::mega32u4);
  ASSERT_TRUE(before.advance_until([&] { return before.sim.usb_configured(); }, 500));
  EXPECT_EQ(product(before.sim), 0x0001);
  EXPECT_EQ(before.sim.usb_interfaces(), 1);
  EXPECT_EQ(cabinet.sim.report_descriptor(0), before.sim.report_descriptor(0));
  EXPECT_EQ(cabinet.sim.serial_descriptor(), before.sim.serial_descriptor());
  cabinet.take();
  cabinet.sim.advance_us(1'000'000);
  const Frames frames = cabinet.take();
  EXPECT_NEAR(static_cast<double>(frames.good.size()), 1000, 10);
  EXPECT_EQ(frames.errors(), 0u);
  EXPECT_EQ(cabinet.sim.usb_violations(), std::vector<std::string>{});
}

TEST_F(GamepadsOf32u4, TheConfigurationFitsTheChip) {
  const auto& bytes = cabinet.sim.configuration_descriptor();
  ASSERT_EQ(static_cast<std::size_t>(bytes[2] | bytes[3] << 8), bytes.size());
  std::vector<int> addresses;
  std::size_t memory = 64;  // of endpoint 0
  for (std::size_t at = 0; at < bytes.size(); at += bytes[at]) {
    ASSERT_GE(bytes[at], 2);
    if (bytes[at + 1] != 5) continue;
    addresses.push_back(bytes[at + 2]);
    EXPECT_EQ(bytes[at + 3], 3) << "interrupt";
    memory += static_cast<std::size_t>(bytes[at + 4] | bytes[at + 5] << 8);
  }
  EXPECT_EQ(addresses, (std::vector<int>{0x81, 0x02, 0x83, 0x84, 0x85, 0x86}));
  EXPECT_LE(memory, 832u);
}

// One application per interface: Linux merges all of the same kind in one interface into one
// device.
TEST_F(GamepadsOf32u4, EachIsAGamepadOfTwoSticksForLinux) {
  ASSERT_EQ(cabinet.descriptions().size(), 4u);
  for (const auto& [interface, description] : cabinet.descriptions()) {
    EXPECT_EQ(description.applications, (std::vector<std::uint32_t>{hid::kGamePad}));
    std::map<int, int> axes, buttons;
    for (const hid::Field& field : description.inputs) {
      EXPECT_EQ(field.report_id, 0u);
      const auto code = hid::linux_code(field);
      if (!code) continue;
      ++(code->type == EV_ABS ? axes : buttons)[code->code];
      if (code->type == EV_ABS) {
        EXPECT_EQ(field.minimum, -field.maximum) << "the middle is 0";
      }
    }
    EXPECT_EQ(axes, (std::map<int, int>{{ABS_X, 1}, {ABS_Y, 1}, {ABS_RX, 1}, {ABS_RY, 1}}));
    EXPECT_EQ(buttons.count(BTN_GAMEPAD), 1u) << "or SDL takes it for no gamepad";
    EXPECT_EQ(buttons.count(BTN_START), 1u);
    EXPECT_EQ(description.input_bits % 8, 0u);
  }
}

TEST_F(GamepadsOf32u4, EachMouseMovesItsStickByTheShareOfTravelAndTurnThatItMoved) {
  constexpr std::array<std::pair<int, bool>, 8> kStick{
      {{1, false}, {1, true}, {4, true}, {2, false}, {4, false}, {2, true}, {3, true}, {3, false}}};
  for (int rod = 0; rod < kMice; ++rod) cabinet.send(stick_command(rod, 800 + 8 * rod, 400));
  ASSERT_TRUE(cabinet.advance_until([&] { return cabinet.sim.all_sent(); }, 100));
  cabinet.sim.advance_us(20'000);
  for (int rod = 0; rod < kMice; ++rod) {
    const auto [interface, right] = kStick[static_cast<std::size_t>(rod)];
    const int x = right ? ABS_RX : ABS_X, y = right ? ABS_RY : ABS_Y;
    EXPECT_NEAR(cabinet.value(interface, y), 0, 100);
    cabinet.sim.mouse(rod).move((800 + 8 * rod) / 4, -50);
    ASSERT_TRUE(cabinet.settle());
    EXPECT_NEAR(cabinet.value(interface, y), -16384, 100) << "pushed away: up";
    EXPECT_NEAR(cabinet.value(interface, x), -16384, 100);
  }
}

TEST_F(GamepadsOf32u4, APushToTheStopSetsTheStickRight) {
  cabinet.send(stick_command(5, 800, 400));
  cabinet.sim.mouse(5).move(1500, 0);
  ASSERT_TRUE(cabinet.settle());
  EXPECT_EQ(cabinet.value(2, ABS_RY), -32767);
  cabinet.sim.mouse(5).move(-400, 0);
  ASSERT_TRUE(cabinet.settle());
  EXPECT_NEAR(cabinet.value(2, ABS_RY), 0, 100);
}

TEST_F(GamepadsOf32u4, AShotPressesItsButton) {
  cabinet.send(stick_command(1, 800, 400));
  for (int i = 0; i < 40; ++i) {
    cabinet.sim.mouse(1).move(0, 2);  // 31 rad/s
    cabinet.sim.advance_us(1000);
  }
  EXPECT_EQ(cabinet.value(1, BTN_GAMEPAD + 1), 1);
  EXPECT_EQ(cabinet.value(1, BTN_GAMEPAD), 0);
  cabinet.sim.advance_us(200'000);
  EXPECT_EQ(cabinet.value(1, BTN_GAMEPAD + 1), 0);
}

// Other games open only the gamepads.
TEST_F(GamepadsOf32u4, AreReadByAGameThatDoesNotKnowTheFrames) {
  cabinet.send(stick_command(0, 800, 400));
  cabinet.sim.advance_us(20'000);
  cabinet.sim.usb_read_frames(false);
  cabinet.sim.advance_us(50'000);
  Moved moved;
  moved.move(cabinet.sim, 0, 200, 50);
  ASSERT_TRUE(cabinet.settle());
  EXPECT_NEAR(cabinet.value(1, ABS_X), 16384, 100);
  EXPECT_NEAR(cabinet.value(1, ABS_Y), -16384, 100);
  cabinet.sim.usb_read_frames(true);
  cabinet.sim.advance_us(20'000);
  cabinet.take();
  expect_counts(cabinet.last(), moved);
}

TEST_F(GamepadsOf32u4, AHaltConcernsThatGamepadOnly) {
  cabinet.take_pads();
  cabinet.reports.clear();
  EXPECT_FALSE(cabinet.sim.control({0x02, 3, 0, 0, 0x85, 0, 0, 0}).stalled);
  EXPECT_EQ(cabinet.sim.control({0x82, 0, 0, 0, 0x85, 0, 2, 0}).data,
            (std::vector<std::uint8_t>{1, 0}));
  cabinet.take_pads();
  cabinet.reports.clear();
  cabinet.sim.advance_us(1'000'000);
  cabinet.take_pads();
  EXPECT_EQ(cabinet.reports.count(3), 0u);
  for (const int other : {1, 2, 4}) EXPECT_GE(cabinet.reports[other], 2) << "told now and then";
  EXPECT_FALSE(cabinet.sim.control({0x02, 1, 0, 0, 0x85, 0, 0, 0}).stalled);
  cabinet.sim.advance_us(600'000);
  cabinet.take_pads();
  EXPECT_GE(cabinet.reports[3], 1);
}

TEST_F(GamepadsOf32u4, AReportCanAlsoBeAskedForByAControlTransfer) {
  const auto result = cabinet.sim.control({0xA1, 1, 0, 1, 4, 0, 64, 0});
  EXPECT_FALSE(result.stalled);
  EXPECT_EQ(8 * result.data.size(), cabinet.descriptions().at(4).input_bits);
}

TEST_F(GamepadsOf32u4, TheWayBackIsTheSameCommandAndNoCountIsLostOnEitherWay) {
  Moved moved;
  for (int round = 0; round < 2; ++round) {
    moved.move(cabinet.sim, 2, 300, -70);
    ASSERT_TRUE(cabinet.switch_gamepads(false));
    EXPECT_EQ(product(cabinet.sim), 0x0001);
    EXPECT_EQ(cabinet.sim.usb_interfaces(), 1);
    moved.move(cabinet.sim, 2, -20, 30);
    ASSERT_TRUE(cabinet.switch_gamepads(true));
    EXPECT_EQ(product(cabinet.sim), 0x0002);
  }
  ASSERT_TRUE(cabinet.settle());
  const Frames frames = cabinet.take();
  EXPECT_EQ(frames.bad, 0);
  expect_counts(cabinet.last(), moved);
  EXPECT_EQ(cabinet.sim.usb_violations(), std::vector<std::string>{});
}

// The page sends to the endpoint; a program may use a control transfer, whose end the host must
// see.
TEST_F(GamepadsOf32u4, ASwitchByAControlTransferEndsThatFirst) {
  std::array<std::uint8_t, 8> setup{0x21, 9, 0, 2, 0, 0, 64, 0};
  std::vector<std::uint8_t> report(64);
  const CommandBytes bytes = bytes_of(gamepads_command(false));
  std::copy(bytes.begin(), bytes.end(), report.begin());
  const int before = cabinet.sim.usb_enumerations();
  EXPECT_FALSE(cabinet.sim.control(setup, report).stalled);
  ASSERT_TRUE(cabinet.advance_until([&] { return cabinet.sim.usb_enumerations() > before; }, 1500));
  EXPECT_EQ(product(cabinet.sim), 0x0001);
}

TEST_F(GamepadsOf32u4, SwitchAndScalesOutliveThePowerAndOtherSettingsDoNotEnumerateAgain) {
  cabinet.send(stick_command(0, 640, 400, wire::kSlideReversed));
  cabinet.sim.advance_us(300'000);
  const int before = cabinet.sim.usb_enumerations();
  cabinet.send(gamepads_command(true, 200));
  cabinet.sim.advance_us(500'000);
  EXPECT_EQ(cabinet.sim.usb_enumerations(), before);
  CabinetOptions options;
  options.eeprom = cabinet.sim.eeprom();
  PadCabinet again(options);
  ASSERT_TRUE(again.start());
  EXPECT_EQ(product(again.sim), 0x0002);
  EXPECT_EQ(again.sim.usb_enumerations(), 1);
  again.describe();
  again.sim.mouse(0).move(160, 0);
  ASSERT_TRUE(again.settle());
  EXPECT_NEAR(again.value(1, ABS_Y), 16384, 100);
}

TEST_F(GamepadsOf32u4, AWatchdogResetLeavesThemGamepads) {
  cabinet.sim.advance_us(300'000);  // until saved
  const int before = cabinet.sim.usb_enumerations();
  cabinet.sim.stick_program(false);
  ASSERT_TRUE(cabinet.advance_until([&] { return cabinet.sim.usb_enumerations() > before; }, 2000));
  EXPECT_EQ(product(cabinet.sim), 0x0002);
  EXPECT_EQ(cabinet.sim.usb_interfaces(), 5);
}

class GamepadsUnderLoad : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Clocks, GamepadsUnderLoad, testing::Values(10'000u, 12'500u, 16'700u));

// Eight mice that move, at 200 reports a second each, and index marks; then also 100 pulses a
// second.
TEST_P(GamepadsUnderLoad, NoCountIsLostFramesKeepTheirRateAndGamepadsThatOfTheMice) {
  CabinetOptions options;
  for (std::size_t i = 0; i < kMice; ++i) {
    options.mice[i].clock_hz = GetParam();
    options.mice[i].jitter_ns = 500;
    options.mice[i].seed = 100 + i;
  }
  PadCabinet cabinet(options);
  cabinet.sim.motors().expander = 0xFF;  // no magnet is near
  ASSERT_TRUE(cabinet.start());
  ASSERT_TRUE(cabinet.switch_gamepads(true));
  ASSERT_TRUE(cabinet.wait_for_present(0xFF));
  cabinet.take();
  Shaker shaker;
  shaker.step(cabinet.sim);
  for (const bool pulses : {false, true}) {
    cabinet.take_pads();
    cabinet.reports.clear();
    cabinet.take();
    cabinet.sim.reset_idle();
    constexpr int kSeconds = 2;
    std::uint64_t longest_us = 0;
    for (int ms = 0; ms < 1000 * kSeconds; ++ms) {
      const int rod = ms / 10 % 8, amplitude = 40 + ms / 10 % 200;
      if (pulses && ms % 10 == 0) cabinet.send(pulse_command(rod, amplitude, 5));
      shaker.step(cabinet.sim);
      if (pulses && ms % 10 == 9) {
        const auto begun = cabinet.written_us(rod, amplitude, cabinet.sim.last_sent_us());
        ASSERT_TRUE(begun);
        longest_us = std::max(longest_us, *begun - cabinet.sim.last_sent_us());
      }
    }
    const double idle = cabinet.sim.idle_share();
    const Frames frames = cabinet.take();
    cabinet.take_pads();
    int fewest = 1'000'000;
    for (const int pad : {1, 2, 3, 4}) fewest = std::min(fewest, cabinet.reports[pad] / kSeconds);
    std::printf(
        "mice at %u Hz%s: %.1f frames, %d reports of a gamepad a second, idle %.1f %%, "
        "pulse after %llu us\n",
        GetParam(), pulses ? ", 100 pulses a second" : "",
        static_cast<double>(frames.good.size()) / kSeconds, fewest, 100 * idle,
        static_cast<unsigned long long>(longest_us));
    EXPECT_EQ(frames.errors(), 0u);
    EXPECT_EQ(frames.overflow(), 0u);
    for (std::size_t i = 1; i < frames.good.size(); ++i) {
      ASSERT_EQ(frames.good[i].sequence,
                static_cast<std::uint16_t>(frames.good[i - 1].sequence + 1));
    }
    EXPECT_GE(static_cast<double>(frames.good.size()), kSeconds * (pulses ? 880 : 990));
    EXPECT_GE(fewest, pulses ? 120 : 180);  // measured 132, 190
    EXPECT_LE(longest_us, 2000u);
  }
  cabinet.settle();
  cabinet.take();
  expect_counts(cabinet.last(), shaker.moved);
  cabinet.expect_no_fault();
  EXPECT_GT(cabinet.sim.unused_ram_bytes(), 640u) << "a quarter";
  EXPECT_EQ(cabinet.sim.usb_violations(), std::vector<std::string>{});
}

TEST(GamepadsOf2560, ARefusedCommandIsCountedAndChangesNothing) {
  MotorCabinet cabinet(Board::mega2560);
  ASSERT_TRUE(cabinet.start());
  const std::uint8_t led = settings_command(64).brightness;
  cabinet.send(settings_command(200));
  cabinet.sim.advance_us(300'000);
  const auto writes = cabinet.sim.eeprom_writes();
  for (const wire::DeviceCommand& command : {gamepads_command(true), stick_command(3, 800, 400)}) {
    cabinet.take();
    cabinet.send(command);
    cabinet.sim.advance_us(300'000);
    EXPECT_EQ(cabinet.take().errors(), 1u);
    EXPECT_EQ(cabinet.sim.eeprom_writes(), writes);
    EXPECT_NE(cabinet.sim.led(), led);
  }
}

}  // namespace
}  // namespace firmware_sim
