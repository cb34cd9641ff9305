// Assists for a person who plays with one hand: which rod to take (automatic rod), goalie and
// defence that cover the shot (goalie follows), a slide that meets the ball (aim). The client uses
// it for its own player. Matches without a screen use it for their one-rod player.
//
// An assist only changes targets. It sees what the person sees. The rods follow its targets with
// the same bounded force as a hand's. Its slides are no faster than kAssistRate, and accelerate and
// brake at no more than kAssistAcceleration: the limits of a pressed key.
//
// Deterministic: all state is in the object, and time is counted in ticks. Symmetric: for team 1 on
// the table rotated by half a turn, the results are bit for bit those of team 0. Use from one
// thread.
#pragma once

#include <array>
#include <cstdint>

#include "foosball/rod_motion.h"
#include "foosball/table.h"
#include "vphysics/lie.h"

namespace foosball {

// Each assist can be switched on separately.
struct AssistChoice {
  bool automatic_rod = false;
  bool goalie_follows = false;
  bool aim = false;
  bool any() const { return automatic_rod || goalie_follows || aim; }
  bool operator==(const AssistChoice&) const = default;
};

inline constexpr double kAssistRate = 1.2;           // of a slide [m/s]
inline constexpr double kAssistAcceleration = 12.0;  // [m/s^2]
inline constexpr double kSettleRate = 5.0;           // of men that return to hanging down [rad/s]
inline constexpr double kAimPull = 0.008;            // limit of the aim's correction of a slide [m]
inline constexpr double kAimRate = 0.25;             // and of its rate [m/s]
// The aim ignores a foot that is further from its target [m]: it only corrects a person's aim.
inline constexpr double kAimReach = 0.030;
// Automatic rod: another rod replaces the current one if it can act this much sooner [s]. With
// less, the choice flickers while the ball is between two rods.
inline constexpr double kSoonerBy = 0.12;

// What a person sees, in the table's frame.
struct AssistView {
  bool ball_in_play = false;
  vp::Vec3 ball, velocity;             // [m], [m/s]
  std::array<RodState, kRods> rods{};  // all eight: the opponent's men block shots
  TeamBodies bodies;
};

// The person's input.
struct AssistHand {
  std::array<RodTarget, kRods> targets{};
  std::uint8_t held = 0;  // rods in the hand, as bits: only the aim affects them
  bool strikes = false;   // presses or rotates to strike with the rod in hand: aim is active, and
                          // the rod does not change
};

class Assists {
 public:
  // rods: those of the person, as bits. Precondition: team is 0 or 1.
  Assists(int team, Layout layout, std::uint8_t rods, const AssistChoice& choice);

  // The person's rod that can act next. Keeps `now` unless another rod can act sooner by kSoonerBy.
  // `now`: the rod in hand; -1: none. Without automatic_rod, returns `now`.
  int rod_to_take(const AssistView& view, const AssistHand& hand, int now) const;

  // Targets of all rods. ticks: since the previous call (0: the first call). Rods without
  // assistance keep the hand's targets. Preconditions: everything is finite, 0 <= ticks.
  std::array<RodTarget, kRods> steer(const AssistView& view, const AssistHand& hand, int ticks);

  // Rods, as bits, that steer() has moved and that are not in the hand. A hand that takes such a
  // rod must take it where it is.
  std::uint8_t following() const { return following_; }

 private:
  struct Rod {
    bool follows = false;
    double slide = 0.0, rate = 0.0;  // while it follows, in the team's frame
    double angle = 0.0;              // table's frame
    double pull = 0.0;               // offset by the aim, in the team's frame
  };
  struct Ball {
    double x, y, vx, vy;  // team's frame: own goal at -x
  };
  Ball ball_of(const AssistView& view) const;
  double rod_x(int rod) const;
  double time_to_act(int rod, const Ball& ball, double reach) const;
  double guard_y(int rod, const Ball& ball) const;
  double slide_for(int rod, double y, double from) const;
  void follow(int rod, const AssistView& view, const RodTarget& from, int ticks);
  double aimed_slide(int rod, const AssistView& view, double slide) const;
  double clearance(const AssistView& view, const Ball& ball, double target) const;
  void pull(int rod, const AssistView& view, double slide, bool strikes, int ticks);

  int team_;
  const TableSpec* table_;
  std::uint8_t mine_;
  AssistChoice choice_;
  double reach_of(const CharacterBody& body) const;
  mutable CharacterBody seen_;  // the body of the cached reach_: field_reach() is expensive
  mutable double reach_;
  std::array<Rod, kRods> rods_{};
  std::uint8_t following_ = 0;
};

}  // namespace foosball
