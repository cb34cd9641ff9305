// The ATmega32U4's USB controller as a HID device. Everything is polled and nothing waits: a
// control transfer advances by at most one packet a call, so the mice are never kept waiting.
#ifndef FIRMWARE_HAL_USB_DEVICE_H
#define FIRMWARE_HAL_USB_DEVICE_H

#include <stdint.h>

#include "core/usb_requests.h"
#include "wire/device_command.h"

namespace firmware {

class UsbDevice {
 public:
  // serial: a string descriptor, which stays where it is. gamepads: four of them besides.
  void start(const uint8_t* serial, bool gamepads);
  // Five thousand times a second.
  void poll();
  // What the host hears by enumerating again: the device leaves the bus for a while, not at once.
  void set_gamepads(bool on) { gamepads_wanted_ = on; }

  // The host has chosen the configuration and reads reports.
  bool configured() const { return requests_.configured(); }
  // The host has taken the last report. The next is made at once, not just before it is asked for:
  // with all mice talking, making one may take most of the millisecond.
  bool wants_report() const {
    return configured() && !requests_.report_halted() && !report_pending_;
  }
  // report: wire::kDeviceReportBytes, which stay where they are: GET_REPORT reads them again.
  void send_report(const uint8_t* report);

  bool gamepads() const { return configured() && requests_.gamepads(); }
  // The host has taken the last report of this gamepad.
  bool wants_pad_report(uint8_t pad) const;
  // report: kPadBytes, which stay where they are.
  void send_pad_report(uint8_t pad, const uint8_t* report);

  // The oldest output report not yet taken; while it waits the host has to. out: as much of it as a
  // command has, wire::kDeviceCommandBytes. Returns the report's size; 0: none.
  uint8_t take_command(uint8_t* out);

 private:
  // Of poll(), 0.1 s each: until the transfer that asked for it has ended, and until no hub takes
  // it for the same device.
  static const uint16_t kPollsBeforeDetach = 500, kPollsDetached = 500;

  void attach();
  void change();
  void on_bus_reset();
  void serve_control();
  void on_setup();
  void send_control_packet();
  void take_control_packet();
  void configure_endpoints();
  void configure_endpoint(uint8_t number, bool on, uint8_t direction, uint8_t size);

  UsbRequests requests_;
  const uint8_t* sending_ = nullptr;  // of a control transfer; null: none
  uint8_t left_ = 0;
  bool in_flash_ = false;
  bool end_with_empty_ = false;
  bool taking_ = false;  // the host sends an output report by a control transfer
  bool attached_ = false;
  bool gamepads_wanted_ = false;
  uint16_t polls_ = 0;                               // towards leaving the bus, or coming back
  bool report_pending_ = false;                      // in the endpoint, not yet taken
  uint8_t command_[wire::kDeviceCommandBytes] = {};  // that came by a control transfer
  uint8_t command_size_ = 0;                         // of the report; 0: none waits
};

}  // namespace firmware

#endif
