// Gamepads, by their events: a press that is over before the next frame is there as well. SDL reads
// them, knows their layouts, and tells when one comes or goes; GLFW, which has the window, only
// says how a pad stands now. A pad that comes back has the place that it had.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/input_collector.h"

namespace client {

class Pads {
 public:
  // Without a driver for gamepads there are none. cabinets: those that a cabinet's controller makes
  // of its rods too; the server beside it has them from the controller itself.
  explicit Pads(bool cabinets = false);
  ~Pads();
  Pads(const Pads&) = delete;
  Pads& operator=(const Pads&) = delete;

  void poll(InputCollector& into);
  // Shakes this pad, 0 .. kPads - 1, for so long, if it has motors and was used within kInHandUs:
  // one that lies on the desk does not rattle. strength 0..1.
  static constexpr std::int64_t kInHandUs = 10'000'000;
  void rumble(int pad, float strength, std::uint16_t ms);
  std::uint64_t rumbles() const { return rumbles_; }  // that a pad took
  // Since the last call: what a person should read, such as that one was unplugged.
  std::vector<std::string> take_news();

 private:
  struct Place {
    std::int32_t instance = -1;  // SDL's; -1: nothing is plugged in
    void* pad = nullptr;         // SDL_GameController
    std::string guid;            // of the model that was here last
    cabinet::PadState sticks;
    std::int64_t used_us = 0;  // os::monotonic_us() when it was last pressed or moved; 0: never
  };
  int place_of(std::int32_t instance) const;  // -1: none
  void plug_in(int device, InputCollector& into);
  void unplug(std::int32_t instance, InputCollector& into);
  void use(std::int32_t instance);
  void turn_axis(std::int32_t instance, int axis, int value, InputCollector& into);

  bool started_ = false;
  bool cabinets_ = false;
  std::array<Place, kPads> places_;
  std::vector<std::string> news_;
  std::uint64_t rumbles_ = 0;
};

}  // namespace client
