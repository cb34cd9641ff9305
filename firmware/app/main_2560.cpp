// ATmega2560: reads eight PS/2 mice and sends 250 COBS frames a second at 1 Mbaud. Receives
// commands for haptics and settings.
#include <avr/interrupt.h>

#include "app/avr_controller.h"
#include "core/command_stream.h"
#include "hal/timing.h"
#include "hal/uart.h"

namespace {

// A mouse reports every 5 ms. A frame every 4 ms delays none of these and leaves the line free.
const uint16_t kFrameUs = 4000;
// Maximum delay of a frame for motor pulses on their bus, so that a hit is felt sooner.
const int32_t kFrameWaitsUs = 1000;

firmware::AvrController g_controller;
firmware::Uart g_uart;
firmware::CommandStream g_commands;

// Its USB port is a serial bridge, so it cannot be a gamepad. It reports this by counting an error.
bool asks_for_gamepads(const wire::DeviceCommand& command) {
  return command.kind == wire::kStickCommand || (command.switches & wire::kGamepads) != 0;
}

void take_commands() {
  if (g_uart.take_lost()) {
    g_commands.spoil();
    g_controller.count_error();
  }
  uint8_t byte;
  wire::DeviceCommand command;
  while (g_uart.take(byte)) {
    switch (g_commands.byte(byte, command)) {
      case firmware::CommandStream::kNone:
        break;
      case firmware::CommandStream::kCommand:
        if (asks_for_gamepads(command)) {
          g_controller.count_error();
        } else {
          g_controller.obey(command);
        }
        return;  // one per call, so that the mice are polled in time
      case firmware::CommandStream::kError:
        g_controller.count_error();
        return;
    }
  }
}

// Skips a frame for which the UART has no capacity, before making it. The next frame has its
// counts.
void report(uint32_t now_us) {
  if (!g_uart.has_room(wire::kDeviceCobsBytes)) return;
  uint8_t bytes[wire::kDeviceFrameBytes], coded[wire::kDeviceCobsBytes];
  uint16_t question;
  if (g_controller.take_question(question)) {
    wire::encode_settings_report(g_controller.settings(), 0, question, bytes);
  } else {
    wire::DeviceFrame frame;
    g_controller.make_frame(now_us, frame);
    wire::encode_device_frame(frame, bytes);
  }
  g_uart.send(coded, static_cast<uint8_t>(wire::cobs_encode(bytes, sizeof bytes, coded)));
}

}  // namespace

ISR(TIMER1_COMPA_vect) {
  firmware::sample_lines(g_controller.lines());
  g_uart.receive();
}

// Re-enables interrupts for sampling. TWINT stays set, but with TWIE off it does not interrupt
// again.
ISR(TWI_vect) {
  TWCR = _BV(TWEN);
  sei();
  g_controller.bus().on_interrupt();
}

int main() {
  g_controller.start();
  g_uart.start();
  uint32_t next_us = kFrameUs;
  for (;;) {
    g_uart.poll();  // a byte per iteration: a byte takes 10 us, two iterations of a sleep 20
    if (!g_controller.due()) {
      if (g_uart.has_received()) take_commands();  // otherwise they wait for a turn
      continue;
    }
    const uint32_t now_us = g_controller.turn(true);
    const int32_t late_us = static_cast<int32_t>(now_us - next_us);
    const bool waits = g_controller.bus_busy() && late_us < kFrameWaitsUs;
    if (late_us >= 0 && !waits && !g_controller.after_frame()) {
      next_us += kFrameUs;
      report(now_us);
    }
    take_commands();
  }
}
