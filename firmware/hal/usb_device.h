// The ATmega32U4's USB controller as a HID device. Everything is polled and nothing blocks: a
// control transfer advances by at most one packet per call, so that the mice are polled in time.
#ifndef FIRMWARE_HAL_USB_DEVICE_H
#define FIRMWARE_HAL_USB_DEVICE_H

#include <stdint.h>

#include "core/usb_requests.h"
#include "wire/device_command.h"

namespace firmware {

class UsbDevice {
 public:
  // serial: a string descriptor that must stay valid. gamepads: adds four of them.
  void start(const uint8_t* serial, bool gamepads);
  // Call five thousand times a second.
  void poll();
  // The host sees a change only by enumerating again: the device detaches for a while, not at once.
  void set_gamepads(bool on) { gamepads_wanted_ = on; }

  // The host has set the configuration and reads reports.
  bool configured() const { return requests_.configured(); }
  // The host has taken the last report. Make the next one at once, not just before the host polls:
  // while all mice send, making it may take most of the millisecond.
  bool wants_report() const {
    return configured() && !requests_.report_halted() && !report_pending_;
  }
  // report: wire::kDeviceReportBytes, which must stay valid: GET_REPORT reads them again.
  void send_report(const uint8_t* report);

  bool gamepads() const { return configured() && requests_.gamepads(); }
  // The host has taken the last report of this gamepad.
  bool wants_pad_report(uint8_t pad) const;
  // report: kPadBytes, which must stay valid.
  void send_pad_report(uint8_t pad, const uint8_t* report);

  // Removes the oldest output report; until then the host has to wait. out: at most the bytes of a
  // command, wire::kDeviceCommandBytes. Returns the report's size; 0: none.
  uint8_t take_command(uint8_t* out);

 private:
  // In calls of poll(), 100 ms each: until the transfer with the request has ended, and until every
  // hub has noticed the disconnection.
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
  bool taking_ = false;  // the host sends an output report in a control transfer
  bool attached_ = false;
  bool gamepads_wanted_ = false;
  uint16_t polls_ = 0;                               // counts to detaching or attaching
  bool report_pending_ = false;                      // in the endpoint, not yet taken by the host
  uint8_t command_[wire::kDeviceCommandBytes] = {};  // received in a control transfer
  uint8_t command_size_ = 0;                         // of the received report; 0: none
};

}  // namespace firmware

#endif
