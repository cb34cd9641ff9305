// The responses of a HID device to control requests, independent of the USB controller. The
// controller's driver passes in the setup packet and carries out the answer.
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

// bytes: the 8 bytes of a setup packet.
UsbSetup read_setup(const uint8_t* bytes);

struct UsbAnswer {
  enum Kind : uint8_t {
    kStall,
    kDone,         // a zero-length status packet
    kSend,         // `size` bytes at `bytes`, in packets; then the host's zero-length packet
    kTake,         // the host sends an output report of `size` bytes in one packet
    kConfigure,    // kDone, and all endpoints restart: configured() was changed or set again
    kReportHalt,   // kDone, and the report endpoint restarts or stalls: report_halted()
    kCommandHalt,  // the same for the command endpoint
    kPadHalt,      // the same for the endpoint of gamepad `size`
  };
  Kind kind;
  const uint8_t* bytes;
  uint8_t size;
  bool end_with_empty;  // a zero-length packet must follow a full last packet
  bool in_flash;        // bytes points to a Descriptor
};

class UsbRequests {
 public:
  // descriptor: a complete string descriptor, or null: none. The pointers must stay valid.
  void set_serial(const uint8_t* descriptor) { serial_ = descriptor; }
  void set_report(const uint8_t* report) { report_ = report; }
  void set_pad_report(uint8_t pad, const uint8_t* report) { pad_reports_[pad] = report; }

  // Adds four gamepads. Precondition: not attached to a host, which reads this at enumeration.
  void set_gamepads(bool on) { gamepads_ = on; }
  bool gamepads() const { return gamepads_; }

  void on_bus_reset();
  UsbAnswer answer(const UsbSetup& setup);

  // Takes effect after the status packet is sent; 0: none.
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
