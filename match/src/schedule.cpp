#include "match/schedule.h"

#include <algorithm>

namespace match {

void Schedule::add(std::vector<SeriesDesc> series) {
  for (SeriesDesc& desc : series) series_.emplace_back(std::move(desc));
  handed_out_.resize(series_.size(), 0);
}

void Schedule::know(JobId id, const GameResult& result) {
  if (id.series >= series_.size() || id.game >= series_[id.series].desc().max_games) return;
  waiting_.insert_or_assign(id, result);
  take_known(id.series);
}

// Prefers the series with the fewest games assigned beyond its results, so that few games are
// played unnecessarily.
std::optional<JobId> Schedule::next() {
  while (!returned_.empty()) {
    const JobId id = returned_.back();
    returned_.pop_back();
    if (!series_[id.series].decided()) return id;
  }
  std::optional<std::size_t> best;
  const auto ahead = [&](std::size_t i) { return handed_out_[i] - series_[i].taken(); };
  for (std::size_t i = 0; i < series_.size(); ++i) {
    handed_out_[i] = std::max(handed_out_[i], series_[i].taken());
    while (waiting_.contains({i, handed_out_[i]})) ++handed_out_[i];
    if (series_[i].decided() || handed_out_[i] >= series_[i].desc().max_games) continue;
    if (!best || ahead(i) < ahead(*best)) best = i;
  }
  if (!best) return std::nullopt;
  return JobId{*best, handed_out_[*best]++};
}

bool Schedule::complete(JobId id, const GameResult& result) {
  const Series& series = series_[id.series];
  if (id.game < series.taken() || waiting_.contains(id)) return false;
  if (series.decided()) return uncounted_.insert(id).second;
  waiting_.emplace(id, result);
  take_known(id.series);
  return true;
}

void Schedule::take_known(std::size_t index) {
  Series& series = series_[index];
  while (!series.decided()) {
    const auto found = waiting_.find({index, series.taken()});
    if (found == waiting_.end()) return;
    series.take(found->second);
    waiting_.erase(found);
  }
}

void Schedule::give_back(JobId id) {
  returned_.push_back(id);
}

bool Schedule::finished() const {
  return std::all_of(series_.begin(), series_.end(), [](const Series& s) { return s.decided(); });
}

std::uint64_t Schedule::games_taken() const {
  std::uint64_t sum = 0;
  for (const Series& series : series_) sum += series.taken();
  return sum;
}

std::uint64_t Schedule::games_at_most() const {
  std::uint64_t sum = 0;
  for (const Series& s : series_) sum += s.decided() ? s.taken() : s.desc().max_games;
  return sum;
}

}  // namespace match
