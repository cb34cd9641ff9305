// What both AVR boards do besides their link to the PC: mice, motors, settings, LED, watchdog.
// Frames come out, commands go in.
#ifndef FIRMWARE_APP_AVR_CONTROLLER_H
#define FIRMWARE_APP_AVR_CONTROLLER_H

#include "core/haptics.h"
#include "core/index_marks.h"
#include "core/mouse_host.h"
#include "core/settings_store.h"
#include "hal/eeprom.h"
#include "hal/motors_bus.h"

namespace firmware {

class AvrController {
 public:
  // From here on lines are sampled, and the watchdog wants turns.
  void start();

  // A round of the loop: false until it is time for a turn, of which each step is short. Meanwhile
  // the motors' bus moves on, or the processor sleeps.
  bool due();
  // A turn, 5000 times a second. host: the PC reads; until then mice would fill counters that
  // nobody does. Returns the time [us].
  uint32_t turn(bool host);

  // The turn before this one made a frame. What takes long has a turn of its own, else the edges of
  // the mice find their ring full: a frame, a command, a bus that does not run by itself.
  bool after_frame() const { return after_frame_; }

  void obey(const wire::DeviceCommand& command);
  // An error of the line of commands, told in the next frame.
  void count_error();
  void make_frame(uint32_t now_us, wire::DeviceFrame& frame);
  // The PC has asked for the settings, and they are kept: they go out in the place of the next
  // frame. True once; sequence: of the question.
  bool take_question(uint16_t& sequence);

  Ps2Lines& lines() { return mice_.lines(); }
  const MouseHost& mice() const { return mice_; }
  const wire::DeviceSettings& settings() const { return settings_; }
  MotorsBus& bus() { return bus_; }
  bool bus_busy() const { return bus_.busy(); }               // motors and marks
  uint16_t ms() const { return static_cast<uint16_t>(ms_); }  // since start(), wraps

 private:
  // A mouse's counts come each 5 ms.
  static const uint8_t kMarksMs = 4;

  void step_bus();
  void pass_ms();
  void guard_motors();
  void show_state();
  bool pulses_allowed() const { return (settings_.switches & wire::kPulsesOff) == 0; }

  MouseHost mice_;
  MotorsBus bus_;
  Haptics haptics_{bus_};
  IndexMarks marks_{bus_, kMarksMs};
  bool marks_due_ = false;
  wire::DeviceSettings settings_;
  SettingsStore<Eeprom> store_;
  uint32_t ms_ = 0;
  uint32_t ms_began_us_ = 0;
  uint8_t errors_ = 0;  // counted in the next frame
  uint8_t present_ = 0;
  bool asked_ = false;
  uint16_t question_ = 0;
  bool frame_made_ = false, after_frame_ = false;
  bool host_ = false;
  bool watchdog_has_reset_ = false;
  uint8_t light_ms_ = 0;
  uint8_t light_tick_ = 0;
};

}  // namespace firmware

#endif
