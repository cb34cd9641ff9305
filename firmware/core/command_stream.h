// Decodes commands from the bytes of a serial line: COBS, terminated by 0 (wire/device_command.h).
// Noise invalidates the command it falls into and is reported as an error.
#ifndef FIRMWARE_CORE_COMMAND_STREAM_H
#define FIRMWARE_CORE_COMMAND_STREAM_H

#include "wire/device_command.h"

namespace firmware {

class CommandStream {
 public:
  enum Event : uint8_t { kNone, kCommand, kError };

  // Writes command only if it returns kCommand.
  Event byte(uint8_t value, wire::DeviceCommand& command) {
    if (value != 0) {
      if (size_ < sizeof coded_) {
        coded_[size_++] = value;
      } else {
        spoilt_ = true;
      }
      return kNone;
    }
    const uint8_t size = size_;
    const bool spoilt = spoilt_;
    size_ = 0;
    spoilt_ = false;
    if (spoilt) return kError;
    // A sender may first send 0 to terminate earlier bytes on the line.
    if (size == 0) return kNone;
    uint8_t bytes[wire::kDeviceCommandBytes];
    const size_t decoded = wire::cobs_decode(coded_, size, bytes, sizeof bytes);
    return wire::decode_device_command(bytes, decoded, command) ? kCommand : kError;
  }
  // A byte was lost or damaged: the command in progress is invalid.
  void spoil() { spoilt_ = true; }

 private:
  uint8_t coded_[wire::kDeviceCommandBytes + 1];
  uint8_t size_ = 0;
  bool spoilt_ = false;
};

}  // namespace firmware

#endif
