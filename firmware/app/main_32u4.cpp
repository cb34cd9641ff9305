// ATmega32U4: eight PS/2 mice in, one 64-byte HID report a millisecond out.
#include <avr/interrupt.h>

#include "core/mouse_host.h"
#include "hal/timing.h"
#include "hal/usb_device.h"
#include "wire/device_frame.h"

namespace {

firmware::MouseHost g_mice;
firmware::UsbDevice g_usb;
uint8_t g_report[wire::kDeviceReportBytes];  // the bytes behind the frame stay 0

void report(uint32_t now_us) {
  wire::DeviceFrame frame;
  g_mice.make_frame(now_us, frame);
  wire::encode_device_frame(frame, g_report);
  g_usb.send_report(g_report);
}

}  // namespace

ISR(TIMER1_COMPA_vect) {
  firmware::sample_lines(g_mice.lines());
}

int main() {
  firmware::start_sampling();
  g_usb.start();
  for (;;) {
    if (!g_mice.due()) {
      firmware::sleep_until_sample();
      continue;
    }
    const uint32_t now_us = firmware::micros();
    g_mice.poll(now_us);
    g_usb.poll();
    // Enumeration first: the mice would fill counters that nobody reads.
    g_mice.allow_streaming(g_usb.configured());
    if (g_usb.wants_report()) report(now_us);
  }
}
