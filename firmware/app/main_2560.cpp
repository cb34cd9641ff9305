// ATmega2560: eight PS/2 mice in, 250 COBS frames a second out at 1 Mbaud.
#include <avr/interrupt.h>

#include "core/mouse_host.h"
#include "hal/timing.h"
#include "hal/uart.h"
#include "wire/device_frame.h"

namespace {

// A mouse reports every 5 ms; a frame every 4 ms delays none and leaves the line free.
const uint16_t kFrameUs = 4000;

firmware::MouseHost g_mice;
firmware::Uart g_uart;

void report(uint32_t now_us) {
  wire::DeviceFrame frame;
  uint8_t bytes[wire::kDeviceFrameBytes], coded[wire::kDeviceCobsBytes];
  g_mice.make_frame(now_us, frame);
  wire::encode_device_frame(frame, bytes);
  g_uart.send(coded, static_cast<uint8_t>(wire::cobs_encode(bytes, sizeof bytes, coded)));
}

}  // namespace

ISR(TIMER1_COMPA_vect) {
  firmware::sample_lines(g_mice.lines());
}

int main() {
  firmware::start_sampling();
  g_uart.start();
  g_mice.allow_streaming(true);
  uint32_t next_us = kFrameUs;
  for (;;) {
    g_uart.poll();  // a byte each time round: one takes 10 us, two rounds of a sleep 20
    if (!g_mice.due()) {
      firmware::sleep_until_sample();
      continue;
    }
    const uint32_t now_us = firmware::micros();
    g_mice.poll(now_us);
    if (static_cast<int32_t>(now_us - next_us) >= 0) {
      next_us += kFrameUs;
      report(now_us);
    }
  }
}
