#include <algorithm>
#include <cmath>
#include <tuple>

#include "samples.h"

namespace wire::samples {
namespace {

bool same_rotation(const std::array<float, 4>& a, const std::array<float, 4>& b) {
  constexpr double kQuantum = 1.5e-4;
  double plus = 0, minus = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    plus = std::max(plus, std::abs(static_cast<double>(a[i]) + static_cast<double>(b[i])));
    minus = std::max(minus, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
  }
  return std::min(plus, minus) <= kQuantum;
}

bool same(const PoseVelocity& a, const PoseVelocity& b) {
  return a.position == b.position && a.linear_velocity == b.linear_velocity &&
         a.angular_velocity == b.angular_velocity && same_rotation(a.orientation, b.orientation);
}

bool same(const ManState& a, const ManState& b) {
  return a.rod == b.rod && a.man == b.man && same(a.body, b.body);
}

auto tied(const RodSnapshot& r) {
  return std::tie(r.slide, r.angle, r.slide_rate, r.angle_rate, r.status, r.source);
}
auto tied(const EventSnapshot& e) {
  return std::tie(e.id, e.kind, e.team, e.rod, e.man, e.value, e.point);
}
auto tied(const InputRod& r) {
  return std::tie(r.driven, r.slide, r.angle, r.slide_rate, r.angle_rate);
}
auto tied(const Hello& m) {
  return std::tie(m.version, m.snapshot_layout, m.name, m.udp_port, m.team, m.rods, m.session,
                  m.ticket);
}
auto tied(const Welcome& m) {
  return std::tie(m.session, m.token, m.udp_port, m.tick_us, m.layout, m.team, m.multicast,
                  m.multicast_port, m.rods, m.role, m.client, m.input_key, m.snapshot_key);
}
auto tied(const Knock& m) {
  return std::tie(m.version, m.role, m.sid, m.share);
}
auto tied(const Challenge& m) {
  return std::tie(m.share);
}
auto tied(const Claim& m) {
  return std::tie(m.rods, m.team);
}
auto tied(const Kick& m) {
  return std::tie(m.client);
}
auto tied(const Names& m) {
  return std::tie(m.name, m.players);
}
auto tied(const Phones& m) {
  return std::tie(m.url);
}
auto tied(const DeviceQuery&) {
  return std::tuple<>();
}
auto tied(const Devices& m) {
  return std::tie(m.time_us, m.devices);
}
auto tied(const Tuning& m) {
  return std::tie(m.values);
}
auto tied(const Game& m) {
  return std::tie(m.mode, m.rule_set, m.goals, m.sets, m.match_ms, m.change_sides, m.level, m.style,
                  m.date, m.waits);
}
auto tied(const Questionnaire& m) {
  return std::tie(m.match, m.rods);
}
auto tied(const Answers& m) {
  return std::tie(m.match, m.rods, m.scores);
}
auto tied(const TeamReport& m) {
  return std::tie(m.shots, m.shots_on_target, m.saves, m.passes, m.own_goals, m.possession,
                  m.rating, m.rating_change, m.fastest_shot);
}
auto tied(const Fame& m) {
  return std::tie(m.name, m.rating, m.matches, m.wins, m.fastest_shot, m.shots_faced, m.saves);
}
auto tied(const Seat& m) {
  return std::tie(m.client, m.name, m.team, m.rods, m.role, m.away);
}
auto tied(const Characters& m) {
  return std::tie(m.characters);
}
auto tied(const Refusal& m) {
  return std::tie(m.code, m.reason);
}
auto tied(const MatchRequest& m) {
  return std::tie(m.kind, m.team, m.value, m.amount);
}
auto tied(const Ping& m) {
  return std::tie(m.id);
}
auto tied(const Pong& m) {
  return std::tie(m.id);
}
auto tied(const Notice& m) {
  return std::tie(m.level, m.topic, m.text);
}
auto tied(const Bye& m) {
  return std::tie(m.reason);
}
auto tied(const JournalHeader& e) {
  return std::tie(e.version, e.layout, e.seed, e.mode, e.rule_set, e.goals_to_win, e.max_goals,
                  e.lead, e.sets_to_win, e.match_ms, e.golden_goal, e.change_sides, e.jarring,
                  e.spin, e.time_outs, e.time_out_ms, e.dead_ball_ms, e.still_ms,
                  e.possession_midfield_ms, e.possession_ms, e.ceremony_ms, e.end_ms, e.idle_ms,
                  e.attract_ms, e.tuning, e.characters);
}
auto tied(const JournalTick& e) {
  return std::tie(e.tick, e.rods, e.commands);
}
auto tied(const JournalHash& e) {
  return std::tie(e.tick, e.state_hash);
}
auto tied(const JournalKeyframe& e) {
  return std::tie(e.tick, e.snapshot);
}
auto tied(const JournalStanding& e) {
  return std::tie(e.tick, e.score, e.sets, e.character, e.computer, e.won);
}
auto tied(const JournalEnd& e) {
  return std::tie(e.ticks, e.state_hash);
}

auto tied(const PhoneHello& m) {
  return std::tie(m.session, m.ticket, m.name);
}
auto tied(const PhoneClaim& m) {
  return std::tie(m.team, m.pair);
}
auto tied(const PhoneRod& r) {
  return std::tie(r.driven, r.slide, r.angle, r.slide_rate, r.angle_rate);
}
auto tied(const PhoneRodPlace& r) {
  return std::tie(r.line, r.men, r.spacing, r.slide_limit);
}
auto tied(const PhoneNotice& m) {
  return std::tie(m.level, m.text);
}
auto tied(const PhonePulse& m) {
  return std::tie(m.rod, m.strength, m.ms);
}

template <class List>
bool all_tied(const List& a, const List& b) {
  return std::ranges::equal(a, b, [](const auto& x, const auto& y) { return tied(x) == tied(y); });
}

// Compares the seats element by element: Seat has no operator==.
struct TiedRoster {
  const Roster& roster;
  friend bool operator==(const TiedRoster& a, const TiedRoster& b) {
    return all_tied(a.roster.seats, b.roster.seats) && a.roster.players == b.roster.players;
  }
};
TiedRoster tied(const Roster& m) {
  return {m};
}

struct TiedReport {
  const Report& report;
  friend bool operator==(const TiedReport& a, const TiedReport& b) {
    return a.report.match == b.report.match && all_tied(a.report.teams, b.report.teams) &&
           all_tied(a.report.fame, b.report.fame);
  }
};
TiedReport tied(const Report& m) {
  return {m};
}

struct TiedPhoneInput {
  const PhoneInput& input;
  friend bool operator==(const TiedPhoneInput& a, const TiedPhoneInput& b) {
    return a.input.sequence == b.input.sequence && all_tied(a.input.rods, b.input.rods);
  }
};
TiedPhoneInput tied(const PhoneInput& m) {
  return {m};
}

struct TiedPhoneState {
  const PhoneState& state;
  friend bool operator==(const TiedPhoneState& a, const TiedPhoneState& b) {
    const auto head = [](const PhoneState& s) {
      return std::tie(s.session, s.ticket, s.team, s.pair, s.free, s.name);
    };
    return head(a.state) == head(b.state) && all_tied(a.state.rods, b.state.rods);
  }
};
TiedPhoneState tied(const PhoneState& m) {
  return {m};
}

template <class Variant>
bool same_variant(const Variant& a, const Variant& b) {
  return a.index() == b.index() && std::visit(
                                       [&](const auto& x) {
                                         using T = std::decay_t<decltype(x)>;
                                         return tied(x) == tied(std::get<T>(b));
                                       },
                                       a);
}

auto tied_head(const Snapshot& s) {
  return std::tie(s.session, s.sequence, s.tick, s.send_time_us, s.layout, s.screen, s.paused,
                  s.ball_in_play, s.score, s.character, s.confirmed, s.last_scorer,
                  s.screen_seconds, s.play_seconds);
}

}  // namespace

bool same_but_for_ties(const Snapshot& a, const Snapshot& b) {
  return tied_head(a) == tied_head(b) && same(a.ball, b.ball) && all_tied(a.rods, b.rods) &&
         std::ranges::equal(a.men, b.men,
                            [](const ManState& x, const ManState& y) { return same(x, y); }) &&
         all_tied(a.events, b.events);
}

bool same(const InputDatagram& a, const InputDatagram& b) {
  return std::tie(a.session, a.token, a.sequence) == std::tie(b.session, b.token, b.sequence) &&
         all_tied(a.rods, b.rods);
}

bool same(const ControlMessage& a, const ControlMessage& b) {
  return same_variant(a, b);
}
bool same(const JournalEntry& a, const JournalEntry& b) {
  return same_variant(a, b);
}
bool same(const PhoneRequest& a, const PhoneRequest& b) {
  return same_variant(a, b);
}
bool same(const PhoneReply& a, const PhoneReply& b) {
  return same_variant(a, b);
}

}  // namespace wire::samples
