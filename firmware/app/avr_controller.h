// The common part of both AVR boards, without the link to the PC: mice, motors, settings, LED,
// watchdog. It produces frames and executes commands.
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
  // Starts sampling. From then on, the watchdog requires calls of turn().
  void start();

  // One iteration of the loop: false until turn() is due. Each call is short. Meanwhile it steps
  // the motors' bus or sleeps.
  bool due();
  // Runs 5000 times a second. host: the PC reads; until then the mice stay disabled, as nobody
  // reads their counts. Returns the time [us].
  uint32_t turn(bool host);

  // The previous turn made a frame. Each long task needs a turn of its own, or the ring of mouse
  // edges overflows: a frame, a command, a bus that needs software steps.
  bool after_frame() const { return after_frame_; }

  void obey(const wire::DeviceCommand& command);
  // Counts an error of the command line, for the next frame.
  void count_error();
  void make_frame(uint32_t now_us, wire::DeviceFrame& frame);
  // The PC has requested the settings, and they are saved: send them instead of the next frame.
  // True once. sequence: that of the request.
  bool take_question(uint16_t& sequence);

  Ps2Lines& lines() { return mice_.lines(); }
  const MouseHost& mice() const { return mice_; }
  const wire::DeviceSettings& settings() const { return settings_; }
  MotorsBus& bus() { return bus_; }
  bool bus_busy() const { return bus_.busy(); }               // by motors or marks
  uint16_t ms() const { return static_cast<uint16_t>(ms_); }  // since start(), wraps

 private:
  // A mouse's counts arrive every 5 ms.
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
  uint8_t errors_ = 0;  // for the next frame
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
