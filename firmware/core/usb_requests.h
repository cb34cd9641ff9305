// What a HID device answers to the control requests of its host, apart from any USB controller: the
// controller's driver hands in the setup packet and carries out the answer.
#ifndef FIRMWARE_CORE_USB_REQUESTS_H
#define FIRMWARE_CORE_USB_REQUESTS_H

#include <stdint.h>

#include "core/usb_descriptors.h"

namespace firmware {

struct UsbSetup {
  uint8_t type, request;
  uint16_t value, index, length;

  bool to_host() const { return (type & 0x80) != 0; }
};

// bytes: 8 of a setup packet.
UsbSetup read_setup(const uint8_t* bytes);

struct UsbAnswer {
  enum Kind : uint8_t {
    kStall,
    kDone,        // an empty status packet
    kSend,        // bytes, size of them, in packets; then the host's empty packet
    kTake,        // the host sends an output report of size bytes, in one packet
    kConfigure,   // kDone, and all endpoints start again: configured() has changed or was set again
    kReportHalt,  // kDone, and the report endpoint starts again, or stalls: report_halted()
    kCommandHalt,  // the same of the command endpoint
    kPadHalt,      // the same of the endpoint of gamepad number size
  };
  Kind kind;
  const uint8_t* bytes;
  uint8_t size;
  bool end_with_empty;  // the host asked for more than the last full packet says
  bool in_flash;        // bytes are those of a Descriptor
};

class UsbRequests {
 public:
  // serial: a whole string descriptor, null: none. It and the report stay where they are.
  void set_serial(const uint8_t* descriptor) { serial_ = descriptor; }
  void set_report(const uint8_t* report) { report_ = report; }
  void set_pad_report(uint8_t pad, const uint8_t* report) { pad_reports_[pad] = report; }

  // Four gamepads besides. The host must not be attached: it hears of them as it enumerates.
  void set_gamepads(bool on) { gamepads_ = on; }
  bool gamepads() const { return gamepads_; }

  void on_bus_reset();
  UsbAnswer answer(const UsbSetup& setup);

  // The address that takes effect once the status packet is out; 0: none.
  uint8_t new_address() const { return new_address_; }
  void address_taken() { new_address_ = 0; }
  bool configured() const { return configuration_ != 0; }
  bool report_halted() const { return report_halted_; }
  bool command_halted() const { return command_halted_; }
  bool pad_halted(uint8_t pad) const { return (pads_halted_ >> pad & 1) != 0; }

 private:
  static const uint8_t kInterfaces = 1 + kPads;

  UsbAnswer standard(const UsbSetup& setup);
  UsbAnswer hid(const UsbSetup& setup);
  UsbAnswer get_report(const UsbSetup& setup);
  UsbAnswer descriptor(const UsbSetup& setup);
  UsbAnswer feature(const UsbSetup& setup, bool set);
  UsbAnswer status(const UsbSetup& setup);
  bool has_interface(uint16_t number) const {
    return number == 0 || (gamepads_ && number < kInterfaces);
  }
  uint8_t pad_of_endpoint(uint16_t address) const;
  UsbAnswer send_byte(uint8_t value, uint8_t size, const UsbSetup& setup);

  const uint8_t* serial_ = nullptr;
  const uint8_t* report_ = nullptr;
  uint8_t small_[2] = {};
  uint8_t new_address_ = 0;
  uint8_t configuration_ = 0;
  uint8_t idle_[kInterfaces] = {};
  bool report_halted_ = false;
  bool command_halted_ = false;
  bool gamepads_ = false;
  uint8_t pads_halted_ = 0;  // bit i: gamepad i
  const uint8_t* pad_reports_[kPads] = {};
};

}  // namespace firmware

#endif
