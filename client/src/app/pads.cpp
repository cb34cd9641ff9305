#include "app/pads.h"

#define SDL_MAIN_HANDLED
#include <SDL2/SDL.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>

#include "app/log.h"
#include "os/clock.h"

namespace client {
namespace {

constexpr int kStickMoved = 8000;  // of 32767: above the drift of a stick at rest

std::optional<PadButton> meaning_of(int button) {
  switch (button) {
    case SDL_CONTROLLER_BUTTON_A:
      return PadButton::push;
    case SDL_CONTROLLER_BUTTON_START:
      return PadButton::pause;
    case SDL_CONTROLLER_BUTTON_BACK:
      return PadButton::menu;
    case SDL_CONTROLLER_BUTTON_B:
      return PadButton::back;
    case SDL_CONTROLLER_BUTTON_X:
      return PadButton::share;
    case SDL_CONTROLLER_BUTTON_Y:
      return PadButton::time_out;
    case SDL_CONTROLLER_BUTTON_LEFTSHOULDER:
      return PadButton::previous_rod;
    case SDL_CONTROLLER_BUTTON_RIGHTSHOULDER:
      return PadButton::next_rod;
    case SDL_CONTROLLER_BUTTON_DPAD_UP:
      return PadButton::up;
    case SDL_CONTROLLER_BUTTON_DPAD_DOWN:
      return PadButton::down;
    case SDL_CONTROLLER_BUTTON_DPAD_LEFT:
      return PadButton::left;
    case SDL_CONTROLLER_BUTTON_DPAD_RIGHT:
      return PadButton::right;
    default:
      return std::nullopt;
  }
}

// A cabinet's controller whose rods are gamepads: firmware/core/usb_descriptors.cpp.
bool is_cabinet(int device) {
  return SDL_JoystickGetDeviceVendor(device) == 0x1209 &&
         SDL_JoystickGetDeviceProduct(device) == 0x0002;
}

std::string guid_of(int device) {
  char text[33];
  SDL_JoystickGetGUIDString(SDL_JoystickGetDeviceGUID(device), text, sizeof text);
  return text;
}

}  // namespace

Pads::Pads(bool cabinets) : cabinets_(cabinets) {
  SDL_SetMainReady();
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");                // the program has its own
  SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");  // the window is not SDL's
  started_ = SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER | SDL_INIT_EVENTS) == 0;
  if (!started_) log_warning(std::string("no gamepads: ") + SDL_GetError());
}

Pads::~Pads() {
  for (Place& place : places_) {
    if (place.pad != nullptr) SDL_GameControllerClose(static_cast<SDL_GameController*>(place.pad));
  }
  if (started_) SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER | SDL_INIT_EVENTS);
}

int Pads::place_of(std::int32_t instance) const {
  const auto place = std::ranges::find(places_, instance, &Place::instance);
  return instance >= 0 && place != places_.end() ? static_cast<int>(place - places_.begin()) : -1;
}

// Takes the index of an unplugged pad of the same model, else one never used, else any free one.
void Pads::plug_in(int device, InputCollector& into) {
  if (is_cabinet(device) && !cabinets_) return;
  const std::string guid = guid_of(device);
  Place* best = nullptr;
  int worth = -1;
  for (Place& place : places_) {
    if (place.instance >= 0) continue;
    const int here = place.guid == guid ? 2 : place.guid.empty() ? 1 : 0;
    if (here > worth) best = &place;
    worth = std::max(worth, here);
  }
  if (best == nullptr) return;  // no free index
  SDL_GameController* pad = SDL_GameControllerOpen(device);
  if (pad == nullptr) return;
  const std::int32_t instance = SDL_JoystickInstanceID(SDL_GameControllerGetJoystick(pad));
  if (place_of(instance) >= 0) return SDL_GameControllerClose(pad);  // reported twice
  const int number = static_cast<int>(best - places_.data());
  *best = {instance, pad, guid, {}, 0};
  into.connect(number, true);
  log_info("gamepad " + std::to_string(number + 1) + ": " + SDL_GameControllerName(pad));
}

void Pads::unplug(std::int32_t instance, InputCollector& into) {
  const int number = place_of(instance);
  if (number < 0) return;
  Place& place = places_[static_cast<std::size_t>(number)];
  SDL_GameControllerClose(static_cast<SDL_GameController*>(place.pad));
  place = {-1, nullptr, place.guid, {}, 0};
  into.connect(number, false);
  messages_.push_back("gamepad " + std::to_string(number + 1) +
                      " was unplugged: its rods stay in place");
}

void Pads::use(std::int32_t instance) {
  if (const int number = place_of(instance); number >= 0)
    places_[static_cast<std::size_t>(number)].used_us = os::monotonic_us();
}

// Runs both motors: the slow one gives the body of a hit, the fast one its edge. SDL stops them by
// itself.
void Pads::rumble(int pad, float strength, std::uint16_t ms) {
  if (pad < 0 || pad >= kPads || ms == 0 || !(strength > 0.0f)) return;
  const Place& place = places_[static_cast<std::size_t>(pad)];
  const bool in_hand = place.used_us != 0 && os::monotonic_us() - place.used_us < kInHandUs;
  if (place.pad == nullptr || !in_hand) return;
  const auto level = static_cast<Uint16>(65535.0f * std::min(strength, 1.0f));
  auto* controller = static_cast<SDL_GameController*>(place.pad);
  if (SDL_GameControllerRumble(controller, level, static_cast<Uint16>(level / 2), ms) == 0)
    ++rumbles_;
}

void Pads::turn_axis(std::int32_t instance, int axis, int value, InputCollector& into) {
  const int number = place_of(instance);
  if (number < 0) return;
  cabinet::PadState& sticks = places_[static_cast<std::size_t>(number)].sticks;
  const float share = std::max(static_cast<float>(value) / 32767.0f, -1.0f);
  if (axis == SDL_CONTROLLER_AXIS_LEFTX) sticks.left_x = share;
  if (axis == SDL_CONTROLLER_AXIS_LEFTY) sticks.left_y = -share;  // SDL: down positive
  if (axis == SDL_CONTROLLER_AXIS_RIGHTX) sticks.right_x = share;
  if (axis == SDL_CONTROLLER_AXIS_RIGHTY) sticks.right_y = -share;
  into.sticks(number, sticks);
}

void Pads::poll(InputCollector& into) {
  if (!started_) return;
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) {
    switch (event.type) {
      case SDL_CONTROLLERDEVICEADDED:
        plug_in(event.cdevice.which, into);
        break;
      case SDL_CONTROLLERDEVICEREMOVED:
        unplug(event.cdevice.which, into);
        break;
      case SDL_CONTROLLERBUTTONDOWN:
      case SDL_CONTROLLERBUTTONUP:
        if (const auto button = meaning_of(event.cbutton.button))
          into.button(place_of(event.cbutton.which), *button,
                      event.type == SDL_CONTROLLERBUTTONDOWN);
        use(event.cbutton.which);
        break;
      case SDL_CONTROLLERAXISMOTION:
        if (std::abs(event.caxis.value) > kStickMoved) use(event.caxis.which);
        turn_axis(event.caxis.which, event.caxis.axis, event.caxis.value, into);
        break;
      default:
        break;
    }
  }
}

std::vector<std::string> Pads::take_messages() {
  return std::exchange(messages_, {});
}

}  // namespace client
