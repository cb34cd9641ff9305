// An input source that may be plugged in and unplugged at any time, with a state to report to the
// person.
#pragma once

#include <cstddef>
#include <cstdint>

#include "cabinet/rod_input.h"

namespace cabinet {

// [bytes] of a packet to a device: report ID and HID report.
constexpr std::size_t kMaxPacket = 65;

// State of the device as seen from its descriptor. The message to the person differs for each.
enum class DeviceState : std::uint8_t {
  missing,  // not open: not connected, or hung up
  refused,  // connected, but opening it failed: see open_error()
  silent,   // open, but no byte arrives
  garbled,  // open, bytes arrive, but none form a valid frame
  live,     // frames arrive, or a recording waits for its next one
  over,     // a recording, played to its end
};

// State of a device that is not open, from errno of the last attempt; 0: it was open and hung up.
DeviceState state_of_error(int error);

class Device : public InputSource {
 public:
  // As of the last poll().
  virtual DeviceState state() const = 0;
  virtual int open_error() const = 0;  // errno if the last attempt to open the device failed
  virtual const RodCounts& counts() const = 0;
  bool connected() const { return state() == DeviceState::live; }
};

}  // namespace cabinet
