// Fuzzes with the snapshots of any server that the decoders accept: ticks that jump, repeat and go
// back, any tick length, any times. Nothing overflows, the delay stays within its bounds, and
// accepted snapshots are shown.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "client/snapshot_buffer.h"
#include "wire/limits.h"

namespace {

class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> data) : data_(data) {}
  bool any() const { return !data_.empty(); }
  // The next `size` bytes as a number; missing bytes are 0.
  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    const std::size_t there = std::min(size, data_.size());
    std::memcpy(&value, data_.data(), there);
    data_ = data_.subspan(there);
    return value;
  }

 private:
  std::span<const std::uint8_t> data_;
};

constexpr std::uint64_t kSession = 7;

void require(bool holds) {
  if (!holds) std::abort();
}

wire::Snapshot snapshot(Bytes& in, std::uint64_t tick) {
  wire::Snapshot s;
  s.session = kSession;
  s.tick = tick;
  s.sequence = in.number(1) % 2 == 0 ? tick : in.number(8);
  s.paused = in.number(1) % 8 == 0;
  s.events.resize(in.number(1) % 3);
  for (wire::EventSnapshot& event : s.events) event.id = static_cast<std::uint32_t>(in.number(4));
  return s;
}

std::uint64_t next_tick(Bytes& in, std::uint64_t tick) {
  if (in.number(1) % 4 == 0) return in.number(6) & wire::kMaxTick;
  return std::min(tick + in.number(1) % 4, wire::kMaxTick);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes in(std::span(data, size));
  const auto tick_us = static_cast<std::uint32_t>(in.number(2) % wire::kMaxTickUs + 1);
  client::SnapshotBuffer buffer;
  buffer.begin_session(kSession, tick_us);
  std::int64_t now_us = static_cast<std::int64_t>(in.number(6));
  std::uint64_t tick = 0;
  while (in.any()) {
    now_us += static_cast<std::int64_t>(in.number(3));
    tick = next_tick(in, tick);
    buffer.push(snapshot(in, tick), now_us);
    const client::SceneSample sample = buffer.sample(now_us);
    buffer.take_events();
    require(sample.any && sample.state.session == kSession);
    require(buffer.delay_us() > 0 && buffer.delay_us() <= client::SnapshotBuffer::kLongestDelayUs);
  }
  return 0;
}
