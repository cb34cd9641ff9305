// ATmega32U4: reads eight PS/2 mice and sends a 64-byte HID report every millisecond. Receives
// commands for haptics and settings. A setting adds four gamepads.
#include <avr/interrupt.h>

#include "app/avr_controller.h"
#include "core/gamepads.h"
#include "core/serial_string.h"
#include "hal/timing.h"
#include "hal/unique_id.h"
#include "hal/usb_device.h"

namespace {

firmware::AvrController g_controller;
firmware::UsbDevice g_usb;
firmware::SerialString<firmware::kUniqueIdBytes> g_serial;
firmware::Gamepads g_pads;
uint8_t g_report[wire::kDeviceReportBytes];  // the bytes after the frame stay 0

void make_serial() {
  uint8_t id[firmware::kUniqueIdBytes];
  firmware::read_unique_id(id);
  g_serial.set(id);
}

const uint16_t kMouseCountsPerCm = 80;

bool gamepads_on() {
  return (g_controller.settings().switches & wire::kGamepads) != 0;
}

void apply_settings() {
  const wire::DeviceSettings& settings = g_controller.settings();
  for (uint8_t rod = 0; rod < wire::kDeviceRods; ++rod) {
    g_pads.scale(rod, settings, kMouseCountsPerCm);
  }
  g_usb.set_gamepads(gamepads_on());
}

bool take_command() {
  uint8_t bytes[wire::kDeviceCommandBytes];
  wire::DeviceCommand command;
  const uint8_t size = g_usb.take_command(bytes);
  if (size == 0) return false;
  if (size >= wire::kDeviceCommandBytes &&
      wire::decode_device_command(bytes, wire::kDeviceCommandBytes, command)) {
    g_controller.obey(command);
    if (command.kind == wire::kSettingsCommand || command.kind == wire::kStickCommand)
      apply_settings();
  } else {
    g_controller.count_error();
  }
  return true;
}

void move_stick(uint8_t rod, uint16_t now_ms) {
  const firmware::MouseHost& mice = g_controller.mice();
  g_pads.move(rod, mice.slide(rod), mice.spin(rod), now_ms);
}

// Each gamepad at the rate of its mice, one per millisecond: eight mice leave no time for more.
const uint8_t kMouseReportMs = 5;

void serve_gamepads() {
  static bool on = false;
  static uint8_t pad = 0, served_ms = 0, told = 0;
  const uint16_t now_ms = g_controller.ms();
  if (!gamepads_on()) {
    on = false;
    return;
  }
  if (static_cast<uint8_t>(now_ms) == served_ms || g_controller.bus_busy()) return;
  served_ms = static_cast<uint8_t>(now_ms);
  if (!on) g_pads.begin();
  on = true;
  if (now_ms >> 8 != told) g_pads.forget_host();
  told = static_cast<uint8_t>(now_ms >> 8);
  if (++pad == kMouseReportMs) pad = 0;
  if (pad >= firmware::kPads) return;
  move_stick(firmware::Gamepads::left_rod(pad), now_ms);
  move_stick(firmware::Gamepads::right_rod(pad), now_ms);
  if (g_usb.wants_pad_report(pad)) {
    const uint8_t* report = g_pads.report(pad);
    if (report != nullptr) g_usb.send_pad_report(pad, report);
  }
}

void report(uint32_t now_us) {
  uint16_t question;
  if (g_controller.take_question(question)) {
    wire::encode_settings_report(g_controller.settings(), wire::kCanBeGamepads, question, g_report);
  } else {
    wire::DeviceFrame frame;
    g_controller.make_frame(now_us, frame);
    wire::encode_device_frame(frame, g_report);
  }
  g_usb.send_report(g_report);
}

}  // namespace

ISR(TIMER1_COMPA_vect) {
  firmware::sample_lines(g_controller.lines());
}

int main() {
  make_serial();
  g_controller.start();
  apply_settings();
  g_usb.start(g_serial.descriptor, gamepads_on());
  for (;;) {
    if (!g_controller.due()) continue;
    const uint32_t now_us = g_controller.turn(g_usb.configured());
    g_usb.poll();
    if (g_usb.wants_report() && !g_controller.after_frame()) {
      report(now_us);
    } else if (!take_command()) {
      serve_gamepads();
    }
  }
}
