// The registry of players: one row per kind.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "foosball/assists.h"
#include "foosball/computer_player.h"
#include "match/player.h"

namespace match {
namespace {

using foosball::kRods;
using foosball::MatchView;
using foosball::RodTargets;
using Made = tl::expected<std::unique_ptr<Player>, std::string>;

class Computer final : public Player {
 public:
  Computer(const PlayerDesc& desc, const foosball::PlayerSpec& spec,
           const std::optional<foosball::Judgment>& judgment)
      : player_({.team = desc.team,
                 .seed = desc.seed,
                 .opens_match = false,
                 .player = spec,
                 .judgment = judgment}) {}
  void play(const MatchView& view, RodTargets& targets, std::uint8_t rods) override {
    player_.play(view, targets, rods);
  }
  foosball::PlayedPass passed() const override { return player_.passed(); }

 private:
  foosball::ComputerPlayer player_;
};

class Idle final : public Player {
 public:
  void play(const MatchView&, RodTargets&, std::uint8_t) override {}
};

// All rods of the team spin forward continuously, each with a man level with the ball. It wins
// against players who only guard, and ITSF rules forbid it.
class Spinner final : public Player {
 public:
  explicit Spinner(int team) : team_(team) {}
  void play(const MatchView& view, RodTargets& targets, std::uint8_t rods) override {
    constexpr double kRate = 60.0;  // a fast flick of the wrist [rad/s]
    constexpr double kSpeed = 1.5;  // of the slide [m/s]
    const bool turns = view.screen == foosball::Screen::play && !view.paused;
    const double rate = turns ? -foosball::attack_sign(team_) * kRate : 0.0;
    angle_ += rate * foosball::kTick;
    const auto& table = foosball::table_spec(view.layout);
    for (const int rod : rods_of_team(table, team_)) {
      if ((rods >> rod & 1) == 0) continue;
      const double way = goal_of(table.rods[rod], view.ball_position.y, slide_[rod]) - slide_[rod];
      const double step = std::clamp(way, -kSpeed * foosball::kTick, kSpeed * foosball::kTick);
      slide_[rod] += step;
      targets[rod] = {slide_[rod], angle_, step / foosball::kTick, rate, true};
    }
  }

 private:
  // The slide that brings a man to y with the least motion.
  static double goal_of(const foosball::RodSpec& rod, double y, double slide) {
    double best = slide, min = 1e9;
    for (int man = 0; man < rod.men; ++man) {
      const double wanted = y - man_offset(rod, man);
      const double goal = std::clamp(wanted, -rod.slide_limit, rod.slide_limit);
      const double cost = 10.0 * std::fabs(wanted - goal) + std::fabs(goal - slide);
      if (cost < min) {
        min = cost;
        best = goal;
      }
    }
    return best;
  }

  int team_;
  double angle_ = 0.0;
  std::array<double, kRods> slide_{};
};

// A person with one hand, such as with a mouse: plays the inner player with one rod, the one that
// this person would take. The assists choose this rod and move the others (foosball/assists.h).
class OneRod final : public Player {
 public:
  OneRod(int team, std::unique_ptr<Player> inner) : team_(team), inner_(std::move(inner)) {}

  void play(const MatchView& view, RodTargets& targets, std::uint8_t rods) override {
    if (!assists_ || layout_ != view.layout || rods_ != rods) begin(view.layout, rods);
    const foosball::AssistView seen{.ball_in_play = view.ball_in_play,
                                    .ball = view.ball_position,
                                    .velocity = view.ball_velocity,
                                    .rods = view.rods,
                                    .bodies = view.bodies};
    take_a_rod(seen);
    const auto held = static_cast<std::uint8_t>(rod_ < 0 ? 0U : 1U << static_cast<unsigned>(rod_));
    for (const int own : own_rods()) {
      if ((rods_ >> own & 1) != 0) targets[static_cast<std::size_t>(own)].live = false;
    }
    inner_->play(view, targets, held);
    foosball::AssistHand hand{.targets = targets, .held = held};
    constexpr double kStrikes = 8.0;  // [rad/s]
    hand.strikes =
        rod_ >= 0 && std::fabs(targets[static_cast<std::size_t>(rod_)].angle_rate) > kStrikes;
    const auto helped = assists_->steer(seen, hand, 1);
    for (const int own : own_rods()) {
      const auto i = static_cast<std::size_t>(own);
      if ((rods_ >> own & 1) != 0) targets[i] = helped[i];
    }
  }
  foosball::PlayedPass passed() const override { return inner_->passed(); }

 private:
  std::array<int, 4> own_rods() const { return rods_of_team(foosball::table_spec(layout_), team_); }

  void take_a_rod(const foosball::AssistView& seen) {
    const int rod = assists_->rod_to_take(seen, {}, rod_);
    constexpr int kSettle = 100;  // ticks: minimum time between changes of rod
    if (++since_ >= kSettle && rod != rod_) {
      rod_ = rod;
      since_ = 0;
    }
    if (rod_ < 0) rod_ = rod;
  }

  void begin(foosball::Layout layout, std::uint8_t rods) {
    layout_ = layout;
    rods_ = rods;
    unsigned own = 0;
    for (const int rod : own_rods()) own |= 1U << static_cast<unsigned>(rod);
    if ((rods >> std::max(0, rod_) & 1) == 0) rod_ = -1;
    assists_.emplace(
        team_, layout, static_cast<std::uint8_t>(own & rods),
        foosball::AssistChoice{.automatic_rod = true, .goalie_follows = true, .aim = true});
  }

  int team_, rod_ = -1, since_ = 0;
  std::uint8_t rods_ = 0;
  foosball::Layout layout_{};
  std::optional<foosball::Assists> assists_;
  std::unique_ptr<Player> inner_;
};

// Parses the complete name.
Made make_computer(const PlayerDesc& desc) {
  const auto at = desc.name.find('@');
  const auto spec = foosball::parse_player(desc.name.substr(0, at));
  if (!spec) return tl::unexpected(spec.error().message);
  if (at == std::string::npos) return std::make_unique<Computer>(desc, *spec, std::nullopt);
  if (spec->kind != foosball::PlayerSpec::Kind::level)
    return tl::unexpected("\"" + desc.name + "\": only a level takes values of judgment");
  const auto judgment =
      with_changes(judgment_of(spec->level, spec->style), desc.name.substr(at + 1));
  if (!judgment) return tl::unexpected(judgment.error().message);
  return std::make_unique<Computer>(desc, *spec, *judgment);
}

Made make_one_rod(const PlayerDesc& desc, const std::string& argument) {
  // Nested one-rod players could overflow the stack.
  if (argument.starts_with("one-rod"))
    return tl::unexpected(std::string("one-rod needs another player: give one such as one-rod:2"));
  auto inner = make_player({argument.empty() ? "classic" : argument, desc.team, desc.seed});
  if (!inner) return inner;
  return std::make_unique<OneRod>(desc.team, std::move(*inner));
}

Made without_argument(const PlayerDesc& desc, const std::string& argument,
                      std::unique_ptr<Player> player) {
  if (!argument.empty())
    return tl::unexpected("\"" + desc.name + "\": nothing may follow the name");
  return player;
}

struct Kind {
  const char* name;
  const char* syntax;
  const char* meaning;
  Made (*make)(const PlayerDesc&, const std::string& argument);  // text after the colon
};

constexpr Kind kKinds[] = {
    {"classic", "classic[:SKILL]", "the first computer player, SKILL 0 to 1, default 0.6",
     [](const PlayerDesc& desc, const std::string&) { return make_computer(desc); }},
    {"idle", "idle", "no hand on any rod",
     [](const PlayerDesc& desc, const std::string& argument) {
       return without_argument(desc, argument, std::make_unique<Idle>());
     }},
    {"spinner", "spinner", "all rods spin all the time, a man level with the ball",
     [](const PlayerDesc& desc, const std::string& argument) {
       return without_argument(desc, argument, std::make_unique<Spinner>(desc.team));
     }},
    {"one-rod", "one-rod[:PLAYER]",
     "PLAYER with one hand and all assists, as a person with a mouse", make_one_rod},
};

std::string all_syntax() {
  std::string list;
  for (const PlayerKind& kind : player_kinds()) list += (list.empty() ? "" : ", ") + kind.syntax;
  return list;
}

}  // namespace

tl::expected<std::unique_ptr<Player>, std::string> make_player(const PlayerDesc& desc) {
  const auto colon = desc.name.find(':');
  const std::string name = desc.name.substr(0, colon);
  const std::string argument = colon == std::string::npos ? "" : desc.name.substr(colon + 1);
  for (const Kind& kind : kKinds) {
    if (name == kind.name) return kind.make(desc, argument);
  }
  const std::string level = name.substr(0, name.find('@'));
  if (level.size() == 1 && level[0] >= '0' && level[0] <= '9') return make_computer(desc);
  return tl::unexpected("\"" + desc.name + "\" is not a player: give one of " + all_syntax());
}

std::string default_player() {
  return std::to_string(foosball::PlayerSpec{}.level);
}

std::vector<PlayerKind> player_kinds() {
  std::vector<PlayerKind> kinds{
      {"1..5[:STYLE]", "the computer player of a level; STYLE wall, shooter, passer or gambler"},
      {"5@NAME=NUMBER,...",
       "... with values of its judgment; 5@FILE: those of a file (--list-judgment)"}};
  for (const Kind& kind : kKinds) kinds.push_back({kind.syntax, kind.meaning});
  return kinds;
}

}  // namespace match
