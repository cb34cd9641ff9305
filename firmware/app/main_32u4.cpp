// ATmega32U4: eight PS/2 mice in, one 64-byte HID report a millisecond out; commands in, for
// haptics and settings.
#include <avr/interrupt.h>

#include "app/avr_controller.h"
#include "core/serial_string.h"
#include "hal/timing.h"
#include "hal/unique_id.h"
#include "hal/usb_device.h"

namespace {

firmware::AvrController g_controller;
firmware::UsbDevice g_usb;
firmware::SerialString<firmware::kUniqueIdBytes> g_serial;
uint8_t g_report[wire::kDeviceReportBytes];  // the bytes behind the frame stay 0

void make_serial() {
  uint8_t id[firmware::kUniqueIdBytes];
  firmware::read_unique_id(id);
  g_serial.set(id);
}

void take_command() {
  uint8_t bytes[wire::kDeviceCommandBytes];
  wire::DeviceCommand command;
  const uint8_t size = g_usb.take_command(bytes);
  if (size == 0) return;
  if (size >= wire::kDeviceCommandBytes &&
      wire::decode_device_command(bytes, wire::kDeviceCommandBytes, command)) {
    g_controller.obey(command);
  } else {
    g_controller.count_error();
  }
}

void report(uint32_t now_us) {
  wire::DeviceFrame frame;
  g_controller.make_frame(now_us, frame);
  wire::encode_device_frame(frame, g_report);
  g_usb.send_report(g_report);
}

}  // namespace

ISR(TIMER1_COMPA_vect) {
  firmware::sample_lines(g_controller.lines());
}

int main() {
  make_serial();
  g_controller.start();
  g_usb.start(g_serial.descriptor);
  for (;;) {
    if (!g_controller.due()) continue;
    const uint32_t now_us = g_controller.turn(g_usb.configured());
    g_usb.poll();
    if (g_usb.wants_report() && !g_controller.after_frame()) {
      report(now_us);
    } else {
      take_command();
    }
  }
}
