// Gamepads, by their events, so that a press that ends before the next frame counts too. SDL reads
// the pads, knows their layouts and reports when one is plugged in or out; GLFW, which owns the
// window, only reports a pad's present state. A pad that comes back gets its earlier index.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/input_collector.h"

namespace client {

class Pads {
 public:
  // Without a gamepad driver there are no pads. cabinets: also read the gamepads that a cabinet's
  // controller makes of its rods. The server beside it reads the controller itself.
  explicit Pads(bool cabinets = false);
  ~Pads();
  Pads(const Pads&) = delete;
  Pads& operator=(const Pads&) = delete;

  void poll(InputCollector& into);
  // Rumbles this pad, 0 .. kPads - 1, for `ms`, if it has motors and was used within kInHandUs, so
  // that a pad that lies on the desk does not rattle. strength 0..1.
  static constexpr std::int64_t kInHandUs = 10'000'000;
  void rumble(int pad, float strength, std::uint16_t ms);
  std::uint64_t rumbles() const { return rumbles_; }  // that a pad accepted
  // Messages for a person since the last call, such as a pad that was unplugged.
  std::vector<std::string> take_messages();

 private:
  struct Place {
    std::int32_t instance = -1;  // SDL's; -1: nothing is plugged in
    void* pad = nullptr;         // SDL_GameController
    std::string guid;            // of the last model at this index
    cabinet::PadState sticks;
    std::int64_t used_us = 0;  // os::monotonic_us() of the last press or motion; 0: never
  };
  int place_of(std::int32_t instance) const;  // -1: none
  void plug_in(int device, InputCollector& into);
  void unplug(std::int32_t instance, InputCollector& into);
  void use(std::int32_t instance);
  void turn_axis(std::int32_t instance, int axis, int value, InputCollector& into);

  bool started_ = false;
  bool cabinets_ = false;
  std::array<Place, kPads> places_;
  std::vector<std::string> messages_;
  std::uint64_t rumbles_ = 0;
};

}  // namespace client
