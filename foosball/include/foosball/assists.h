// Help for a person with one hand free: which rod to take (automatic rod), goalie and defence that
// cover the shot (goalie follows), a slide that meets the ball (aim). One function for the client,
// whose hands it helps, and for matches without a screen, whose one-rod player it helps.
//
// An assist changes targets only: it sees what the person sees, and the rods follow its targets
// with the same bounded force as a hand's. It slides no rod faster than kAssistRate, and starts and
// stops with at most kAssistAcceleration: those of a held key.
//
// Deterministic: the state is the object, time is counted in ticks. Symmetric: for team 1 it does
// with the turned table to the bit what it does for team 0. One thread.
#pragma once

#include <array>
#include <cstdint>

#include "foosball/rod_motion.h"
#include "foosball/table.h"
#include "vphysics/lie.h"

namespace foosball {

// Each by itself.
struct AssistChoice {
  bool automatic_rod = false;
  bool goalie_follows = false;
  bool aim = false;
  bool any() const { return automatic_rod || goalie_follows || aim; }
  bool operator==(const AssistChoice&) const = default;
};

inline constexpr double kAssistRate = 1.2;           // of a slide [m/s]
inline constexpr double kAssistAcceleration = 12.0;  // [m/s^2]
inline constexpr double kSettleRate = 5.0;           // of men that come to hang down [rad/s]
inline constexpr double kAimPull = 0.008;            // the most that aim moves a rod aside [m]
inline constexpr double kAimRate = 0.25;             // and how fast [m/s]
inline constexpr double kAimReach = 0.030;  // a foot further than this beside its place is not
                                            // helped [m]: aim finishes an aim, it makes none
// A rod that can act so much sooner than the one in hand is taken in its place [s]. Less, and the
// choice flickers while the ball lies between two rods.
inline constexpr double kSoonerBy = 0.12;

// What a person sees, in the table's frame.
struct AssistView {
  bool ball_in_play = false;
  vp::Vec3 ball, velocity;             // [m], [m/s]
  std::array<RodState, kRods> rods{};  // all eight: the opponent's men stand in the way of a shot
  TeamBodies bodies;
};

// What the person does.
struct AssistHand {
  std::array<RodTarget, kRods> targets{};
  std::uint8_t held = 0;  // rods that are in the hand, by bit: they are its own, but for the aim
  bool strikes = false;   // presses or turns to strike with the rod in hand: aim helps, and the rod
                          // is not changed
};

class Assists {
 public:
  // rods: the person's, by bit. Precondition: team is 0 or 1.
  Assists(int team, Layout layout, std::uint8_t rods, const AssistChoice& choice);

  // The rod that can act next, of the person's: the one in hand unless another can by kSoonerBy
  // sooner. `now`: the one in hand, -1: none. Without automatic_rod it is `now`.
  int rod_to_take(const AssistView& view, const AssistHand& hand, int now) const;

  // Targets of all rods, so many ticks after the call before (0: the first). Those that it does not
  // help are the hand's. Preconditions: everything is finite, 0 <= ticks.
  std::array<RodTarget, kRods> steer(const AssistView& view, const AssistHand& hand, int ticks);

  // Rods that steer() has moved and the hand does not hold, by bit: the hand that takes one takes
  // it where it is.
  std::uint8_t following() const { return following_; }

 private:
  struct Rod {
    bool follows = false;
    double slide = 0.0, rate = 0.0;  // of one that follows, team's frame
    double angle = 0.0;              // table's frame
    double pull = 0.0;               // of the aim, team's frame
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
  mutable CharacterBody seen_;  // of which reach_ is field_reach(): that takes a while
  mutable double reach_;
  std::array<Rod, kRods> rods_{};
  std::uint8_t following_ = 0;
};

}  // namespace foosball
