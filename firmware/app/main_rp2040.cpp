// Raspberry Pi Pico: reads eight SPI motion sensors or PS/2 mice and sends a 64-byte HID report
// every millisecond, sampled just before the host polls. Receives commands for haptics and
// settings. Index marks share the motors' bus. A setting adds four gamepads.
#include "core/gamepads.h"
#include "core/haptics.h"
#include "core/index_marks.h"
#include "core/mouse_host.h"
#include "core/report_clock.h"
#include "core/saturating.h"
#include "core/sensor_host.h"
#include "core/serial_string.h"
#include "core/settings.h"
#include "core/state_light.h"
#include "rp2040/board.h"
#include "rp2040/flash.h"
#include "rp2040/i2c.h"
#include "rp2040/ps2_pins.h"
#include "rp2040/sensor_pins.h"
#include "rp2040/system.h"
#include "rp2040/usb_controller.h"
#include "wire/device_command.h"
#include "wire/device_frame.h"

namespace {

const uint16_t kButtonHoldMs = 1000;  // after which it enters the boot loader
const uint32_t kQuietUs = 50;         // before a sample, in which nothing else starts

rp2040::UsbController g_usb;
rp2040::SensorPins g_sensor_pins;
rp2040::I2c g_i2c;
firmware::SensorHost g_sensors(g_sensor_pins);
firmware::MouseHost g_mice;
firmware::Haptics g_haptics(g_i2c);
firmware::IndexMarks g_marks(g_i2c);
firmware::Gamepads g_pads;
uint8_t g_pads_moved = 0;  // bit i: gamepad i moved since its last report
firmware::ReportClock g_clock;
wire::DeviceSettings g_settings;
bool g_asked = false;     // the PC has requested the settings, to send instead of the next frame
uint16_t g_question = 0;  // sequence of that request
alignas(4) uint8_t g_report[wire::kDeviceReportBytes];  // the bytes after the frame stay 0
firmware::SerialString<rp2040::kUniqueIdBytes> g_serial;

uint32_t g_ms = 0;
uint32_t g_ms_began_us = 0;
uint16_t g_sequence = 0;
wire::DeviceFrame g_frame;  // the last frame made
uint8_t g_errors = 0;       // for the next frame
uint16_t g_button_ms = 0;
volatile uint8_t g_events = 0;  // count of interrupts that need work by the loop

void make_serial() {
  uint8_t id[rp2040::kUniqueIdBytes];
  rp2040::hold_interrupts();
  rp2040::read_unique_id(id);
  rp2040::allow_interrupts();
  g_serial.set(id);
}

bool gamepads_on() {
  return (g_settings.switches & wire::kGamepads) != 0;
}

void scale_sticks() {
  const uint16_t mouse_counts_per_cm = 80;
  const uint16_t counts_per_cm = static_cast<uint16_t>(g_settings.resolution * 10000u / 254);
  for (uint8_t rod = 0; rod < wire::kDeviceRods; ++rod) {
    const bool mouse = (g_settings.ps2 >> rod & 1) != 0;
    g_pads.scale(rod, g_settings, mouse ? mouse_counts_per_cm : counts_per_cm);
  }
}

void set_up_sensors() {
  const uint8_t sensors = static_cast<uint8_t>(~g_settings.ps2);
  rp2040::Ps2Pins::begin(g_settings.ps2);
  g_sensor_pins.begin(sensors);
  g_sensors.begin(sensors, g_settings.resolution);
}

void apply_settings() {
  g_haptics.allow((g_settings.switches & wire::kPulsesOff) == 0);
  scale_sticks();
  g_usb.set_gamepads(gamepads_on());
}

// Called once per sample. While gamepads are off, the sticks do not follow the counts.
void move_sticks() {
  static bool on = false;
  static uint32_t told = 0;
  if (!gamepads_on()) {
    on = false;
    return;
  }
  if (!on) g_pads.begin();
  on = true;
  const uint16_t now_ms = static_cast<uint16_t>(g_ms);
  if (g_ms / 256 != told) g_pads.forget_host();
  told = g_ms / 256;
  for (uint8_t rod = 0; rod < wire::kDeviceRods; ++rod) {
    if ((g_settings.ps2 >> rod & 1) != 0) {
      g_pads.move(rod, g_mice.slide(rod), g_mice.spin(rod), now_ms);
    } else {
      g_pads.move(rod, g_sensors.slide(rod), g_sensors.spin(rod), now_ms);
    }
  }
  g_pads_moved = (1u << firmware::kPads) - 1;
}

// Sends each report when the host has taken the previous one. New ones wait up to a millisecond, so
// that nothing delays the frame after a sample.
void report_gamepads() {
  for (uint8_t pad = 0; pad < firmware::kPads; ++pad) {
    const uint8_t bit = static_cast<uint8_t>(1u << pad);
    if ((g_pads_moved & bit) == 0 || !g_usb.wants_pad_report(pad)) continue;
    g_pads_moved = static_cast<uint8_t>(g_pads_moved & ~bit);
    const uint8_t* report = g_pads.report(pad);
    if (report != nullptr) g_usb.send_pad_report(pad, report);
  }
}

void report() {
  if (!g_usb.wants_report()) return;  // pending data stays for the next report
  if (g_asked) {
    g_asked = false;
    wire::DeviceSettings kept = g_settings;  // fallback if flash holds none
    rp2040::load_settings(kept);
    wire::encode_settings_report(kept, wire::kHasSensors | wire::kCanBeGamepads, g_question,
                                 g_report);
    g_usb.send_report(g_report);
    return;
  }
  if (g_settings.ps2 != 0) {
    g_mice.make_frame(rp2040::micros(), g_frame);
  } else {
    g_frame.flags = 0;
    g_frame.time_us = rp2040::micros();
    g_frame.overflow = 0;
    g_frame.quality = 0;
  }
  g_frame.sequence = g_sequence++;
  g_frame.quality = firmware::add_saturating(g_frame.quality, g_errors);
  g_errors = 0;
  g_frame.index = g_marks.under();
  g_sensors.add_to_frame(g_frame);
  wire::encode_device_frame(g_frame, g_report);
  g_usb.send_report(g_report);
}

void show_state() {
  const unsigned tick = g_ms / firmware::kLightTickMs % firmware::kLightTicks;
  const uint16_t pattern =
      firmware::light_pattern(g_usb.configured(), g_frame.present, rp2040::watchdog_resets() != 0);
  rp2040::set_led((pattern >> tick & 1) != 0 ? g_settings.brightness : 0);
}

void watch_button() {
  if (!rp2040::button_pressed()) {
    g_button_ms = 0;
  } else if (++g_button_ms == kButtonHoldMs) {
    g_haptics.all_off();
    rp2040::reg(rp2040::kGpioOutClear) = rp2040::bit(rp2040::kMotorsEnable);
    rp2040::feed_watchdog(8'000'000);
    rp2040::enter_boot_loader();
  }
}

void guard_motors() {
  const uint32_t line = rp2040::bit(rp2040::kMotorsEnable);
  const bool on = (g_settings.switches & wire::kPulsesOff) == 0;
  if (g_haptics.safe() && on) {
    rp2040::reg(rp2040::kGpioOutSet) = line;
    return;
  }
  rp2040::reg(rp2040::kGpioOutClear) = line;
  if (!g_haptics.safe()) g_haptics.made_safe();
}

void each_ms() {
  g_usb.poll();
  watch_button();
  show_state();
  guard_motors();
}

void pass_time(uint32_t now_us) {
  while (now_us - g_ms_began_us >= 1000) {
    g_ms_began_us += 1000;
    ++g_ms;
    each_ms();
  }
}

// Cuts the motors' power: nothing can stop a motor while flash is written.
void keep_settings() {
  g_haptics.all_off();
  rp2040::reg(rp2040::kGpioOutClear) = rp2040::bit(rp2040::kMotorsEnable);
  rp2040::save_settings(g_settings);
  g_haptics.made_safe();
  pass_time(rp2040::micros());  // so that the sensors' setup starts at the current time
}

void obey(const wire::DeviceCommand& command) {
  switch (command.kind) {
    case wire::kPulseCommand:
      g_haptics.pulse(command.rod, command.amplitude, command.duration_ms, g_ms);
      break;
    case wire::kAllOffCommand:
      g_haptics.all_off();
      break;
    case wire::kSettingsCommand: {
      const bool others =
          command.resolution != g_settings.resolution || command.ps2 != g_settings.ps2;
      if (!firmware::take_settings(command, g_settings)) break;  // limits flash wear
      keep_settings();
      if (others) set_up_sensors();  // loses motion during the setup
      apply_settings();
      break;
    }
    case wire::kStickCommand:
      if (!firmware::take_stick(command, g_settings)) break;
      keep_settings();
      scale_sticks();
      break;
    case wire::kTellSettingsCommand:
      g_asked = true;
      g_question = command.sequence;
      break;
  }
}

void take_commands() {
  g_errors = firmware::add_saturating(g_errors, g_usb.take_dropped());
  uint8_t bytes[wire::kDeviceReportBytes];
  wire::DeviceCommand command;
  while (const uint8_t size = g_usb.take_command(bytes)) {
    if (size >= wire::kDeviceCommandBytes &&
        wire::decode_device_command(bytes, wire::kDeviceCommandBytes, command)) {
      obey(command);
    } else {
      g_errors = firmware::add_saturating(g_errors, 1);
    }
  }
}

void sample_and_report() {
  static uint32_t last_us = 0;
  const uint32_t began_us = rp2040::micros();
  const uint32_t elapsed_ms = (began_us - last_us + 500) / 1000;
  last_us = began_us;
  g_sensors.sample(static_cast<uint8_t>(elapsed_ms < 1 ? 1 : elapsed_ms < 255 ? elapsed_ms : 255));
  report();
  g_clock.sampled(rp2040::micros());
}

}  // namespace

extern "C" void usb_interrupt() {
  g_usb.on_interrupt();
  g_events = static_cast<uint8_t>(g_events + 1);
}
extern "C" void i2c0_interrupt() {
  g_i2c.on_interrupt();
  g_events = static_cast<uint8_t>(g_events + 1);
}
extern "C" void timer1_interrupt() {
  rp2040::Ps2Pins::sample(g_mice.lines());
}

int main() {
  rp2040::start_system();
  rp2040::start_watchdog();
  if (rp2040::watchdog_resets() != 0) g_errors = 1;
  make_serial();
  rp2040::load_settings(g_settings);
  g_i2c.start();
  set_up_sensors();
  apply_settings();
  g_usb.start(g_serial.descriptor, gamepads_on());
  g_ms_began_us = rp2040::micros();
  g_clock.begin(g_ms_began_us);
  bool served = false;
  for (;;) {
    rp2040::feed_watchdog();
    const uint8_t seen = g_events;
    uint32_t taken_us;
    if (g_usb.take_report_time(taken_us)) g_clock.taken(taken_us);
    if (g_clock.due(rp2040::micros() + kQuietUs)) {
      rp2040::sleep_until(g_clock.next_us());
      sample_and_report();
      served = false;
      continue;
    }
    const uint32_t now_us = rp2040::micros();
    pass_time(now_us);
    take_commands();
    g_marks.poll(g_ms);  // first: a pulse that waited for a read starts at once
    g_haptics.poll(g_ms);
    if (g_settings.ps2 != 0 && g_mice.due()) {
      g_mice.poll(now_us);
      // Enumeration first: until then nobody reads the mice's counts.
      g_mice.allow_streaming(g_usb.configured());
    }
    report_gamepads();
    if (!served) {
      move_sticks();
      g_sensors.service(g_ms);
      served = true;
    } else {
      rp2040::sleep_until_event(g_clock.next_us() - kQuietUs, g_events, seen);
    }
  }
}
