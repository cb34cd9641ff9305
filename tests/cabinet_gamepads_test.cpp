// A cabinet's rods through third-party software: the firmware in its simulator, its reports as
// Linux converts them to events, these as SDL converts them to a controller, and then the project's
// client, which treats it like any gamepad.
#define SDL_MAIN_HANDLED
#include <SDL2/SDL.h>
#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/pads.h"
#include "client/player_input.h"
#include "firmware_sim/cabinet_sim.h"
#include "firmware_sim/hid_descriptor.h"
#include "foosball/table.h"
#include "scripted_scene.h"
#include "wire/device_command.h"

// SDL never closes its D-Bus connection, through which it learns of devices.
extern "C" const char* __lsan_default_suppressions();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libdbus-1";
}

namespace {

// One gamepad of the controller, as SDL 2.26 sees it on Linux (SDL_sysjoystick.c). Axes and buttons
// are numbered in the order of their codes. The kernel's gamepad specification gives their names.
class LinuxPad {
 public:
  explicit LinuxPad(const hid::Description& description) : description_(description) {
    for (const hid::Field& field : description_.inputs) {
      const auto code = hid::linux_code(field);
      if (code) (code->type == EV_ABS ? axes_ : buttons_).push_back(code->code);
    }
    std::ranges::sort(axes_);
    std::ranges::sort(buttons_);
    SDL_VirtualJoystickDesc desc{};
    desc.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    desc.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    desc.naxes = static_cast<Uint16>(axes_.size());
    desc.nbuttons = static_cast<Uint16>(buttons_.size());
    desc.vendor_id = 0x1209;
    desc.product_id = 0x0002;
    device_ = SDL_JoystickAttachVirtualEx(&desc);
    EXPECT_GE(device_, 0) << SDL_GetError();
    EXPECT_GE(SDL_GameControllerAddMapping(mapping().c_str()), 0) << SDL_GetError();
  }
  LinuxPad(const LinuxPad&) = delete;
  LinuxPad& operator=(const LinuxPad&) = delete;
  ~LinuxPad() {
    SDL_JoystickDetachVirtual(device_);
    SDL_JoystickUpdate();
  }

  void take(const std::vector<std::uint8_t>& report) const {
    SDL_Joystick* joystick = SDL_JoystickFromInstanceID(SDL_JoystickGetDeviceInstanceID(device_));
    ASSERT_NE(joystick, nullptr);
    for (const hid::Field& field : description_.inputs) {
      const auto code = hid::linux_code(field);
      if (!code) continue;
      const int value = hid::value_of(field, report);
      if (code->type == EV_ABS) {
        SDL_JoystickSetVirtualAxis(joystick, place(axes_, code->code), static_cast<Sint16>(value));
      } else {
        SDL_JoystickSetVirtualButton(joystick, place(buttons_, code->code), value != 0 ? 1 : 0);
      }
    }
    SDL_JoystickUpdate();
  }

 private:
  static int place(const std::vector<int>& codes, int code) {
    return static_cast<int>(std::ranges::find(codes, code) - codes.begin());
  }
  std::string mapping() const {
    char guid[33];
    SDL_JoystickGetGUIDString(SDL_JoystickGetDeviceGUID(device_), guid, sizeof guid);
    std::string text = std::string(guid) + ",Cabinet";
    const auto add = [&](const char* name, const char* kind, const std::vector<int>& codes,
                         int code) {
      if (std::ranges::count(codes, code) > 0)
        text += std::string(",") + name + ":" + kind + std::to_string(place(codes, code));
    };
    EXPECT_GT(std::ranges::count(buttons_, BTN_GAMEPAD), 0) << "SDL takes it for no gamepad";
    add("a", "b", buttons_, BTN_SOUTH);
    add("b", "b", buttons_, BTN_EAST);
    add("leftx", "a", axes_, ABS_X);
    add("lefty", "a", axes_, ABS_Y);
    add("rightx", "a", axes_, ABS_RX);
    add("righty", "a", axes_, ABS_RY);
    return text + ",";
  }

  hid::Description description_;
  std::vector<int> axes_, buttons_;
  int device_ = -1;
};

std::vector<std::uint8_t> report_of(const wire::DeviceCommand& command) {
  std::vector<std::uint8_t> report(64);
  wire::encode_device_command(command, report.data());
  return report;
}

// The first player's gamepad: rods 1 and 2 of the table, for the left and the right hand.
class CabinetGamepads : public testing::Test {
 protected:
  static constexpr std::int64_t kFrameUs = 16'000;

  void SetUp() override {
    ASSERT_TRUE(until([&] { return cabinet.usb_configured() && cabinet.all_enabled(); }));
    wire::DeviceCommand command{};
    command.kind = wire::kSettingsCommand;
    command.resolution = 20;
    command.switches = wire::kGamepads;
    cabinet.send(report_of(command));
    ASSERT_TRUE(until([&] { return cabinet.usb_enumerations() == 2; }));
    pad = std::make_unique<LinuxPad>(hid::parse(cabinet.report_descriptor(1)));
    for (auto& rod : scene.rods) rod.slide = rod.angle = 0;
    pads.poll(input);
    frame();
    ASSERT_TRUE(input.connected(0));
  }
  bool until(const std::function<bool()>& done) {
    for (int ms = 0; ms < 3000 && !done(); ++ms) cabinet.advance_us(1000);
    return done();
  }
  // One frame of the window: reports in, client updated.
  void frame() {
    cabinet.advance_us(kFrameUs);
    for (const firmware_sim::PadReport& report : cabinet.take_pad_reports())
      if (report.interface == 1) pad->take(report.bytes);
    pads.poll(input);
    now_us += kFrameUs;
    player.update(input.take(client::kAllDevices), &scene, now_us);
    input.clear();
  }
  void frames(int count) {
    for (; count > 0; --count) frame();
  }
  wire::InputRod active() const {
    return player.rods()[static_cast<std::size_t>(player.active_rod())];
  }

  firmware_sim::CabinetSim cabinet{firmware_sim::Board::mega32u4};
  client::Pads pads{true};
  client::InputCollector input;
  client::PlayerInput player{1, 0, foosball::Layout::tournament};
  wire::Snapshot scene = client::scripted_play(0.0);
  std::unique_ptr<LinuxPad> pad;
  std::int64_t now_us = 0;
};

TEST_F(CabinetGamepads, TheLeftHandsRodPushedAwaySlidesAwayAndPulledBackStands) {
  const double before = active().slide;
  cabinet.mouse(0).move(540 * 8 / 4, 0);  // half of the goalie's travel from its centre
  frames(20);
  const double away = active().slide;
  EXPECT_GT(away, before + 0.02);
  cabinet.mouse(0).move(-540 * 8 / 4, 0);
  frames(5);
  const double there = active().slide;
  frames(20);
  EXPECT_NEAR(active().slide, there, 0.001) << "the middle is no motion";
  cabinet.mouse(0).move(-540 * 8 / 4, 0);
  frames(20);
  EXPECT_LT(active().slide, there - 0.02);
}

TEST_F(CabinetGamepads, TheRightHandsRodTurnedSwingsTheFeetByItsAngle) {
  cabinet.mouse(1).move(0, 50);  // an eighth of the 400 counts per turn
  frames(20);
  // A positive angle swings the feet towards -x; right is +x for team 0.
  const double eighth = -active().angle;
  EXPECT_NEAR(eighth, 0.6, 0.2) << "0.7 of a swing of 1.4, less the dead zone";
  cabinet.mouse(1).move(0, 50);
  frames(20);
  EXPECT_NEAR(-active().angle, 1.4, 0.05);
  cabinet.mouse(1).move(0, -100);
  frames(20);
  EXPECT_NEAR(active().angle, 0.0, 0.05) << "the feet hang down";
}

// For the tournament table, with mice of 8 counts/mm.
TEST_F(CabinetGamepads, AQuarterOfEachRodsTravelIsHalfOfItsSticksWay) {
  struct Stick {
    int interface, axis;
  };
  constexpr std::array<Stick, 8> kSticks{{{1, ABS_Y},
                                          {1, ABS_RY},
                                          {4, ABS_RY},
                                          {2, ABS_Y},
                                          {4, ABS_Y},
                                          {2, ABS_RY},
                                          {3, ABS_RY},
                                          {3, ABS_Y}}};
  const auto& table = foosball::table_spec(foosball::Layout::tournament);
  std::array<std::map<int, int>, 5> values;
  for (std::size_t rod = 0; rod < kSticks.size(); ++rod) {
    const double travel = 2 * table.rods[rod].slide_limit;
    cabinet.mouse(static_cast<int>(rod)).move(static_cast<int>(travel * 8000 / 4), 0);
    cabinet.advance_us(300'000);
    for (const firmware_sim::PadReport& report : cabinet.take_pad_reports()) {
      const auto at = static_cast<std::size_t>(report.interface);
      const auto description = hid::parse(cabinet.report_descriptor(report.interface));
      for (const hid::Field& field : description.inputs)
        if (const auto code = hid::linux_code(field); code && code->type == EV_ABS)
          values[at][code->code] = hid::value_of(field, report.bytes);
    }
    const auto& [interface, axis] = kSticks[rod];
    EXPECT_NEAR(values[static_cast<std::size_t>(interface)][axis], -16384, 330) << rod;
  }
}

TEST_F(CabinetGamepads, AShotConfirmsAsTheFirstButtonDoes) {
  bool pressed = false;
  for (int i = 0; i < 8; ++i) {
    cabinet.mouse(0).move(0, 40);  // 40 rad/s
    cabinet.advance_us(kFrameUs);
    for (const firmware_sim::PadReport& report : cabinet.take_pad_reports())
      if (report.interface == 1) pad->take(report.bytes);
    pads.poll(input);
    pressed |= input.take(client::kAllDevices).pad_push;
    input.clear();
  }
  EXPECT_TRUE(pressed);
}

}  // namespace
