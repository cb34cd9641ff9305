// The RP2040's USB controller (datasheet 4.1) as a HID device. Everything except submitting a
// report runs in its interrupt, which never waits for the bus.
#ifndef FIRMWARE_RP2040_USB_CONTROLLER_H
#define FIRMWARE_RP2040_USB_CONTROLLER_H

#include <stdint.h>

#include "core/usb_requests.h"
#include "wire/device_frame.h"

namespace rp2040 {

class UsbController {
 public:
  // serial: a string descriptor that must stay valid. gamepads: adds four of them.
  void start(const uint8_t* serial, bool gamepads);
  void on_interrupt();
  // The host sees a change only by enumerating again: the device detaches for a while, not at once.
  void set_gamepads(bool on) { gamepads_wanted_ = on; }
  // Call about once a millisecond.
  void poll();

  bool configured() const { return configured_; }
  // The host has taken the last report, or there was none.
  bool wants_report() const { return configured_ && !halted_ && !report_pending_; }
  // report: wire::kDeviceReportBytes, 4-aligned, which must stay valid: GET_REPORT reads them.
  void send_report(const uint8_t* report);

  // The host has taken the last report of this gamepad.
  bool wants_pad_report(uint8_t pad) const;
  // report: firmware::kPadBytes, which must stay valid.
  void send_pad_report(uint8_t pad, const uint8_t* report);

  // Time when the host took a report, returned once for each; false: none since the last call.
  bool take_report_time(uint32_t& at_us);
  // Removes the oldest output report. out: wire::kDeviceReportBytes. Returns its size; 0: none.
  uint8_t take_command(uint8_t* out);
  // Output reports dropped since the last call because the queue was full.
  uint8_t take_dropped();

 private:
  void on_bus_reset();
  void on_setup();
  void on_control_sent();
  void on_control_received();
  void on_command();
  // Until the transfer with the request has ended, and until every hub has noticed the
  // disconnection.
  static const uint32_t kUsBeforeDetach = 100'000, kUsDetached = 100'000;

  void detach();
  void restart_all();
  void restart_reports();
  void restart_pad(uint8_t pad);
  void restart_commands();
  void send_control_packet();
  void keep_command(const volatile uint32_t* from, uint8_t size);

  firmware::UsbRequests requests_;
  const uint8_t* sending_ = nullptr;  // of a control transfer; null: none
  uint8_t left_ = 0;
  bool end_with_empty_ = false;
  bool taking_ = false;
  bool control_data1_ = false;  // of the next packet to the host
  bool report_data1_ = false;
  bool command_data1_ = false;
  bool attached_ = false;
  bool gamepads_wanted_ = false;
  uint32_t since_us_ = 0;  // last time without a pending change; then time of detaching

  // Shared with the polling loop.
  volatile bool configured_ = false;
  volatile bool halted_ = false;
  volatile bool report_pending_ = false;
  volatile uint8_t pads_ready_ = 0;  // bit i: a report may be submitted for gamepad i
  volatile uint8_t pads_data1_ = 0;
  volatile bool report_taken_ = false;
  volatile uint32_t taken_us_ = 0;
  static const uint8_t kCommands = 9;  // a pulse for each rod at once, and one unused entry
  uint32_t commands_[kCommands][wire::kDeviceReportBytes / 4] = {};
  uint8_t command_bytes_[kCommands] = {};
  volatile uint8_t command_head_ = 0, command_tail_ = 0;
  volatile uint8_t dropped_ = 0;
};

}  // namespace rp2040

#endif
