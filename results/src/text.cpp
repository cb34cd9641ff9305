#include "results/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "csv.h"

namespace results {
namespace {

std::string names(const Team& team, const char* between) {
  std::string text;
  for (const Player& player : team.players) text += (text.empty() ? "" : between) + player.name;
  return text;
}

// "Ann (62%), computer 2 (38%), Bob (20%, left)". A player of the complete match has no percentage.
std::string names_and_shares(const Team& team) {
  std::string text;
  for (const Player& player : team.players) {
    if (!text.empty()) text += ", ";
    text += player.name;
    const auto percent = std::lround(100.0 * player.share);
    if (percent < 100 || player.left)
      text += fmt::format(" ({}%{})", percent, player.left ? ", left" : "");
  }
  return text;
}

std::string shares(const Team& team) {
  std::string text;
  for (const Player& player : team.players) {
    if (!text.empty()) text += "; ";
    text += fmt::format("{:.3g}", player.share);
  }
  return text;
}

std::string leavers(const Team& team) {
  Team left;
  std::ranges::copy_if(team.players, std::back_inserter(left.players), &Player::left);
  return names(left, "; ");
}

// Players choose the names: control characters must not reach a terminal.
std::string shown(std::string text, std::size_t width) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return (c >= 0 && c < 0x20) || c == 0x7f; }, '?');
  if (text.size() <= width) return text;
  std::size_t cut = width - 1;
  while (cut > 0 && (text[cut] & 0xc0) == 0x80) --cut;  // does not split a multi-byte character
  return text.substr(0, cut) + "~";
}

std::string duration(double seconds) {
  const auto whole = std::llround(seconds);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

template <class T>
std::string optional_number(const std::optional<T>& value) {
  return value ? fmt::format("{:.6g}", *value) : std::string();
}

nlohmann::ordered_json json_of(const Team& team) {
  nlohmann::ordered_json out;
  out["players"] = nlohmann::ordered_json::array();
  for (const Player& player : team.players) {
    out["players"].push_back({{"name", player.name},
                              {"kind", player.kind},
                              {"share", player.share},
                              {"left", player.left}});
  }
  out["goals"] = team.goals;
  if (const auto& s = team.statistics) {
    out["shots"] = s->shots;
    out["shots_on_target"] = s->shots_on_target;
    out["saves"] = s->saves;
    out["passes"] = s->passes;
    out["touches"] = s->touches;
    out["own_goals"] = s->own_goals;
    out["possession_s"] = s->possession_seconds;
    if (s->fastest_shot) out["fastest_shot"] = *s->fastest_shot;
  }
  return out;
}

// Writes replacement characters for invalid UTF-8 in names.
std::string dump(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string matches_table(std::span<const MatchResult> matches) {
  std::string text = fmt::format("{:>5}  {:<20}  {:<24} {:>7} {:<24}  {:>6}  {}\n", "match",
                                 "finished", "team 0", "score", "team 1", "length", "recording");
  for (const MatchResult& m : matches) {
    text += fmt::format("{:>5}  {:<20}  {:<24} {:>3}:{:<3} {:<24}  {:>6}  {}\n", m.id,
                        shown(m.finished_at, 20), shown(names_and_shares(m.teams[0]), 24),
                        m.teams[0].goals, m.teams[1].goals, shown(names_and_shares(m.teams[1]), 24),
                        duration(m.play_seconds), shown(m.recording, kMaxText));
  }
  return text;
}

std::string matches_csv(std::span<const MatchResult> matches) {
  std::string text =
      "match,finished_at,layout,goals_to_win,max_goals,seed,play_s,shot_speed_median,"
      "shot_speed_fastest,recording";
  for (int t = 0; t < kTeams; ++t) {
    for (const char* column :
         {"players", "goals", "shots", "shots_on_target", "saves", "passes", "touches", "own_goals",
          "possession_s", "shares", "left", "fastest_shot"}) {
      text += fmt::format(",team{}_{}", t, column);
    }
  }
  text += "\r\n";
  for (const MatchResult& m : matches) {
    const auto& speeds = m.shot_speeds;
    text += fmt::format("{},{},{},{},{},{},{:.6g},{},{},{}", m.id, csv_cell(m.finished_at),
                        csv_cell(m.layout), m.goals_to_win, m.max_goals, m.seed, m.play_seconds,
                        optional_number(speeds ? std::optional(speeds->median) : std::nullopt),
                        optional_number(speeds ? std::optional(speeds->fastest) : std::nullopt),
                        csv_cell(m.recording));
    for (const Team& team : m.teams) {
      text += fmt::format(",{},{}", csv_cell(names(team, "; ")), team.goals);
      if (const auto& s = team.statistics) {
        text += fmt::format(",{},{},{},{},{},{},{:.6g}", s->shots, s->shots_on_target, s->saves,
                            s->passes, s->touches, s->own_goals, s->possession_seconds);
      } else {
        text += ",,,,,,,";
      }
      text += ',';
      text += csv_cell(shares(team));
      text += ',';
      text += csv_cell(leavers(team));
      text += ',';
      if (team.statistics) text += optional_number(team.statistics->fastest_shot);
    }
    text += "\r\n";
  }
  return text;
}

std::string matches_json(std::span<const MatchResult> matches) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const MatchResult& m : matches) {
    nlohmann::ordered_json out;
    out["match"] = m.id;
    out["finished_at"] = m.finished_at;
    out["layout"] = m.layout;
    out["goals_to_win"] = m.goals_to_win;
    out["max_goals"] = m.max_goals;
    out["seed"] = std::to_string(m.seed);  // may exceed 2^53, the limit of some JSON readers
    out["play_s"] = m.play_seconds;
    if (m.shot_speeds) {
      out["shot_speed_median"] = m.shot_speeds->median;
      out["shot_speed_fastest"] = m.shot_speeds->fastest;
    }
    if (!m.recording.empty()) out["recording"] = m.recording;
    out["teams"] = {json_of(m.teams[0]), json_of(m.teams[1])};
    all.push_back(std::move(out));
  }
  return dump(all);
}

std::string standings_table(std::span<const Standing> standings) {
  std::string text = fmt::format(
      "{:>4}  {:<24} {:>6} {:>7} {:>5} {:>6} {:>9}  {:>12} {:>6} {:>11}\n", "", "player", "rating",
      "matches", "wins", "losses", "goals", "fastest m/s", "saved", "not counted");
  int place = 0;
  for (const Standing& s : standings) {
    const auto saved = s.saved();
    text += fmt::format(
        "{:>4}  {:<24} {:>6.0f} {:>7} {:>5} {:>6} {:>4}:{:<4}  {:>12} {:>6} {:>11}\n", ++place,
        shown(s.name, 24), s.rating, s.matches, s.wins, s.losses, s.goals_for, s.goals_against,
        s.fastest_shot > 0.0 ? fmt::format("{:.1f}", s.fastest_shot) : "",
        saved ? fmt::format("{:.0f}%", 100.0 * *saved) : "",
        s.not_counted > 0 ? std::to_string(s.not_counted) : "");
  }
  return text;
}

std::string standings_csv(std::span<const Standing> standings) {
  std::string text =
      "player,kind,rating,matches,wins,losses,goals_for,goals_against,fastest_shot,not_counted,"
      "shots_faced,saves\r\n";
  for (const Standing& s : standings) {
    text += fmt::format("{},{},{:.2f},{},{},{},{},{},{:.6g},{},{},{}\r\n", csv_cell(s.name),
                        csv_cell(s.kind), s.rating, s.matches, s.wins, s.losses, s.goals_for,
                        s.goals_against, s.fastest_shot, s.not_counted, s.shots_faced, s.saves);
  }
  return text;
}

std::string standings_json(std::span<const Standing> standings) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Standing& s : standings) {
    all.push_back({{"player", s.name},
                   {"kind", s.kind},
                   {"rating", s.rating},
                   {"matches", s.matches},
                   {"wins", s.wins},
                   {"losses", s.losses},
                   {"goals_for", s.goals_for},
                   {"goals_against", s.goals_against},
                   {"fastest_shot", s.fastest_shot},
                   {"not_counted", s.not_counted},
                   {"shots_faced", s.shots_faced},
                   {"saves", s.saves}});
  }
  return dump(all);
}

}  // namespace results
