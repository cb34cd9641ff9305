#include "input_events.h"

#include <cstring>
#include <utility>

namespace cabinet {
namespace {

constexpr std::int64_t kOldestUs = 1'000'000;

}  // namespace

std::span<std::byte> EventReader::room() {
  return std::span(bytes_).subspan(filled_);
}

bool EventReader::next(input_event& event) {
  if (filled_ - at_ >= sizeof event) {
    std::memcpy(&event, bytes_.data() + at_, sizeof event);
    at_ += sizeof event;
    return true;
  }
  std::memmove(bytes_.data(), bytes_.data() + at_, filled_ - at_);
  filled_ -= std::exchange(at_, 0);
  return false;
}

std::optional<std::int64_t> stamp_of(const input_event& event, std::int64_t now_us) {
  // The seconds are untrusted: rejects values that would overflow.
  const std::int64_t seconds = event.input_event_sec, micros = event.input_event_usec;
  if (seconds < (now_us - kOldestUs) / 1'000'000 || seconds > now_us / 1'000'000 || micros < 0 ||
      micros >= 1'000'000) {
    return std::nullopt;
  }
  const std::int64_t stamp = seconds * 1'000'000 + micros;
  if (stamp > now_us) return std::nullopt;
  return stamp;
}

std::optional<MouseReport> MouseReports::take(const input_event& event, std::int64_t now_us,
                                              SourceCounters& counters) {
  if (event.type == EV_REL && event.code == REL_X) right_ += event.value;
  if (event.type == EV_REL && event.code == REL_Y) forward_ -= event.value;
  if (event.type != EV_SYN) return std::nullopt;
  if (event.code == SYN_DROPPED) {
    dropped_ = true;
    ++counters.lost;
  }
  if (event.code != SYN_REPORT) return std::nullopt;
  const std::optional<std::int64_t> stamp = stamp_of(event, now_us);
  if (!stamp) ++counters.stale;
  const MouseReport report{std::exchange(right_, 0), std::exchange(forward_, 0),
                           stamp.value_or(now_us)};
  if (std::exchange(dropped_, false) || (report.right == 0 && report.forward == 0))
    return std::nullopt;
  ++counters.frames;
  counters.add_latency(now_us - report.time_us);
  return report;
}

}  // namespace cabinet
