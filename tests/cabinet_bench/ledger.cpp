#include "ledger.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace cabinet_bench {
namespace {

std::uint16_t low(std::int64_t counts) {
  return static_cast<std::uint16_t>(counts);
}
std::uint16_t minus(std::uint16_t a, std::uint16_t b) {
  return static_cast<std::uint16_t>(a - b);
}

}  // namespace

void Ledger::told(int rod, const std::vector<Told>& told) {
  Rod& r = rods_[static_cast<std::size_t>(rod)];
  r.told.insert(r.told.end(), told.begin(), told.end());
}

void Ledger::record(const wire::DeviceFrame& frame, std::int64_t now_us) {
  ++totals_.frames;
  note_faults(frame, now_us);
  for (int rod = 0; rod < cabinet::kRods; ++rod) judge(rod, frame, now_us);
  last_ = frame;
}

void Ledger::note_faults(const wire::DeviceFrame& frame, std::int64_t now_us) {
  totals_.errors += frame.quality;
  totals_.resynchronised += frame.flags & 1;
  totals_.overflows += static_cast<std::uint64_t>(std::popcount(frame.overflow));
  const bool restarted =
      last_ && (static_cast<std::int32_t>(frame.time_us - last_->time_us) < 0 ||
                static_cast<std::int16_t>(minus(frame.sequence, last_->sequence)) <= 0);
  if (restarted) ++totals_.restarts;
  if (frame.quality != 0 || (frame.flags & 1) != 0) errors_us_.push_back(now_us);
  while (!errors_us_.empty() && errors_us_.front() < now_us - 2 * kMissedUs) errors_us_.pop_front();
  for (int rod = 0; rod < cabinet::kRods; ++rod) {
    Rod& r = rods_[static_cast<std::size_t>(rod)];
    const bool present = (frame.present >> rod & 1) != 0;
    if (r.present && !present) ++totals_.absences;
    r.present = present;
    if (restarted || !present || (frame.overflow >> rod & 1) != 0) r.fault_us = now_us;
  }
}

// The frame may show any report since kOldUs ago.
bool Ledger::agrees(Rod& rod, Offset counts) {
  const std::vector<Offset> now = possible(rod, counts);
  std::vector<Offset> both;
  for (const Offset& offset : rod.offsets) {
    if (std::ranges::find(now, offset) != now.end()) both.push_back(offset);
  }
  if (both.empty()) return false;
  rod.offsets = std::move(both);
  return true;
}

std::vector<Ledger::Offset> Ledger::possible(const Rod& rod, Offset counts) {
  if (rod.told.empty()) return {counts};
  std::vector<Offset> offsets;
  for (const Told& told : rod.told) {
    const Offset offset{minus(counts.slide, low(told.slide)), minus(counts.spin, low(told.spin))};
    if (std::ranges::find(offsets, offset) == offsets.end()) offsets.push_back(offset);
  }
  return offsets;
}

// A silent sensor is detected later than an error on its line.
bool Ledger::explained(const Rod& rod) const {
  if (rod.fault_us >= rod.good_us - kOldUs) return true;
  return std::ranges::any_of(errors_us_, [&](std::int64_t us) {
    return us >= rod.good_us - kCountedUs && us <= rod.good_us + kCountedUs;
  });
}

void Ledger::judge(int rod, const wire::DeviceFrame& frame, std::int64_t now_us) {
  Rod& r = rods_[static_cast<std::size_t>(rod)];
  const auto i = static_cast<std::size_t>(rod);
  while (r.told.size() > 1 && r.told[1].time_us <= now_us - kOldUs) r.told.pop_front();
  const Offset counts{frame.slide[i], frame.spin[i]};
  if (!r.present) {
    ++totals_.absent;
    r.offsets = possible(r, counts);
    r.good_us = now_us;
    r.lost = false;
    r.back = true;
    return;
  }
  if (std::exchange(r.back, false)) r.offsets = possible(r, counts);  // where it restarted
  // Lost counts stay lost, even if later frames happen to be equal.
  if (!r.lost && agrees(r, counts)) {
    ++totals_.exact;
    r.good_us = now_us;
    return;
  }
  r.lost = true;
  ++totals_.behind;
  const bool in_vain = now_us - r.good_us > kMissedUs;
  if (!explained(r) && !in_vain) return;
  if (in_vain) {
    ++totals_.unexplained;
    violations_.push_back("rod " + std::to_string(rod + 1) + ": counts are missing since " +
                          std::to_string(r.good_us) + " us");
  } else {
    ++totals_.losses;
  }
  r.offsets = possible(r, counts);
  r.good_us = now_us;
  r.lost = false;
}

}  // namespace cabinet_bench
