#include "rod_desk.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "server/game_choice.h"

namespace server {
namespace {

std::array<double, cabinet::kRods> slide_limits(const foosball::TableSpec& table) {
  std::array<double, cabinet::kRods> limits{};
  for (int rod = 0; rod < foosball::kRods; ++rod) limits[rod] = table.rods[rod].slide_limit;
  return limits;
}

// The seeds of the two computers differ from each other and from the match's.
std::uint64_t computer_seed(std::uint64_t match_seed, int team) {
  return match_seed * 0x9E3779B97F4A7C15u + 1 + static_cast<std::uint64_t>(team);
}

}  // namespace

RodDesk::RodDesk(const foosball::MatchDesc& match,
                 const std::array<bool, foosball::kTeams>& computer, bool computer_fills,
                 const foosball::PlayerSpec& computer_player, const foosball::MatchView& view)
    : table_(foosball::table_spec(match.layout)),
      computer_fills_(computer_fills),
      player_(computer_player),
      chosen_(computer_player),
      seated_(player_in(match.mode, 0, match.seed, computer_player)),
      computer_allowed_(computer),
      seed_(match.seed),
      match_seed_(match.seed),
      mux_(slide_limits(table_)) {
  hand_watch_.resize(places_.size());
  for (Place& place : places_) {
    place.remote = std::make_unique<RemoteSource>("client");
    place.index = add(*place.remote, cabinet::Origin::absolute, RodDriver::client);
  }
  for (int team = 0; team < foosball::kTeams; ++team) {
    computers_[team] = std::make_unique<ComputerSource>(computer_desc(team), view);
    computer_index_[team] = add(*computers_[team], cabinet::Origin::absolute, RodDriver::computer);
  }
  assign_all();
}

foosball::ComputerPlayerDesc RodDesk::computer_desc(int team) const {
  foosball::ComputerPlayerDesc desc;
  desc.team = team;
  desc.seed = computer_seed(seed_, team);
  desc.opens_match = computer_allowed_[0] && computer_allowed_[1];
  desc.player = seated_;
  return desc;
}

void RodDesk::follow(const foosball::MatchView& view) {
  using foosball::Screen;
  const bool under_way =
      !view.attract && view.screen != Screen::logo && view.screen != Screen::selection;
  if (!under_way) player_ = chosen_;
  const bool challenge = view.mode == foosball::Mode::challenge;
  const bool begins = under_way && !under_way_;
  under_way_ = under_way;
  const auto player = player_in(view.mode, view.rung, view.challenge, player_);
  if (player == seated_ && !(challenge && begins)) return;
  seated_ = player;
  seed_ = challenge ? view.challenge : match_seed_;
  for (int team = 0; team < foosball::kTeams; ++team) {
    computers_[team]->replace(computer_desc(team));
  }
}

// Hand-driven sources: first the clients, then the devices.
const cabinet::RodInput& RodDesk::hand(std::size_t source, int rod) const {
  if (source < places_.size()) return places_[source].remote->rods()[rod];
  return devices_[source - places_.size()]->rods()[rod];
}

void RodDesk::show_match(bool shown) {
  if (shown == shown_) return;
  shown_ = shown;
  hands_.resize(places_.size() + devices_.size());
  for (std::size_t source = 0; source < hands_.size(); ++source) {
    for (int rod = 0; rod < cabinet::kRods; ++rod) hands_[source][rod] = hand(source, rod);
  }
  assign_all();
}

bool RodDesk::hand_moved() const {
  for (std::size_t source = 0; source < hands_.size(); ++source) {
    for (int rod = 0; rod < cabinet::kRods; ++rod) {
      const cabinet::RodInput& now = hand(source, rod);
      const cabinet::RodInput& then = hands_[source][rod];
      if (now.status != cabinet::RodStatus::live) continue;
      if (then.status != cabinet::RodStatus::live) return true;
      if (std::fabs(now.slide - then.slide) > foosball::kMinHandSlide) return true;
      if (std::fabs(now.angle - then.angle) > foosball::kMinHandTurn) return true;
    }
  }
  return false;
}

int RodDesk::add(cabinet::InputSource& source, cabinet::Origin origin, RodDriver kind) {
  kinds_.push_back(kind);
  return mux_.add(source, origin);
}

void RodDesk::add_device(std::unique_ptr<cabinet::Device> device) {
  order_.insert(order_.end() - 1, add(*device, cabinet::Origin::relative, RodDriver::cabinet));
  devices_.push_back(std::move(device));
  hand_watch_.resize(places_.size() + devices_.size());
  assign_all();
}

RemoteSource* RodDesk::remote(std::uint32_t client) {
  const auto place = std::ranges::find(places_, client, &Place::client);
  return client != 0 && place != places_.end() ? place->remote.get() : nullptr;
}

RemoteSource* RodDesk::seat(std::uint32_t client, std::uint8_t rods, std::int64_t now_us) {
  auto place = std::ranges::find(places_, client, &Place::client);
  if (place == places_.end() && rods != 0) {
    place = std::ranges::find(places_, 0u, &Place::client);
    if (place != places_.end()) place->remote->reset(now_us);
  }
  if (place == places_.end()) return nullptr;
  place->client = rods != 0 ? client : 0;
  if (rods == 0) place->lost = false;
  vacated_ &= static_cast<std::uint8_t>(~rods);
  place->rods = rods;
  place->remote->set_rods(rods);
  // A client that takes or gives up rods is present.
  hand_watch_.restart(static_cast<std::size_t>(place - places_.begin()), now_us, play_us_);
  assign_all();
  return rods != 0 ? place->remote.get() : nullptr;
}

void RodDesk::lost(std::uint32_t client) {
  const auto place = std::ranges::find(places_, client, &Place::client);
  if (client != 0 && place != places_.end()) place->lost = true;
}

void RodDesk::back(std::uint32_t client) {
  const auto place = std::ranges::find(places_, client, &Place::client);
  if (client != 0 && place != places_.end()) place->lost = false;
}

// True if a present team mate could take rods.
bool RodDesk::has_team_mate(std::uint32_t client, std::uint8_t rods, std::int64_t now_us) const {
  std::array<bool, foosball::kTeams> wanted{};
  for (int rod = 0; rod < foosball::kRods; ++rod)
    if ((rods >> rod & 1) != 0) wanted[table_.rods[rod].team] = true;
  return std::ranges::any_of(places_, [&](const Place& place) {
    const auto source = static_cast<std::size_t>(&place - places_.data());
    if (place.client == client || place.rods == 0 || place.lost) return false;
    if (gone(source, place.rods, now_us)) return false;
    for (int rod = 0; rod < foosball::kRods; ++rod)
      if ((place.rods >> rod & 1) != 0 && wanted[table_.rods[rod].team]) return true;
    return false;
  });
}

// Rods that the computer already plays are not offered: the game would stop for the offer.
bool RodDesk::may_be_offered(std::uint32_t client, std::uint8_t rods, std::int64_t now_us) const {
  return (rods & stand_ins_) == 0 && has_team_mate(client, rods, now_us);
}

void RodDesk::vacate(std::uint8_t rods, bool offer, std::int64_t now_us) {
  vacated_ |= rods;
  for (int rod = 0; rod < foosball::kRods; ++rod)
    if ((rods >> rod & 1) != 0) offered_until_us_[rod] = offer ? now_us + kOfferUs : now_us;
}

void RodDesk::leave(std::uint32_t client, std::int64_t now_us) {
  change(client, 0, now_us);
}

// The client's rods of each team of which the new rods contain none.
std::uint8_t RodDesk::given_up(std::uint32_t client, std::uint8_t rods) const {
  const auto place = std::ranges::find(places_, client, &Place::client);
  if (client == 0 || place == places_.end()) return 0;
  std::array<std::uint8_t, foosball::kTeams> had{}, has{};
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const auto bit = static_cast<std::uint8_t>(1u << rod);
    had[table_.rods[rod].team] |= place->rods & bit;
    has[table_.rods[rod].team] |= rods & bit;
  }
  std::uint8_t given_up = 0;
  for (int team = 0; team < foosball::kTeams; ++team)
    if (has[team] == 0) given_up |= had[team];
  return given_up;
}

RemoteSource* RodDesk::change(std::uint32_t client, std::uint8_t rods, std::int64_t now_us) {
  const std::uint8_t vacant = given_up(client, rods);
  const bool offer = may_be_offered(client, vacant, now_us);
  RemoteSource* source = seat(client, rods, now_us);
  vacate(vacant, offer, now_us);
  return source;
}

// The device that has the rod, otherwise the client; consistent with assign_all().
std::size_t RodDesk::owner(int rod) const {
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    if (devices_[i]->rods()[rod].status != cabinet::RodStatus::absent) return places_.size() + i;
  }
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if ((places_[i].rods >> rod & 1) != 0) return i;
  }
  return kNone;
}

bool RodDesk::of_device(int rod) const {
  const std::size_t source = owner(rod);
  return source != kNone && source >= places_.size();
}

bool RodDesk::silent(std::size_t source, std::uint8_t rods, std::int64_t now_us) const {
  const std::int64_t silent_us = source < places_.size()
                                     ? places_[source].remote->silent_us(now_us)
                                     : hand_watch_.undriven_us(source, rods, now_us);
  return silent_us >= kStandInAfterUs;
}

// The hand is silent, or idle for too long.
bool RodDesk::gone(std::size_t source, std::uint8_t rods, std::int64_t now_us) const {
  return silent(source, rods, now_us) || hand_watch_.still_us(source, rods, play_us_) >= kIdleUs;
}

void RodDesk::look_at_hands(bool in_match, bool in_play, std::int64_t now_us) {
  if (in_play && looked_us_ >= 0) play_us_ += now_us - looked_us_;
  looked_us_ = now_us;
  const bool begins = in_match && !in_match_;
  in_match_ = in_match;
  for (std::size_t source = 0; source < places_.size() + devices_.size(); ++source) {
    const cabinet::RodInputs& rods = source < places_.size()
                                         ? places_[source].remote->rods()
                                         : devices_[source - places_.size()]->rods();
    if (begins) hand_watch_.restart(source, now_us, play_us_);
    hand_watch_.look(source, rods, now_us, play_us_);
  }
}

// The rods of one team at one source count as one player: two players may share a cabinet.
std::uint8_t RodDesk::rods_of_gone(bool& somebody, std::int64_t now_us) {
  std::array<std::size_t, foosball::kRods> owners;
  for (int rod = 0; rod < foosball::kRods; ++rod) owners[rod] = owner(rod);
  std::uint8_t all = 0, looked_at = 0;
  all_silent_ = false;
  for (int first = 0; first < foosball::kRods; ++first) {
    if (owners[first] == kNone || (looked_at >> first & 1) != 0) continue;
    std::uint8_t rods = 0;
    for (int rod = first; rod < foosball::kRods; ++rod) {
      const bool same = owners[rod] == owners[first];
      if (same && table_.rods[rod].team == table_.rods[first].team)
        rods |= static_cast<std::uint8_t>(1u << rod);
    }
    all_silent_ = (looked_at == 0 || all_silent_) && silent(owners[first], rods, now_us);
    looked_at |= rods;
    if (gone(owners[first], rods, now_us)) {
      all |= rods;
    } else {
      somebody = true;
    }
  }
  return all;
}

bool RodDesk::watch_absences(bool in_match, bool in_play, std::int64_t now_us) {
  look_at_hands(in_match, in_play, now_us);
  bool somebody = false;
  std::uint8_t stand_ins = rods_of_gone(somebody, now_us), offered = 0;
  if (!in_match) vacated_ = 0;
  // Without any present player there are no stand-ins: the match ends by the rule for idle matches.
  if (!in_match || !somebody) stand_ins = 0;
  for (int rod = 0; somebody && rod < foosball::kRods; ++rod) {
    const auto bit = static_cast<std::uint8_t>(1u << rod);
    if ((vacated_ & bit) == 0 || of_device(rod)) continue;
    (now_us >= offered_until_us_[rod] ? stand_ins : offered) |= bit;
  }
  if (stand_ins == stand_ins_ && offered == offered_) return false;
  offered_ = offered;
  if (std::exchange(stand_ins_, stand_ins) != stand_ins) assign_all();
  return true;
}

void RodDesk::assign_all() {
  std::array<int, foosball::kRods> person;
  person.fill(cabinet::SourceMux::kNobody);
  std::array<bool, foosball::kTeams> has_person{};
  unsigned computed = 0;
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    for (const Place& place : places_) {
      if ((place.rods >> rod & 1) == 0) continue;
      person[rod] = place.index;
      has_person[table_.rods[rod].team] = true;
    }
  }
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const int team = table_.rods[rod].team;
    order_.back() = person[rod];
    const bool unclaimed = person[rod] == cabinet::SourceMux::kNobody;
    if (unclaimed && computer_allowed_[team] && (!has_person[team] || computer_fills_)) {
      order_.back() = computer_index_[team];
      computed |= 1U << rod;
    }
    const bool stands_in = (stand_ins_ >> rod & 1) != 0;
    if (stands_in) computed |= 1U << rod;
    if (shown_ || stands_in) {
      mux_.assign(rod, std::span(&computer_index_[team], 1));
    } else {
      mux_.assign(rod, order_);
    }
  }
  computed_ = shown_ ? foosball::kAllRods : static_cast<std::uint8_t>(computed);
}

// Tells each computer which rods it really has: a device may have some of those assigned to it.
void RodDesk::poll(std::int64_t now_us) {
  unsigned rods = computed_;
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const int source = mux_.source_of(rod);
    const bool device =
        source != cabinet::SourceMux::kNobody && kinds_[source] == RodDriver::cabinet;
    if (device && !shown_ && (stand_ins_ >> rod & 1) == 0) rods &= ~(1U << rod);
  }
  for (const auto& computer : computers_) computer->set_rods(static_cast<std::uint8_t>(rods));
  mux_.poll(now_us);
}

std::uint32_t RodDesk::client_of(int rod) const {
  for (const Place& place : places_)
    if ((place.rods >> rod & 1) != 0) return place.client;
  return 0;
}

RodDriver RodDesk::driver(int rod) const {
  const int source = mux_.source_of(rod);
  return source == cabinet::SourceMux::kNobody ? RodDriver::none : kinds_[source];
}

}  // namespace server
