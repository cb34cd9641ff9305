// Bytes 0 and 1: the size of a piece, and whether the mouse is plugged in again after it. The rest:
// data read from a mouse's node, passed through a pipe to the source.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "cabinet/mouse_source.h"
#include "input_events.h"

namespace {

using namespace cabinet;

void check(bool holds) {
  if (!holds) std::abort();
}

// Parses events as the source does, without a source: each event once, for any piece size.
std::uint64_t reports_of(const std::uint8_t* data, std::size_t size, std::size_t piece) {
  EventReader reader;
  MouseReports reports;
  SourceCounters counters;
  input_event event;
  std::uint64_t made = 0;
  for (std::size_t at = 0; at < size;) {
    const auto room = reader.room();
    check(!room.empty());
    const std::size_t bytes = std::min({piece, room.size(), size - at});
    std::copy_n(reinterpret_cast<const std::byte*>(data + at), bytes, room.data());
    reader.filled(bytes);
    at += bytes;
    while (reader.next(event)) {
      const auto report = reports.take(event, 5'000'000, counters);
      if (!report) continue;
      ++made;
      check(report->right != 0 || report->forward != 0);
      check(report->time_us >= 3'000'000 && report->time_us <= 5'000'000);
    }
  }
  check(counters.frames == made && counters.stamped == made);
  return made;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::size_t piece = std::size_t{1} + data[0];
  const bool replugs = data[1] % 2 == 1;
  data += 2;
  size -= 2;
  check(reports_of(data, size, piece) == reports_of(data, size, sizeof(input_event)));

  int ends[2] = {-1, -1};
  MouseOptions options;
  options.slide_limit = 0.126;
  options.reopen_us = 0;
  MouseSource source(options, [&ends] {
    check(::pipe2(ends, O_NONBLOCK | O_CLOEXEC) == 0);
    return ends[0];
  });
  std::int64_t now_us = 5'000'000;
  source.poll(now_us);
  std::uint64_t reopened = 0;
  for (std::size_t at = 0; at < size;) {
    const std::size_t bytes = std::min(piece, size - at);
    check(::write(ends[1], data + at, bytes) == static_cast<ssize_t>(bytes));
    at += bytes;
    source.poll(now_us += 1'000);
    if (!replugs) continue;
    ::close(ends[1]);
    source.poll(now_us += 1'000);
    check(source.state() == DeviceState::missing && source.rods()[3].status == RodStatus::held);
    source.poll(now_us += 1'000);
    ++reopened;
  }
  const RodInput& rod = source.rods()[3];
  check(std::isfinite(rod.slide) && std::isfinite(rod.angle));
  check(std::isfinite(rod.slide_rate) && std::isfinite(rod.angle_rate));
  check(std::abs(rod.slide) <= options.slide_limit && rod.status == RodStatus::live);
  check(source.counters().frames * sizeof(input_event) <= size);
  check(source.counters().reopened == reopened);
  ::close(ends[1]);
  return 0;
}
