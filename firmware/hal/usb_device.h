// The ATmega32U4's USB controller as a HID device. Everything is polled and nothing waits: a
// control transfer advances by at most one packet a call, so the mice are never kept waiting.
#ifndef FIRMWARE_HAL_USB_DEVICE_H
#define FIRMWARE_HAL_USB_DEVICE_H

#include <stdint.h>

#include "wire/device_frame.h"

namespace firmware {

class UsbDevice {
 public:
  void start();
  void poll();

  // The host has chosen the configuration and reads reports.
  bool configured() const { return configuration_ != 0; }
  // The host has taken the last report. The next is made at once, not just before it is asked for:
  // with all mice talking, making one may take most of the millisecond.
  bool wants_report() const { return configuration_ != 0 && !halted_ && !report_pending_; }
  // report: wire::kDeviceReportBytes, which stay where they are: GET_REPORT reads them again.
  void send_report(const uint8_t* report);

 private:
  struct Setup {
    uint8_t type, request;
    uint16_t value, index, length;
  };

  void attach();
  void on_bus_reset();
  void serve_control();
  void on_setup();
  bool answer(const Setup& setup);
  bool answer_standard(const Setup& setup);
  bool answer_hid(const Setup& setup);
  void reply(const uint8_t* bytes, uint8_t size, bool in_flash, uint16_t asked);
  void reply_byte(uint8_t value, uint8_t second, uint8_t size, uint16_t asked);
  void send_control_packet();
  void configure(uint8_t configuration);

  const uint8_t* last_report_ = nullptr;
  const uint8_t* reply_ = nullptr;
  uint8_t small_[2] = {};
  uint8_t reply_left_ = 0;
  bool reply_in_flash_ = false;
  bool replying_ = false;
  bool end_with_empty_ = false;  // the host asked for more than a full packet says
  bool attached_ = false;
  bool halted_ = false;  // endpoint 1, by SET_FEATURE
  uint8_t new_address_ = 0;
  uint8_t configuration_ = 0;
  uint8_t idle_ = 0;
  bool report_pending_ = false;  // in the endpoint, not yet taken
};

}  // namespace firmware

#endif
