// The rules of play that need no world: goal, ball out, end of a match, dead ball, and which rod
// serves. Source: ITSF rules as in docs/rules.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "foosball/match.h"
#include "ticks.h"

namespace foosball {

constexpr int opponent(int team) {
  return 1 - team;
}

// The team that scores with the ball at this position: the whole ball has passed the goal line
// inside the goal.
std::optional<int> goal_by(const TableSpec& table, const vp::Vec3& ball);

// True if the ball's centre is above a wall, beyond it or below the field, and not in a goal.
bool out_of_table(const TableSpec& table, const vp::Vec3& ball);

// Winner of a set (2): first to goals_to_win, in the last possible set with a lead of rules.lead;
// the first to max_goals wins in any case. After the time limit, the leader.
std::optional<int> winner(const Rules& rules, const std::array<int, kTeams>& score, bool last_set,
                          bool time_over);

// The rod that gets a dead ball (8.1, 8.2): the nearest defence. Between the midfields, the team
// that served last serves again.
int rod_for_dead_ball(const TableSpec& table, double ball_x, int last_server);

// The rod that gets the ball after the team exceeded the time limit with a rod of this line (24.3):
// from the attack the opponent's defence, otherwise the opponent's midfield.
int rod_after_possession(const TableSpec& table, int team, Line line);

// The parts of men that touch the ball, as a set rather than a count: a missed begin or end of a
// contact (when the ball was relocated) does not affect other parts.
class BallTouches {
 public:
  void clear() { parts_ = {}; }
  // The values of a part's tag: rod < kRods, man < kMaxMenOnRod, part < kManParts.
  void set(int rod, int man, int part, bool touches) {
    const std::uint64_t bit = std::uint64_t{1} << (rod * kMaxMenOnRod + man);
    parts_[part] = touches ? parts_[part] | bit : parts_[part] & ~bit;
  }
  bool any() const { return parts_ != decltype(parts_){}; }

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    constexpr std::uint64_t kAll = (std::uint64_t{1} << (kRods * kMaxMenOnRod)) - 1;
    for (auto& part : self.parts_) archive.count(part, kAll);
  }

 private:
  std::array<std::uint64_t, kManParts> parts_{};  // bit rod * 5 + man
};

// Among the rods in reach (bits, at least one), the one whose axis is nearest to the ball.
int nearest_in_reach(const TableSpec& table, std::uint8_t rods_in_reach, double ball_x);

// Detects a ball that no man can reach, that nobody plays, or that a team holds too long.
class BallWatch {
 public:
  enum class Verdict {
    alive,
    dead,  // no man can reach it (8)
    held,  // one rod had it for too long (24), or it lies still within reach
  };
  // Waiting time for a team that has moved no rod for rules.still_seconds of play: a ball at rest
  // within its reach waits only this long. Any motion of a rod restores the full time.
  static constexpr double kAbsentStillSeconds = 0.5;

  struct Sight {
    vp::Vec3 ball, velocity;
    std::uint8_t rods_in_reach = 0;
    bool touched = false;               // by a man
    std::array<bool, kTeams> absent{};  // the team has moved no rod for rules.still_seconds
  };

  void reset(const vp::Vec3& ball);
  // One tick. After a verdict the caller must reset().
  Verdict update(const TableSpec& table, const Rules& rules, const Sight& sight);
  // Restarts the time of possession (17).
  void restart_possession() { ticks_possessed_ = ticks_untouched_ = 0; }

  // The rod that can reach the ball, or could last; none since the last reset.
  std::optional<int> rod() const { return rod_ < kRods ? std::optional<int>(rod_) : std::nullopt; }
  bool in_reach() const { return in_reach_; }
  std::uint64_t ticks_possessed() const { return ticks_possessed_; }

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    archive.real(self.anchor_.x, -10.0, 10.0);
    archive.real(self.anchor_.y, -10.0, 10.0);
    archive.real(self.anchor_.z, -10.0, 10.0);
    archive.choice(self.rod_, kRods + 1);
    archive.flag(self.in_reach_);
    archive.flag(self.left_);
    for (auto* ticks : {&self.ticks_possessed_, &self.ticks_unreached_, &self.ticks_stopped_,
                        &self.ticks_untouched_}) {
      archive.count(*ticks, kMaxTicks);
    }
  }

 private:
  vp::Vec3 anchor_;                    // reference point: the ball stays near it
  int rod_ = kRods;                    // rod in possession; kRods: none yet
  bool in_reach_ = false;              // now
  bool left_ = false;                  // the ball has left rod_ since then
  std::uint64_t ticks_possessed_ = 0;  // by rod_
  std::uint64_t ticks_unreached_ = 0;  // no man can reach the ball
  std::uint64_t ticks_stopped_ = 0;    // no man can reach the ball, and it does not move
  std::uint64_t ticks_untouched_ = 0;  // near anchor_, and no man touched it
};

}  // namespace foosball
