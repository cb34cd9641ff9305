// A source that may be plugged in, out and in again, and what a person is to be told of it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "cabinet/rod_input.h"

namespace cabinet {

constexpr std::size_t kMostPacket = 65;  // bytes of one to a device: a HID report and its number

// What the descriptor shows of the device. A person is told something else for each.
enum class DeviceState : std::uint8_t {
  missing,  // not open: it is not there, or hung up
  refused,  // not open, though it is there: open_error() says why
  silent,   // open, but no byte comes
  garbled,  // open, bytes come, but no frame among them is taken
  live,     // frames come, or a recording waits for the time of its next one
  over,     // a recording, played to its end
};

// Of a device that is not open, by errno of the last attempt; 0: it was open and hung up.
DeviceState state_of_error(int error);

class Device : public InputSource {
 public:
  // As of the last poll.
  virtual DeviceState state() const = 0;
  virtual int open_error() const = 0;  // errno of the last attempt to open it, if that failed
  virtual const RodCounts& counts() const = 0;
  bool connected() const { return state() == DeviceState::live; }
};

}  // namespace cabinet
