// Splits bytes from a device into frames. The bytes are untrusted: anything that is not a frame is
// counted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "cabinet/rod_input.h"
#include "wire/device_frame.h"

namespace cabinet {

// Layout of frames in the bytes from read().
enum class Packing : std::uint8_t {
  cobs,            // a stream of COBS frames, each terminated by a 0
  report_message,  // each read() returns one 64-byte report: hidraw, SOCK_SEQPACKET
  report_stream,   // contiguous 64-byte reports; one that does not decode starts a search
};

class FrameReader {
 public:
  // Drops incomplete input.
  void reset(Packing packing);
  // Buffer for the next read(); not empty once next() has returned false.
  std::span<std::uint8_t> room();
  // Reports that read() stored this many bytes (or one message of that length) there.
  void filled(std::size_t bytes, SourceCounters& counters);
  // Extracts the next complete frame. Adds invalid data before it to counters.bad.
  bool next(wire::DeviceFrame& frame, SourceCounters& counters);

 private:
  bool next_cobs(wire::DeviceFrame& frame, SourceCounters& counters);
  bool next_report(wire::DeviceFrame& frame, SourceCounters& counters);

  Packing packing_ = Packing::cobs;
  std::array<std::uint8_t, 4096> buffer_{};
  std::size_t begin_ = 0, end_ = 0;
  bool searching_ = false;  // within bytes already counted as bad
};

// A 64-byte report: a frame and 18 zeros.
bool decode_report(std::span<const std::uint8_t> report, wire::DeviceFrame& frame);

}  // namespace cabinet
