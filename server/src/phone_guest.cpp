#include "phone_guest.h"

#include <algorithm>

#include "wire/enums.h"
#include "wire/snapshot.h"
#include "wire/text.h"

namespace server {
namespace {

using wire::number;
using wire::RodPair;

constexpr std::array kPairs{RodPair::defence, RodPair::attack};

const wire::Seat* seat_of(const wire::Roster& roster, std::uint32_t client) {
  const auto seat = std::ranges::find(roster.seats, client, &wire::Seat::client);
  return seat != roster.seats.end() ? &*seat : nullptr;
}

wire::PhoneRodPlace place_of(const foosball::RodSpec& rod) {
  return {static_cast<std::uint8_t>(rod.line), static_cast<std::uint8_t>(rod.men),
          static_cast<float>(rod.spacing), static_cast<float>(rod.slide_limit)};
}

bool same(const wire::PhoneState& a, const wire::PhoneState& b) {
  return a.ticket == b.ticket && a.team == b.team && a.pair == b.pair && a.free == b.free &&
         a.name == b.name;
}

}  // namespace

RodPairOf rods_of_pair(foosball::Layout layout, int team, RodPair pair) {
  const auto rods = foosball::rods_of_team(foosball::table_spec(layout), team);
  const std::size_t first = pair == RodPair::defence ? 0 : 2;
  RodPairOf out;
  out.by_x = {std::min(rods[first], rods[first + 1]), std::max(rods[first], rods[first + 1])};
  for (const int rod : out.by_x) out.rods |= static_cast<RodSet>(1u << rod);
  return out;
}

std::optional<std::uint8_t> PhoneGuest::index_of(int rod) const {
  if (state_.pair == number(RodPair::none)) return std::nullopt;
  const auto mine = rods_of_pair(layout_, state_.team, static_cast<RodPair>(state_.pair));
  for (std::uint8_t i = 0; i < wire::kPhoneRods; ++i)
    if (mine.by_x[i] == rod) return i;
  return std::nullopt;
}

PhoneGuest::Outcome PhoneGuest::handle(const wire::PhoneRequest& request) {
  Outcome out;
  const auto* hello = std::get_if<wire::PhoneHello>(&request);
  if ((hello != nullptr) == greeted_) {
    end(wire::make_sentence<wire::SentenceId::out_of_place>().text(), out);
  } else if (hello != nullptr) {
    greet(*hello, out);
  } else if (const auto* asked = std::get_if<wire::PhoneClaim>(&request)) {
    claim(*asked, out);
  } else {
    drive(std::get<wire::PhoneInput>(request), out);
  }
  return out;
}

// Joins as a watcher first: the Roster says which rods are free.
void PhoneGuest::greet(const wire::PhoneHello& hello, Outcome& out) {
  greeted_ = true;
  wire::Hello said;
  said.snapshot_layout = wire::snapshot_layout_hash();
  said.name = hello.name.empty() ? "phone" : hello.name;
  said.session = hello.session;
  said.ticket = hello.ticket;
  out.to_control.emplace_back(said);
}

void PhoneGuest::claim(const wire::PhoneClaim& claim, Outcome& out) {
  if (client_ == 0) return;  // not joined yet: the page requests again
  const auto pair = static_cast<RodPair>(claim.pair);
  if (pair == RodPair::none) {
    out.to_control.emplace_back(wire::Claim{0, wire::kWatchOnly});
  } else {
    out.to_control.emplace_back(
        wire::Claim{rods_of_pair(layout_, claim.team, pair).rods, claim.team});
  }
}

// The phone's counter restarts with each connection, and so does the counter of the inputs passed
// on.
void PhoneGuest::drive(const wire::PhoneInput& input, Outcome& out) {
  const auto pair = static_cast<RodPair>(state_.pair);
  if (client_ == 0 || pair == RodPair::none) return;
  const auto ahead = static_cast<std::int32_t>(input.sequence - phone_sequence_);
  if (driven_ && ahead <= 0) return;
  driven_ = true;
  phone_sequence_ = input.sequence;
  const auto mine = rods_of_pair(layout_, state_.team, pair);
  PhoneInputEvent event{client_, {}};
  event.input.sequence = ++sequence_;
  for (std::size_t i = 0; i < input.rods.size(); ++i) {
    const wire::PhoneRod& rod = input.rods[i];
    event.input.rods[static_cast<std::size_t>(mine.by_x[i])] = {rod.driven, rod.slide, rod.angle,
                                                                rod.slide_rate, rod.angle_rate};
  }
  out.input = event;
}

void PhoneGuest::end(const std::string& why, Outcome& out) {
  out.to_phone.emplace_back(wire::PhoneNotice{number(wire::PhoneNotice::Level::end), why});
  out.end = true;
}

PhoneGuest::Outcome PhoneGuest::handle(const wire::ControlMessage& message) {
  Outcome out;
  if (const auto* welcome = std::get_if<wire::Welcome>(&message)) {
    client_ = welcome->client;
    state_.session = welcome->session;
    state_.ticket = welcome->token;
  } else if (const auto* roster = std::get_if<wire::Roster>(&message)) {
    look_at(*roster, out);
  } else if (const auto* notice = std::get_if<wire::Notice>(&message)) {
    if (notice->level == wire::Notice::Level::cleared) return out;
    const bool warning = notice->level == wire::Notice::Level::warning;
    out.to_phone.emplace_back(wire::PhoneNotice{
        number(warning ? wire::PhoneNotice::Level::warning : wire::PhoneNotice::Level::info),
        notice->text});
  } else if (const auto* refusal = std::get_if<wire::Refusal>(&message)) {
    end(refusal->reason, out);
  } else if (const auto* bye = std::get_if<wire::Bye>(&message)) {
    end(bye->reason, out);
  }
  return out;
}

// Updates the free pairs and this phone's own pair. Rods that do not form a pair, of a seat that
// another kind of client had before, count as none.
void PhoneGuest::look_at(const wire::Roster& roster, Outcome& out) {
  const wire::Seat* me = seat_of(roster, client_);
  if (me == nullptr) return;
  RodSet others = 0;
  for (const wire::Seat& seat : roster.seats)
    if (seat.client != client_) others |= seat.rods;
  wire::PhoneState now{.session = state_.session, .ticket = state_.ticket, .name = me->name};
  for (int team = 0; team < foosball::kTeams; ++team) {
    for (const RodPair pair : kPairs) {
      const RodPairOf rods = rods_of_pair(layout_, team, pair);
      if ((rods.rods & others) == 0)
        now.free |= static_cast<std::uint8_t>(1u << (2 * team + number(pair)));
      if (me->rods != rods.rods) continue;
      now.team = static_cast<std::uint8_t>(team);
      now.pair = number(pair);
      for (std::size_t i = 0; i < now.rods.size(); ++i)
        now.rods[i] =
            place_of(foosball::table_spec(layout_).rods[static_cast<std::size_t>(rods.by_x[i])]);
    }
  }
  if (reported_ && same(now, state_)) return;
  reported_ = true;
  state_ = now;
  out.to_phone.emplace_back(now);
}

}  // namespace server
