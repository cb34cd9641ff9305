#include "app/avr_controller.h"

#include "core/saturating.h"
#include "core/state_light.h"
#include "hal/outputs.h"
#include "hal/timing.h"
#include "hal/watchdog.h"

namespace firmware {

void AvrController::start() {
  watchdog_has_reset_ = stop_watchdog();
  if (watchdog_has_reset_) errors_ = 1;
  start_outputs();
  SettingsStore<Eeprom>::load(settings_);
  haptics_.allow(pulses_allowed());
  start_sampling();
  start_watchdog();
}

bool AvrController::due() {
  if (mice_.due()) return true;
  if (bus_.busy()) {
    step_bus();
    if (!MotorsBus::kRunsByItself) return false;
  }
  if (marks_due_ && !bus_.busy()) {  // marks get time that nothing else needs
    marks_due_ = false;
    marks_.poll(ms_);
  } else {
    sleep_until_sample();
  }
  return false;
}

void AvrController::step_bus() {
  bus_.step(mice_.lines().tick());
  if (bus_.busy()) return;
  // First, so that a pulse that waited for a read starts at once. But no read starts before a
  // pulse.
  if (marks_.reading() || !haptics_.waits()) marks_.poll(ms_);
  haptics_.poll(ms_);
}

uint32_t AvrController::turn(bool host) {
  feed_watchdog();
  after_frame_ = frame_made_;
  frame_made_ = false;
  // While all mice send, a turn takes half a millisecond, which leaves no time between turns.
  if (MotorsBus::kRunsByItself || !after_frame_) {
    for (uint8_t i = 0; i < MotorsBus::kPulseSteps && bus_.busy(); ++i) step_bus();
  }
  const uint32_t now_us = micros();
  mice_.poll(now_us);
  if (MotorsBus::kRunsByItself && bus_.busy()) step_bus();
  host_ = host;
  mice_.allow_streaming(host);
  while (now_us - ms_began_us_ >= 1000) {
    ms_began_us_ += 1000;
    ++ms_;
    pass_ms();
  }
  return now_us;
}

void AvrController::pass_ms() {
  guard_motors();
  haptics_.poll(ms_);
  marks_due_ = true;
  store_.step();
  if (++light_ms_ < kLightTickMs) return;
  light_ms_ = 0;
  show_state();
}

void AvrController::guard_motors() {
  enable_motors(haptics_.safe() && pulses_allowed());
  if (!haptics_.safe()) haptics_.made_safe();
}

void AvrController::show_state() {
  const uint16_t pattern = light_pattern(host_, present_, watchdog_has_reset_);
  set_led((pattern >> light_tick_ & 1) != 0 ? settings_.brightness : 0);
  if (++light_tick_ == kLightTicks) light_tick_ = 0;
}

void AvrController::obey(const wire::DeviceCommand& command) {
  switch (command.kind) {
    case wire::kPulseCommand:
      haptics_.pulse(command.rod, command.amplitude, command.duration_ms, ms_);
      break;
    case wire::kAllOffCommand:
      haptics_.all_off();
      haptics_.poll(ms_);
      break;
    case wire::kSettingsCommand:
      if (!take_settings(command, settings_)) break;  // limits EEPROM wear
      store_.save(settings_);
      haptics_.allow(pulses_allowed());
      break;
    case wire::kStickCommand:
      if (take_stick(command, settings_)) store_.save(settings_);
      break;
    case wire::kTellSettingsCommand:
      asked_ = true;
      question_ = command.sequence;
      break;
  }
}

void AvrController::count_error() {
  errors_ = add_saturating(errors_, 1);
}

bool AvrController::take_question(uint16_t& sequence) {
  if (!asked_ || store_.saving()) return false;
  sequence = question_;
  asked_ = false;
  frame_made_ = true;  // takes as long as a frame
  return true;
}

void AvrController::make_frame(uint32_t now_us, wire::DeviceFrame& frame) {
  mice_.make_frame(now_us, frame);
  frame.index = marks_.under();
  frame.quality = add_saturating(frame.quality, errors_);
  errors_ = 0;
  present_ = frame.present;
  frame_made_ = true;
}

}  // namespace firmware
