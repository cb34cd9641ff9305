#include "client/seats_menu.h"

#include <algorithm>

#include "wire/enums.h"
#include "wire/limits.h"

#define N_(english) english  // for xgettext: render/translate.h

namespace client {
namespace {

enum Row : int {
  row_join = foosball::kRods,
  row_watch,
  row_pause,
  row_time_out,
  row_restart,
  first_vote
};

constexpr int kNobody = -2;
constexpr std::array<const char*, foosball::kTeams> kTeams{"● ORION", "▲ VEGA"};
constexpr std::array<const char*, 4> kLines{N_("Goalie"), N_("Defence"), N_("Midfield"),
                                            N_("Attack")};

struct DeviceName {
  const char* name;
  int number = 0;
};
constexpr std::array<DeviceName, kDevices> kDeviceNames{{{N_("mouse"), 0},
                                                         {N_("arrow keys"), 0},
                                                         {N_("WASD keys"), 0},
                                                         {N_("gamepad"), 1},
                                                         {N_("gamepad"), 2},
                                                         {N_("gamepad"), 3},
                                                         {N_("gamepad"), 4}}};

const foosball::TableSpec& table_of(const SeatsView& view) {
  return foosball::table_spec(static_cast<foosball::Layout>(view.scene.layout));
}

const wire::Seat* other_at(const SeatsView& view, int rod) {
  for (const wire::Seat& seat : view.roster.seats) {
    if (seat.client != view.client && (seat.rods >> rod & 1) != 0) return &seat;
  }
  return nullptr;
}

std::uint8_t taken_by_others(const SeatsView& view) {
  std::uint8_t rods = 0;
  for (const wire::Seat& seat : view.roster.seats) {
    if (seat.client != view.client) rods |= seat.rods;
  }
  return rods;
}

std::uint8_t rods_of(const foosball::TableSpec& table, int team) {
  std::uint8_t rods = 0;
  for (const int rod : foosball::rods_of_team(table, team))
    rods |= static_cast<std::uint8_t>(1u << rod);
  return rods;
}

// A vote's topic identifies its subject: wire/limits.h.
std::vector<wire::Notice> votes_of(const SeatsView& view) {
  std::vector<wire::Notice> votes;
  for (const wire::Notice& notice : view.notices) {
    if (wire::is_vote_topic(notice.topic)) votes.push_back(notice);
  }
  return votes;
}

MenuRow rod_row(const SeatsView& view, const Crew& crew, int rod) {
  const foosball::RodSpec& spec = table_of(view).rods[static_cast<std::size_t>(rod)];
  MenuRow row{
      .label = kLines[static_cast<std::size_t>(spec.line)],
      .value = "",
      .prefix = std::to_string(rod + 1) + "  " + kTeams[static_cast<std::size_t>(spec.team)]};
  if (const wire::Seat* seat = other_at(view, rod)) {
    const std::string& player = view.roster.players[static_cast<std::size_t>(rod)];
    row.value = (player.empty() ? seat->name : player) + (seat->away ? " ..." : "");
    row.translate_value = false;
    row.fixed = true;
  } else if ((crew.granted() >> rod & 1) != 0) {
    const int device = crew.player_of(rod);
    const bool first = device == Crew::kFirstPerson;
    const DeviceName name =
        first ? DeviceName{N_("you"), 0} : kDeviceNames[static_cast<std::size_t>(device)];
    row.value = name.name;
    row.value_number = name.number;
  } else {
    const auto source = view.scene.rods[static_cast<std::size_t>(rod)].source;
    row.value = source == number(wire::RodSource::computer)  ? N_("computer")
                : source == number(wire::RodSource::cabinet) ? N_("cabinet")
                                                             : N_("free");
  }
  return row;
}

std::string rods_text(std::uint8_t rods) {
  std::string text;
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    if ((rods >> rod & 1) != 0) text += (text.empty() ? "" : ", ") + std::to_string(rod + 1);
  }
  return text;
}

// Players other than hosts may be removed: by the host, or by a vote of the players. This includes
// a player who has given up the rods during the vote.
bool may_kick(const SeatsView& view, const Crew& crew, const wire::Seat& seat) {
  const bool entitled = view.role == number(wire::Role::host) || crew.plays();
  const bool voted_on = std::ranges::any_of(view.notices, [&](const wire::Notice& notice) {
    return notice.topic == wire::kKickTopics + seat.client;
  });
  return entitled && seat.client != view.client && (seat.rods != 0 || voted_on) &&
         seat.role != number(wire::Role::host);
}

// All players at that client: "Ann, Ben".
std::string people_of(const wire::Seat& seat, const wire::RodPlayers& players) {
  std::vector<std::string> people{seat.name.empty() ? "?" : seat.name};
  for (std::size_t rod = 0; rod < players.size(); ++rod) {
    const bool other = (seat.rods >> rod & 1) != 0 && !players[rod].empty();
    if (other && std::ranges::count(people, players[rod]) == 0) people.push_back(players[rod]);
  }
  std::string text;
  for (const std::string& name : people) text.append(text.empty() ? "" : ", ").append(name);
  return text;
}

MenuRow person_row(const wire::Seat& seat, const wire::RodPlayers& players, bool self, bool fixed) {
  MenuRow row{.label = people_of(seat, players),
              .value = seat.away        ? N_("away")
                       : seat.rods == 0 ? N_("watches")
                                        : rods_text(seat.rods),
              .translate_value = seat.away || seat.rods == 0,
              .prefix = self ? "→" : "",
              .translate_label = false,
              .fixed = fixed};
  if (seat.role == number(wire::Role::host)) row.label += " ◆";
  return row;
}

std::vector<int> devices_for(const SeatsView& view, const Crew& crew, int team) {
  std::vector<int> devices{kNobody};
  const std::uint8_t own = crew.granted() & rods_of(table_of(view), crew.team());
  if (team == crew.team() || own == 0) devices.push_back(Crew::kFirstPerson);
  for (int device = 0; device < kDevices; ++device) {
    const bool pad = device >= static_cast<int>(Device::pad_1);
    if (!pad || (view.pads >> device & 1) != 0) devices.push_back(device);
  }
  return devices;
}

}  // namespace

int SeatsMenu::rows(const SeatsView& view) const {
  return first_vote + static_cast<int>(votes_of(view).size() + view.roster.seats.size());
}

MenuPage SeatsMenu::page(const SeatsView& view, const Crew& crew, int chosen) const {
  MenuPage page;
  page.title = N_("Seats");
  page.chosen = chosen;
  for (int rod = 0; rod < foosball::kRods; ++rod) page.rows.push_back(rod_row(view, crew, rod));
  const auto team = static_cast<std::size_t>(crew.team());
  const bool plays = crew.plays(), host = view.role == number(wire::Role::host);
  const bool in_play = view.scene.screen == number(wire::Screen::play);
  page.rows.push_back({.label = N_("Take all free rods of a team"),
                       .value = plays ? kTeams[team] : "-",
                       .translate_value = false});
  page.rows.push_back({.label = N_("Give up all rods and watch"), .value = "", .fixed = !plays});
  page.rows.push_back({.label = view.scene.paused ? N_("Play on") : N_("Pause"),
                       .value = host ? "" : N_("by vote"),
                       .fixed = !in_play || (!plays && !host)});
  page.rows.push_back({.label = N_("Time-out"),
                       .value = std::to_string(view.scene.time_outs_left[team]),
                       .translate_value = false,
                       .fixed = !in_play || !plays || view.scene.time_outs_left[team] == 0});
  page.rows.push_back({.label = N_("Back to the start"),
                       .value = host ? "" : N_("by vote"),
                       .fixed = !plays && !host});
  for (const wire::Notice& vote : votes_of(view)) {
    const auto kind = wire::vote_of(vote.topic);
    page.rows.push_back({.label = N_("Agree to the vote"),
                         .value = kind.kind == wire::RequestKind::restart ? N_("Back to the start")
                                  : kind.value != 0                       ? N_("Pause")
                                                                          : N_("Play on")});
  }
  for (const wire::Seat& seat : view.roster.seats)
    page.rows.push_back(person_row(seat, view.roster.players, seat.client == view.client,
                                   !may_kick(view, crew, seat)));
  const auto votes = votes_of(view);
  const int vote = chosen - first_vote;
  if (vote >= 0 && vote < static_cast<int>(votes.size()))
    page.detail = votes[static_cast<std::size_t>(vote)].text;
  if (chosen >= 0 && chosen < foosball::kRods) {
    page.note =
        other_at(view, chosen) != nullptr
            ? N_("Another client plays this rod: it becomes free when that client gives it up.")
            : N_("Left and right give the rod to all devices, the mouse, keys, a gamepad, "
                 "or nobody.");
  } else if (const wire::Seat* person = person_at(view, chosen);
             person != nullptr && may_kick(view, crew, *person)) {
    page.note = armed_ == person->client
                    ? N_("Press again to remove this player from the match.")
                    : N_("Enter removes this player from the match: if the host decides it, or by "
                         "a vote of more than half of the other players, at least two.");
    for (const wire::Notice& notice : view.notices)
      if (notice.topic == wire::kKickTopics + person->client) page.detail = notice.text;
  } else if (chosen == row_restart || chosen == row_pause) {
    page.note = N_("The host decides; otherwise more than half of the players.");
  }
  return page;
}

// null: the row belongs to nobody.
const wire::Seat* SeatsMenu::person_at(const SeatsView& view, int row) const {
  const int index = row - first_vote - static_cast<int>(votes_of(view).size());
  const auto& seats = view.roster.seats;
  return index >= 0 && index < static_cast<int>(seats.size())
             ? &seats[static_cast<std::size_t>(index)]
             : nullptr;
}

std::optional<wire::Claim> SeatsMenu::claim_of(std::uint8_t rods, int team,
                                               const Crew& crew) const {
  if (rods == crew.granted()) return std::nullopt;
  return wire::Claim{rods, static_cast<std::uint8_t>(team)};
}

std::optional<wire::Claim> SeatsMenu::change_rod(const SeatsView& view, int rod, int way,
                                                 Crew& crew) {
  if (other_at(view, rod) != nullptr) return std::nullopt;
  const foosball::TableSpec& table = table_of(view);
  const int team = table.rods[static_cast<std::size_t>(rod)].team;
  const std::uint8_t bit = static_cast<std::uint8_t>(1u << rod), granted = crew.granted();
  const std::vector<int> devices = devices_for(view, crew, team);
  const int now = (granted & bit) != 0 ? crew.player_of(rod) : kNobody;
  const auto at = std::ranges::find(devices, now);
  const auto count = static_cast<int>(devices.size());
  const int place = at != devices.end() ? static_cast<int>(at - devices.begin()) : 0;
  const int next = devices[static_cast<std::size_t>(((place + way) % count + count) % count)];
  crew.give(rod, next == kNobody ? Crew::kFirstPerson : next);
  const auto rods = static_cast<std::uint8_t>(next == kNobody ? granted & ~bit : granted | bit);
  const bool keeps = (rods & rods_of(table, crew.team())) != 0;
  return claim_of(rods, keeps ? crew.team() : team, crew);
}

SeatsAsked SeatsMenu::step(const SeatsView& view, int row, const MenuSteps& steps, Crew& crew) {
  SeatsAsked asked;
  const wire::Seat* person = person_at(view, row);
  if (person == nullptr || person->client != armed_) armed_ = 0;
  const int way = steps.right != 0 ? steps.right : steps.confirm ? 1 : 0;
  if (way == 0) return asked;
  const auto team = static_cast<std::uint8_t>(crew.team());
  const auto request = [&](wire::RequestKind kind, int value) {
    asked.requests.push_back({number(kind), team, static_cast<std::uint8_t>(value)});
  };
  if (row < foosball::kRods) {
    asked.claim = change_rod(view, row, way, crew);
  } else if (row == row_join) {
    const int other = crew.plays() ? 1 - crew.team() : crew.team();
    const std::uint8_t rods = rods_of(table_of(view), other) & ~taken_by_others(view);
    if (rods != 0) asked.claim = claim_of(rods, other, crew);
  }
  if (!steps.confirm) return asked;
  const auto votes = votes_of(view);
  const int vote = row - first_vote;
  if (row == row_watch) {
    asked.claim = claim_of(0, crew.team(), crew);
  } else if (row == row_pause) {
    request(wire::RequestKind::pause, view.scene.paused ? 0 : 1);
  } else if (row == row_time_out) {
    request(wire::RequestKind::time_out, 0);
  } else if (row == row_restart) {
    request(wire::RequestKind::restart, 0);
  } else if (vote >= 0 && vote < static_cast<int>(votes.size())) {
    const auto [kind, value] = wire::vote_of(votes[static_cast<std::size_t>(vote)].topic);
    request(kind, value);
  } else if (person != nullptr && may_kick(view, crew, *person)) {
    if (armed_ == person->client) asked.kick = wire::Kick{person->client};
    armed_ = armed_ == 0 ? person->client : 0;
  }
  return asked;
}

std::array<RodName, 8> names_at_rods(const SeatsView& view, const Crew& crew) {
  std::array<RodName, 8> names;
  const bool others = taken_by_others(view) != 0;
  if (crew.people() <= 1 && !others) return names;
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const bool mine = (crew.granted() >> rod & 1) != 0;
    if (!mine && other_at(view, rod) == nullptr) continue;
    const auto r = static_cast<std::size_t>(rod);
    MenuRow row = rod_row(view, crew, rod);
    names[r] = {row.value, row.translate_value, row.value_number};
    if (mine && !view.own_names[r].empty()) names[r] = {view.own_names[r], false, 0};
  }
  return names;
}

}  // namespace client
