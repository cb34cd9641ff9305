#include "lineup.h"

#include <algorithm>

namespace server {

void Lineup::begin() {
  rows_ = {};
  ticks_ = 0;
}

void Lineup::add(int team, Kind kind, std::string_view name) {
  name = name.substr(0, wire::kMaxName);
  auto& rows = rows_[static_cast<std::size_t>(team)];
  auto row = std::ranges::find_if(
      rows, [&](const Row& r) { return r.ticks > 0 && r.kind == kind && name == r.name.data(); });
  if (row == rows.end()) {
    row = std::ranges::min_element(rows, {}, &Row::ticks);
    *row = {.kind = kind};
    name.copy(row->name.data(), name.size());
  }
  if (row->last == ticks_) return;
  row->last = ticks_;
  ++row->ticks;
}

std::vector<results::Player> Lineup::players(int team) const {
  std::vector<Row> rows;
  for (const Row& row : rows_[static_cast<std::size_t>(team)]) {
    if (static_cast<double>(row.ticks) >= kLeastShare * static_cast<double>(ticks_) &&
        row.ticks > 0)
      rows.push_back(row);
  }
  std::ranges::stable_sort(rows, std::greater(), &Row::ticks);
  if (rows.size() > results::kMaxPlayersOfTeam) rows.resize(results::kMaxPlayersOfTeam);
  std::vector<results::Player> players;
  for (const Row& row : rows) {
    const std::string name = row.name[0] != 0 ? row.name.data() : "person";
    players.push_back({name, row.kind == Kind::person ? "person" : "computer",
                       static_cast<double>(row.ticks) / static_cast<double>(ticks_)});
  }
  return players;
}

}  // namespace server
