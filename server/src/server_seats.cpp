// Clients joining and leaving, and the assignment of rods.
#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "server/match_record.h"
#include "server_impl.h"

namespace server {
namespace {

using wire::make_sentence;
using wire::SentenceId;

// "rods 1 and 2 for Ann; rods 3 for Bob"
std::string rods_by_name(RodSet rods, const auto& names) {
  std::string text;
  while (rods != 0) {
    const auto& name = names[std::countr_zero(rods)];
    RodSet same = 0;
    for (int rod = 0; rod < foosball::kRods; ++rod)
      if ((rods >> rod & 1) != 0 && names[rod] == name) same |= RodSet(1u << rod);
    rods &= static_cast<RodSet>(~same);
    if (!text.empty()) text += "; ";
    const std::string who =
        name[0] != 0 ? name.data() : make_sentence<SentenceId::a_player>().text();
    text += make_sentence<SentenceId::rods_for>(to_text(same), who).text();
  }
  return text;
}

}  // namespace

void Server::Impl::admit(ControlEvent& event) {
  clients.push_back({event.client, event.team, event.rods, event.name, {}});
  ++clients_ever;
  desk.seat(event.client, event.rods, tick_us);
  listen_to(event);
}

void Server::Impl::change_rods(ControlEvent& event) {
  const auto client = std::ranges::find(clients, event.client, &Client::id);
  if (client == clients.end()) return;
  const std::uint8_t before = client->team;
  remember_name(event.client);
  client->name = event.name;
  client->team = event.team;
  client->rods = event.rods;
  RemoteSource* source = desk.change(event.client, event.rods, tick_us);
  if (!input.redirect(event.client, source) && source != nullptr && event.socket)
    input.add({event.client, event.token, event.input_key}, std::move(event.socket), *source);
  if (event.team == wire::kWatchOnly && before != event.team && !options.replay &&
      pause_is_abandoned()) {
    pause_outlasts_wait = false;
    next.commands.push_back(to_record({foosball::Command::Kind::pause, 0, 0}));
  }
}

void Server::Impl::change_name(const ControlEvent& event) {
  const auto client = std::ranges::find(clients, event.client, &Client::id);
  if (client == clients.end()) return;
  if (event.rods == 0) client->name = event.name;
  for (int rod = 0; rod < foosball::kRods; ++rod)
    if ((event.rods >> rod & 1) != 0) client->players[rod] = event.name;
}

void Server::Impl::take_back(ControlEvent& event) {
  input.remove(event.client);
  broadcaster.remove(event.client);
  if (RemoteSource* source = desk.remote(event.client)) source->resume();
  desk.back(event.client);
  listen_to(event);
}

void Server::Impl::dismiss(std::uint32_t client, bool put_out) {
  const auto leaver =
      std::find_if(clients.begin(), clients.end(), [&](const Client& c) { return c.id == client; });
  if (leaver == clients.end()) return;
  const bool played = leaver->team < foosball::kTeams;
  remember_name(client);
  if (put_out) lineup.excuse(leaver->name.data());
  for (int rod = 0; put_out && rod < foosball::kRods; ++rod) lineup.excuse(leaver->at(rod).data());
  clients.erase(leaver);
  desk.leave(client, tick_us);
  input.remove(client);
  broadcaster.remove(client);
  if (!options.replay && (played || clients.empty()) && pause_is_abandoned()) {
    pause_outlasts_wait = false;
    next.commands.push_back(to_record({foosball::Command::Kind::pause, 0, 0}));
  }
}

void Server::Impl::remember_name(std::uint32_t client) {
  const auto who = std::ranges::find(clients, client, &Client::id);
  if (who == clients.end()) return;
  for (int rod = 0; rod < foosball::kRods; ++rod)
    if ((who->rods >> rod & 1) != 0) had_rod[rod] = who->at(rod);
}

// If a player of a team is absent, the match goes on. Notifies all of the stand-ins.
void Server::Impl::watch_absences() {
  const foosball::MatchView& view = match.view();
  const bool in_match = view.screen != foosball::Screen::logo &&
                        view.screen != foosball::Screen::end && !view.attract &&
                        view.mode != foosball::Mode::training;
  const bool in_play = in_match && view.screen == foosball::Screen::play && !view.paused &&
                       view.time_out_seconds <= 0.0;
  const bool changed = desk.watch_absences(in_match, in_play, tick_us);
  wait_for_players(in_match);
  if (!changed) return;
  for (int rod = 0; rod < foosball::kRods; ++rod) {  // players at a cabinet have no name
    if ((desk.stand_ins() >> rod & 1) != 0 && desk.of_device(rod)) had_rod[rod] = {};
  }
  for (const Client& client : clients) {
    if ((client.rods & desk.stand_ins()) != 0) remember_name(client.id);
  }
  const auto report = [&](Topic topic, bool& reported, const wire::Sentence& text,
                          const char* over) {
    if (!text.empty() || reported) notify(topic, text, over);
    reported = !text.empty();
  };
  const RodSet plays = desk.stand_ins(), offered = desk.offered();
  wire::Sentence stand_in, offer;
  if (plays != 0)
    stand_in = make_sentence<SentenceId::computer_plays>(rods_by_name(plays, had_rod));
  if (offered != 0)
    offer = make_sentence<SentenceId::rods_offered>(RodDesk::kOfferUs / 1'000'000,
                                                    rods_by_name(offered, had_rod));
  report(Topic::stand_in, stand_ins_reported, stand_in, "the computer replaces nobody any more");
  report(Topic::offer, offer_reported, offer, "no rods are offered any more");
}

// Pauses a match while none of its players is heard, so that a network outage of the only player
// costs no goals. The rule for idle matches still ends it.
void Server::Impl::wait_for_players(bool in_match) {
  const foosball::MatchView& view = match.view();
  const bool play = in_match && view.screen == foosball::Screen::play;
  const bool waits = play && desk.all_silent();
  if (waits == waiting || (waits && view.paused)) return;
  waiting = waits;
  notify(Topic::waiting, waits ? make_sentence<SentenceId::waits_for_players>() : wire::Sentence(),
         "the match continues, or is over");
  if (play && !std::exchange(pause_outlasts_wait, false))
    next.commands.push_back(
        to_record({foosball::Command::Kind::pause, 0, static_cast<std::uint8_t>(waits)}));
}

bool Server::Impl::plays(std::uint32_t client) const {
  return std::any_of(clients.begin(), clients.end(), [client](const Client& c) {
    return c.id == client && c.team < foosball::kTeams;
  });
}

// A pause by players ends when the last player leaves; a pause by a watching host, when the last
// client leaves.
bool Server::Impl::pause_is_abandoned() const {
  if (clients.empty()) return true;
  return !paused_by_watcher && std::none_of(clients.begin(), clients.end(), [](const Client& c) {
    return c.team < foosball::kTeams;
  });
}

// Tells the match which teams computers play, so that it knows whose absence counts, and when a
// hand ends a demonstration match.
void Server::Impl::add_commands() {
  const foosball::MatchView& view = match.view();
  if (view.attract) {
    if (desk.hand_moved()) next.commands.push_back(to_record({foosball::Command::Kind::touch}));
    return;
  }
  for (int team = 0; team < foosball::kTeams; ++team) {
    const auto rods = foosball::rods_of_team(foosball::table_spec(view.layout), team);
    const bool computer =
        std::ranges::all_of(rods, [&](int rod) { return desk.driver(rod) == RodDriver::computer; });
    if (computer == view.computer[team]) continue;
    next.commands.push_back(
        to_record({foosball::Command::Kind::seat, static_cast<std::uint8_t>(team),
                   static_cast<std::uint8_t>(computer)}));
  }
}

}  // namespace server
