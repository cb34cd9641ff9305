// The rules of play that need no world: goal, ball out, end of a match, dead ball, and which rod
// serves. Source: ITSF rules as in docs/rules.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "foosball/match.h"

namespace foosball {

constexpr int opponent(int team) {
  return 1 - team;
}

// The team that scores with the ball here: it has wholly passed the goal line inside the goal.
std::optional<int> goal_by(const TableSpec& table, const vp::Vec3& ball);

// The ball's centre is over a wall, beyond it, or below the field, and not in a goal.
bool out_of_table(const TableSpec& table, const vp::Vec3& ball);

// To goals_to_win, by two; the first to max_goals wins in any case.
std::optional<int> winner(const Rules& rules, const std::array<int, kTeams>& score);

// Where a dead ball is put back: at the nearest defence; between the midfields it is served again,
// by the team that served last.
int rod_for_dead_ball(const TableSpec& table, double ball_x, int last_server);

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
    for (auto& part : self.parts_) archive.count(part);
  }

 private:
  std::array<std::uint64_t, kManParts> parts_{};  // bit rod * 5 + man
};

// Watches for a ball that nobody plays on.
class DeadBallWatch {
 public:
  void reset(const vp::Vec3& ball);
  // One tick; true when the ball is dead: it has stayed where it is, and no man has touched it for
  // rules.dead_ball_seconds or one has held it longer than a possession may last.
  bool update(const TableSpec& table, const Rules& rules, const vp::Vec3& ball, bool touched);

  template <class Archive, class Self>
  static void visit(Archive& archive, Self& self) {
    archive.real(self.anchor_.x, -10.0, 10.0);
    archive.real(self.anchor_.y, -10.0, 10.0);
    archive.real(self.anchor_.z, -10.0, 10.0);
    archive.count(self.ticks_here_);
    archive.count(self.ticks_untouched_);
  }

 private:
  vp::Vec3 anchor_;                    // the ball has stayed near this point ...
  std::uint64_t ticks_here_ = 0;       // ... for so long,
  std::uint64_t ticks_untouched_ = 0;  // and for so long no man has touched it
};

}  // namespace foosball
