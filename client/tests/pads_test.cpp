// Gamepads as SDL reports them: a virtual pad that is plugged in, pressed and unplugged.
#include "app/pads.h"

#define SDL_MAIN_HANDLED
#include <SDL2/SDL.h>
#include <gtest/gtest.h>

// SDL never closes its D-Bus connection, through which it learns of devices.
extern "C" const char* __lsan_default_suppressions();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libdbus-1";
}

namespace client {
namespace {

struct VirtualPad {
  VirtualPad()
      : device(SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX,
                                         SDL_CONTROLLER_BUTTON_MAX, 0)) {}
  // By its present index: indices change when another pad is unplugged.
  SDL_Joystick* joystick() const {
    return SDL_JoystickFromInstanceID(SDL_JoystickGetDeviceInstanceID(device));
  }
  void set(SDL_GameControllerButton button, bool down) const {
    ASSERT_EQ(SDL_JoystickSetVirtualButton(joystick(), button, down ? 1 : 0), 0) << SDL_GetError();
    SDL_JoystickUpdate();  // as the driver does at each of its events
  }
  int device;
};

TEST(Pads, APressBetweenTwoFramesIsThereAndAnUnpluggedPadIsTold) {
  Pads pads;
  InputCollector input;
  const VirtualPad pad;
  ASSERT_GE(pad.device, 0) << SDL_GetError();
  pads.poll(input);
  ASSERT_TRUE(input.connected(0));
  for (int i = 0; i < 2; ++i) {
    pad.set(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
    pad.set(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, false);
  }
  pad.set(SDL_CONTROLLER_BUTTON_A, true);
  pad.set(SDL_CONTROLLER_BUTTON_A, false);
  for (const auto button : {SDL_CONTROLLER_BUTTON_B, SDL_CONTROLLER_BUTTON_X}) {
    pad.set(button, true);
    pad.set(button, false);
  }
  pads.poll(input);
  InputEvents events = input.take(bit_of(Device::pad_1));
  EXPECT_EQ(events.wheel, 2);
  EXPECT_TRUE(events.pad_push);
  EXPECT_TRUE(events.pad_back && events.pad_share);
  input.clear();
  ASSERT_EQ(SDL_JoystickSetVirtualAxis(pad.joystick(), SDL_CONTROLLER_AXIS_LEFTY, -32768), 0);
  SDL_JoystickUpdate();
  pads.poll(input);
  EXPECT_EQ(input.take(bit_of(Device::pad_1)).pad.left_y, 1.0f) << "up is positive";
  SDL_JoystickDetachVirtual(pad.device);
  SDL_JoystickUpdate();
  pads.poll(input);
  EXPECT_FALSE(input.connected(0));
  EXPECT_EQ(input.take(kAllDevices).pad.left_y, 0.0f);
  const auto messages = pads.take_messages();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_NE(messages[0].find("gamepad 1 was unplugged"), std::string::npos);
  const VirtualPad again;
  pads.poll(input);
  EXPECT_TRUE(input.connected(0)) << "has the place that it had";
}

// A server beside a cabinet reads its rods from the controller, so the client must not play them
// too.
TEST(Pads, ThoseOfACabinetArePlayedOnlyWhenAskedFor) {
  for (const bool asked : {false, true}) {
    Pads pads(asked);
    InputCollector input;
    SDL_VirtualJoystickDesc desc{};
    desc.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    desc.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    desc.naxes = SDL_CONTROLLER_AXIS_MAX;
    desc.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
    desc.vendor_id = 0x1209;
    desc.product_id = 0x0002;
    const int device = SDL_JoystickAttachVirtualEx(&desc);
    ASSERT_GE(device, 0) << SDL_GetError();
    pads.poll(input);
    EXPECT_EQ(input.connected(0), asked);
    SDL_JoystickDetachVirtual(device);
    SDL_JoystickUpdate();
    pads.poll(input);
    EXPECT_FALSE(input.connected(0));
    EXPECT_EQ(pads.take_messages().size(), asked ? 1u : 0u);
  }
}

struct Motors {
  int calls = 0;
  Uint16 low = 0, high = 0;
};

int SDLCALL shake(void* motors, Uint16 low, Uint16 high) {
  auto& m = *static_cast<Motors*>(motors);
  if (low > 0 || high > 0) m = {m.calls + 1, low, high};
  return 0;
}

TEST(Pads, APadShakesOnlyInAHandAndNoStrongerThanItCan) {
  Pads pads;
  InputCollector input;
  Motors motors;
  SDL_VirtualJoystickDesc desc{};
  desc.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
  desc.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
  desc.naxes = SDL_CONTROLLER_AXIS_MAX;
  desc.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
  desc.userdata = &motors;
  desc.Rumble = shake;
  const int device = SDL_JoystickAttachVirtualEx(&desc);
  ASSERT_GE(device, 0) << SDL_GetError();
  pads.poll(input);
  ASSERT_TRUE(input.connected(0));
  pads.rumble(0, 1.0f, 40);
  EXPECT_EQ(pads.rumbles(), 0u) << "it lies on the desk";
  SDL_Joystick* joystick = SDL_JoystickFromInstanceID(SDL_JoystickGetDeviceInstanceID(device));
  ASSERT_EQ(SDL_JoystickSetVirtualButton(joystick, SDL_CONTROLLER_BUTTON_A, 1), 0);
  SDL_JoystickUpdate();
  pads.poll(input);
  pads.rumble(0, 1.0f, 40);
  EXPECT_EQ(pads.rumbles(), 1u);
  EXPECT_EQ(motors.calls, 1);
  EXPECT_EQ(motors.low, 65535);
  pads.rumble(0, 7.0f, 40);
  EXPECT_EQ(motors.low, 65535);
  pads.rumble(0, 0.25f, 40);
  EXPECT_NEAR(motors.low, 65535 / 4, 2);
  const std::uint64_t before = pads.rumbles();
  for (const int none : {-1, 1, kPads, 1000}) pads.rumble(none, 1.0f, 40);
  pads.rumble(0, 0.0f, 40);
  pads.rumble(0, 1.0f, 0);
  EXPECT_EQ(pads.rumbles(), before);
  SDL_JoystickDetachVirtual(device);
  SDL_JoystickUpdate();
  pads.poll(input);
  pads.rumble(0, 1.0f, 40);
  EXPECT_EQ(pads.rumbles(), before) << "unplugged";
}

}  // namespace
}  // namespace client
