// Cuts bytes from a device into frames. Bytes are a stranger's: whatever is not a frame is counted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "cabinet/rod_input.h"
#include "wire/device_frame.h"

namespace cabinet {

// How frames lie in what read() returns.
enum class Packing : std::uint8_t {
  cobs,            // a stream: COBS, each frame closed by a 0
  report_message,  // one read() is one 64-byte report: hidraw, SOCK_SEQPACKET
  report_stream,   // 64-byte reports end to end; one that does not decode starts a search
};

class FrameReader {
 public:
  // Forgets what was half read.
  void reset(Packing packing);
  // Where read() may put bytes; never empty once next() has returned false.
  std::span<std::uint8_t> room();
  // read() put so many bytes (or one message of that length) there.
  void filled(std::size_t bytes, SourceCounters& counters);
  // The next whole frame; adds to counters.bad what lies before it and is none.
  bool next(wire::DeviceFrame& frame, SourceCounters& counters);

 private:
  bool next_cobs(wire::DeviceFrame& frame, SourceCounters& counters);
  bool next_report(wire::DeviceFrame& frame, SourceCounters& counters);

  Packing packing_ = Packing::cobs;
  std::array<std::uint8_t, 4096> buffer_{};
  std::size_t begin_ = 0, end_ = 0;
  bool searching_ = false;  // inside bytes already counted as bad
};

// A 64-byte report: a frame and 18 zeros.
bool decode_report(std::span<const std::uint8_t> report, wire::DeviceFrame& frame);

}  // namespace cabinet
