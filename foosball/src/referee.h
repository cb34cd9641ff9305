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

// The team that scores with the ball here: it has wholly passed the goal line inside the goal.
std::optional<int> goal_by(const TableSpec& table, const vp::Vec3& ball);

// The ball's centre is over a wall, beyond it, or below the field, and not in a goal.
bool out_of_table(const TableSpec& table, const vp::Vec3& ball);

// Of a set (2): to goals_to_win, in the last possible set by rules.lead; the first to max_goals
// wins in any case. Once the time is over, whoever leads.
std::optional<int> winner(const Rules& rules, const std::array<int, kTeams>& score, bool last_set,
                          bool time_over);

// Where a dead ball is put back (8.1, 8.2): at the nearest defence; between the midfields it is
// served again, by the team that served last.
int rod_for_dead_ball(const TableSpec& table, double ball_x, int last_server);

// Where the ball goes that the team held too long with a rod of this line (24.3): from the attack
// to the opponent's defence, from elsewhere to the opponent's midfield.
int rod_after_possession(const TableSpec& table, int team, Line line);

// Which parts of men touch the ball, by part and not by count: a contact whose beginning or end was
// not seen (the ball was put elsewhere) leaves nothing wrong about the others.
class BallTouches {
 public:
  void clear() { parts_ = {}; }
  // What the tag of a part names: rod < kRods, man < kMaxMenOnRod, part < kManParts.
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

// Of the rods in reach (bits, one at least) the one whose axis is nearest to the ball.
int nearest_in_reach(const TableSpec& table, std::uint8_t rods_in_reach, double ball_x);

// Watches for a ball that nobody can reach, that nobody plays on, or that somebody holds too long.
class BallWatch {
 public:
  enum class Verdict {
    alive,
    dead,  // out of everybody's reach (8)
    held,  // one rod has had it for too long (24), or it lies still within its reach
  };
  // Of a team none of whose rods has been moved for rules.still_seconds of play: a ball that lies
  // still within its reach waits only so long for it. Any motion of a rod brings the full time
  // back.
  static constexpr double kAbsentStillSeconds = 0.5;

  struct Sight {
    vp::Vec3 ball, velocity;
    std::uint8_t rods_in_reach = 0;
    bool touched = false;               // by a man
    std::array<bool, kTeams> absent{};  // no rod of the team has been moved for rules.still_seconds
  };

  void reset(const vp::Vec3& ball);
  // One tick. What ends a count ends it for good: after a verdict the caller resets.
  Verdict update(const TableSpec& table, const Rules& rules, const Sight& sight);
  // Time of possession begins anew (17).
  void restart_possession() { ticks_possessed_ = ticks_untouched_ = 0; }

  // The rod within whose reach the ball is or was last; none since the last reset: nothing.
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
  vp::Vec3 anchor_;                    // the ball has stayed near this point
  int rod_ = kRods;                    // of possession; kRods: none yet
  bool in_reach_ = false;              // now
  bool left_ = false;                  // the ball has left rod_ since
  std::uint64_t ticks_possessed_ = 0;  // by rod_
  std::uint64_t ticks_unreached_ = 0;  // out of everybody's reach
  std::uint64_t ticks_stopped_ = 0;    // out of everybody's reach and not moving
  std::uint64_t ticks_untouched_ = 0;  // near anchor_ and touched by no man
};

}  // namespace foosball
