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
    kDone,       // an empty status packet
    kSend,       // bytes, size of them, in packets; then the host's empty packet
    kTake,       // the host sends an output report of size bytes, in one packet
    kConfigure,  // kDone, and both endpoints start again: configured() has changed or was set again
    kReportHalt,   // kDone, and the report endpoint starts again, or stalls: report_halted()
    kCommandHalt,  // the same of the command endpoint
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

  void on_bus_reset();
  UsbAnswer answer(const UsbSetup& setup);

  // The address that takes effect once the status packet is out; 0: none.
  uint8_t new_address() const { return new_address_; }
  void address_taken() { new_address_ = 0; }
  bool configured() const { return configuration_ != 0; }
  bool report_halted() const { return report_halted_; }
  bool command_halted() const { return command_halted_; }

 private:
  UsbAnswer standard(const UsbSetup& setup);
  UsbAnswer hid(const UsbSetup& setup);
  UsbAnswer descriptor(const UsbSetup& setup);
  UsbAnswer feature(const UsbSetup& setup, bool set);
  UsbAnswer send_byte(uint8_t value, uint8_t size, const UsbSetup& setup);

  const uint8_t* serial_ = nullptr;
  const uint8_t* report_ = nullptr;
  uint8_t small_[2] = {};
  uint8_t new_address_ = 0;
  uint8_t configuration_ = 0;
  uint8_t idle_ = 0;
  bool report_halted_ = false;
  bool command_halted_ = false;
};

}  // namespace firmware

#endif
