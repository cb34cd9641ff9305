#include "lineup.h"

#include <algorithm>

#include "results/rating.h"

namespace server {

void Lineup::begin() {
  rows_ = {};
  ticks_ = 0;
}

Lineup::Row* Lineup::find(int team, Kind kind, std::string_view name) {
  auto& rows = rows_[static_cast<std::size_t>(team)];
  const auto row = std::ranges::find_if(
      rows, [&](const Row& r) { return r.ticks > 0 && r.kind == kind && name == r.name.data(); });
  return row != rows.end() ? &*row : nullptr;
}

void Lineup::add(int team, Kind kind, std::string_view name) {
  name = name.substr(0, wire::kMaxName);
  Row* row = find(team, kind, name);
  if (row == nullptr) {
    row = &*std::ranges::min_element(rows_[static_cast<std::size_t>(team)], {}, &Row::ticks);
    *row = {.kind = kind, .first = ticks_};
    name.copy(row->name.data(), name.size());
  }
  row->seated = ticks_;
  if (row->last == ticks_) return;
  row->last = ticks_;
  ++row->ticks;
}

void Lineup::keep_seat(int team, std::string_view name) {
  if (Row* row = find(team, Kind::person, name.substr(0, wire::kMaxName))) row->seated = ticks_;
}

void Lineup::excuse(std::string_view name) {
  for (int team = 0; team < foosball::kTeams; ++team)
    if (Row* row = find(team, Kind::person, name.substr(0, wire::kMaxName))) row->excused = true;
}

// Without a seat at the end, or absent for too long in total since the player joined.
bool Lineup::has_left(const Row& row, std::uint64_t return_ticks) const {
  if (row.kind != Kind::person || row.excused) return false;
  const auto away = static_cast<double>(ticks_ + 1 - row.first - row.ticks);
  const double max = std::max(static_cast<double>(return_ticks),
                              results::kLargestAbsence * static_cast<double>(ticks_));
  return row.seated != ticks_ || away > max;
}

std::vector<results::Player> Lineup::players(int team, std::uint64_t return_ticks) const {
  std::vector<Row> rows;
  for (const Row& row : rows_[static_cast<std::size_t>(team)]) {
    if (static_cast<double>(row.ticks) >= kMinShare * static_cast<double>(ticks_) && row.ticks > 0)
      rows.push_back(row);
  }
  std::ranges::stable_sort(rows, std::greater(), &Row::ticks);
  if (rows.size() > results::kMaxPlayersOfTeam) rows.resize(results::kMaxPlayersOfTeam);
  std::vector<results::Player> players;
  for (const Row& row : rows) {
    const std::string name = row.name[0] != 0 ? row.name.data() : "person";
    players.push_back({name, row.kind == Kind::computer ? "computer" : "person",
                       static_cast<double>(row.ticks) / static_cast<double>(ticks_),
                       has_left(row, return_ticks)});
  }
  return players;
}

}  // namespace server
