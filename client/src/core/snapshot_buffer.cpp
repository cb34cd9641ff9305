#include "client/snapshot_buffer.h"

#include <algorithm>
#include <utility>

#include "client/interpolator.h"

namespace client {
namespace {

// Beyond this the server stood still or skipped: the clocks are aligned again.
constexpr std::int64_t kResyncUs = 100'000;
// The drawn time runs at most this much faster or slower during a correction, which is invisible.
constexpr std::int64_t kSlewShare = 12;  // one part in 12

}  // namespace

void SnapshotBuffer::begin_session(std::uint64_t session, std::uint32_t tick_us) {
  lost_before_ = counters().lost;
  first_sequence_ = newest_sequence_ = in_session_ = 0;
  offset_count_ = offset_next_ = 0;
  if (session == session_) return;
  session_ = session;
  tick_us_ = tick_us;
  kept_.clear();
  events_.clear();
  playing_ = any_event_ = false;
  doubted_ = 0;
  last_sequence_ = 0;
}

SnapshotCounters SnapshotBuffer::counters() const {
  SnapshotCounters counters = counters_;
  const std::uint64_t span = in_session_ > 0 ? newest_sequence_ - first_sequence_ + 1 : 0;
  counters.lost = lost_before_ + (span > in_session_ ? span - in_session_ : 0);
  return counters;
}

void SnapshotBuffer::count_sequence(std::uint64_t sequence, bool newest) {
  if (in_session_ == 0) first_sequence_ = newest_sequence_ = sequence;
  first_sequence_ = std::min(first_sequence_, sequence);
  newest_sequence_ = std::max(newest_sequence_, sequence);
  last_sequence_ = std::max(last_sequence_, sequence);
  ++in_session_;
  ++counters_.received;
  if (!newest) ++counters_.reordered;
}

// False for a tick that is already here or too old. While the match stands still (a pause that does
// not count ticks), the newer of two snapshots of a tick replaces the older.
bool SnapshotBuffer::insert(wire::Snapshot snapshot) {
  auto place = kept_.end();
  while (place != kept_.begin() && std::prev(place)->tick > snapshot.tick) --place;
  if (place != kept_.begin() && std::prev(place)->tick == snapshot.tick) {
    wire::Snapshot& same = *std::prev(place);
    if (snapshot.sequence <= same.sequence) return false;
    same = std::move(snapshot);
    return true;
  }
  if (place == kept_.begin() && kept_.size() >= kKept) return false;
  kept_.insert(place, std::move(snapshot));
  if (kept_.size() > kKept) kept_.pop_front();
  return true;
}

bool SnapshotBuffer::jumps(const wire::Snapshot& snapshot, std::int64_t arrival_us) const {
  const std::int64_t passed = std::max<std::int64_t>(0, arrival_us - last_arrival_us_);
  const auto ahead = static_cast<std::uint64_t>((passed + kAheadUs) / tick_us_);
  const wire::Snapshot& newest = kept_.back();
  const bool later = snapshot.sequence > last_sequence_;
  return snapshot.tick > newest.tick + ahead ||
         (later && snapshot.sequence - last_sequence_ > ahead) ||
         (later && snapshot.tick + kKept < newest.tick);
}

bool SnapshotBuffer::plausible(const wire::Snapshot& snapshot, std::int64_t arrival_us) {
  if (kept_.empty() || !jumps(snapshot, arrival_us)) {
    doubted_ = 0;
    return true;
  }
  const bool agrees = doubted_ > 0 && snapshot.sequence > doubted_sequence_ &&
                      snapshot.sequence - doubted_sequence_ <= kKept &&
                      snapshot.tick >= doubted_tick_ && snapshot.tick - doubted_tick_ <= kKept;
  doubted_ = agrees ? doubted_ + 1 : 1;
  doubted_tick_ = snapshot.tick;
  doubted_sequence_ = snapshot.sequence;
  if (doubted_ < kAgreeing) return false;
  // The server jumped: the stored snapshots belong to another time.
  begin_session(session_ ^ 1, static_cast<std::uint32_t>(tick_us_));
  session_ ^= 1;
  return true;
}

SnapshotBuffer::Verdict SnapshotBuffer::push(wire::Snapshot snapshot, std::int64_t arrival_us) {
  if (snapshot.session != session_) {
    ++counters_.foreign;
    return Verdict::foreign;
  }
  if (!plausible(snapshot, arrival_us)) {
    ++counters_.implausible;
    return Verdict::implausible;
  }
  const bool newest = kept_.empty() || snapshot.tick > kept_.back().tick;
  const bool standing = !kept_.empty() && snapshot.tick == kept_.back().tick &&
                        snapshot.sequence > kept_.back().sequence;
  const std::uint64_t sequence = snapshot.sequence;
  const std::int64_t offset = arrival_us - time_of(snapshot);
  note_events(snapshot);
  if (!insert(std::move(snapshot))) {
    ++counters_.old;
    return Verdict::old;
  }
  count_sequence(sequence, newest || standing);
  last_arrival_us_ = arrival_us;
  if (newest) note_arrival(offset);
  return Verdict::taken;
}

void SnapshotBuffer::note_arrival(std::int64_t offset_us) {
  if (offset_count_ > 0 && std::abs(offset_us - fastest_us_) > kResyncUs + delay_us_)
    offset_count_ = offset_next_ = 0;
  offsets_[offset_next_] = offset_us;
  offset_next_ = (offset_next_ + 1) % kWindow;
  offset_count_ = std::min(offset_count_ + 1, kWindow);
  // The percentile is expensive; computing it once in a thirty-second of the window is enough.
  if (offset_count_ > 8 && offset_next_ % 8 != 0) {
    fastest_us_ = std::min(fastest_us_, offset_us);
    return;
  }
  std::array<std::int64_t, kWindow> sorted{};
  const auto end = std::copy_n(offsets_.begin(), offset_count_, sorted.begin());
  fastest_us_ = *std::min_element(sorted.begin(), end);
  const auto late = sorted.begin() + static_cast<std::ptrdiff_t>((offset_count_ - 1) * 98 / 100);
  std::nth_element(sorted.begin(), late, end);
  delay_us_ = std::min(tick_us_ * 3 / 2 + (*late - fastest_us_), kLongestDelayUs);
}

// An event is repeated in several snapshots; its increasing id identifies new ones.
void SnapshotBuffer::note_events(const wire::Snapshot& snapshot) {
  for (const wire::EventSnapshot& event : snapshot.events) {
    if (any_event_ && static_cast<std::int32_t>(event.id - last_event_) <= 0) continue;
    events_.push_back({snapshot.tick, event});
    last_event_ = event.id;
    any_event_ = true;
  }
  while (events_.size() > kWindow) events_.pop_front();
}

std::vector<wire::EventSnapshot> SnapshotBuffer::take_events() {
  std::vector<wire::EventSnapshot> reached;
  while (!events_.empty() &&
         static_cast<std::int64_t>(events_.front().tick) * tick_us_ <= play_us_) {
    reached.push_back(events_.front().event);
    events_.pop_front();
  }
  return reached;
}

std::int64_t SnapshotBuffer::play_time(std::int64_t now_us) {
  const std::int64_t wanted = now_us - fastest_us_ - delay_us_;
  const std::int64_t elapsed = now_us - sampled_at_us_;
  sampled_at_us_ = now_us;
  const std::int64_t error = wanted - (play_us_ + elapsed);
  if (!playing_ || std::abs(error) > kResyncUs) {
    playing_ = true;
    return play_us_ = wanted;
  }
  const std::int64_t max = elapsed / kSlewShare;
  return play_us_ += elapsed + std::clamp(error, -max, max);
}

SceneSample SnapshotBuffer::sample(std::int64_t now_us) {
  SceneSample sample;
  if (kept_.empty()) return sample;
  sample.any = true;
  const std::int64_t at = play_time(now_us);
  const wire::Snapshot& newest = kept_.back();
  if (newest.paused) {
    sample.state = newest;
  } else if (at >= time_of(newest)) {
    const std::int64_t ahead = at - time_of(newest);
    sample.starving = ahead > kExtrapolateUs;
    sample.state = extrapolate(newest, 1e-6 * static_cast<double>(std::min(ahead, kExtrapolateUs)));
  } else if (at <= time_of(kept_.front())) {
    sample.state = kept_.front();
  } else {
    auto after = kept_.end() - 1;
    while (time_of(*std::prev(after)) > at) --after;
    const auto before = std::prev(after);
    const auto span = static_cast<double>(time_of(*after) - time_of(*before));
    sample.state = interpolate(*before, *after, static_cast<double>(at - time_of(*before)) / span,
                               1e-6 * span);
  }
  return sample;
}

}  // namespace client
