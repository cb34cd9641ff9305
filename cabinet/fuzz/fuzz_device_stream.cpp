// Byte 0: packing and piece size. The rest: data from a device.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "frame_reader.h"
#include "rod_tracker.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  using namespace cabinet;
  FrameReader reader;
  reader.reset(static_cast<Packing>(data[0] % 3));
  const std::size_t piece = 1 + data[0] / 3;
  Calibration calibration = nominal_calibration();
  for (RodCalibration& rod : calibration.rods) rod.index = IndexMark{0.5, 0.4, 0.01};
  RodTracker tracker(calibration, {});
  SourceCounters counters;
  wire::DeviceFrame frame;
  std::int64_t now_us = 0;
  for (std::size_t at = 1; at < size;) {
    const auto room = reader.room();
    if (room.empty()) std::abort();
    const std::size_t bytes = std::min({piece, room.size(), size - at});
    std::memcpy(room.data(), data + at, bytes);
    at += bytes;
    reader.filled(bytes, counters);
    while (reader.next(frame, counters)) {
      now_us += 1'000;
      tracker.accept(frame, now_us, now_us, counters);
    }
  }
  tracker.hold();
  for (const RodInput& rod : tracker.rods()) {
    if (!std::isfinite(rod.slide) || !std::isfinite(rod.angle)) std::abort();
    if (rod.slide_rate != 0 || rod.angle_rate != 0 || rod.status == RodStatus::live) std::abort();
  }
  if (counters.frames + counters.stale + counters.bad > size) std::abort();
  return 0;
}
