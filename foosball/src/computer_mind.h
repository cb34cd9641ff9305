// A computer player of a level: which rods its two hands hold, how they guard and receive, and how
// a ball at the foot is set up and played. All in the team's frame (computer_sight.h).
#pragma once

#include <array>

#include "computer_foresight.h"
#include "computer_hands.h"
#include "computer_level.h"
#include "computer_sight.h"
#include "computer_stroke.h"
#include "random.h"

namespace foosball {

// One of the player's rods, by Line.
struct OwnRod {
  int index = 0;  // into TableSpec::rods
  double x = 0.0;
  HandAxis slide, swing;
  double goal = 0.0;       // where the hand brings it [m]
  double turned_at = 0.0;  // when it last changed its direction of sliding [s]
  double level() const;    // the full turn nearest to the swing, where the feet hang down
};

class ComputerMind {
 public:
  ComputerMind(int team, const Temperament& t, std::uint64_t seed);

  void set_table(Layout layout, const std::array<int, kTeams>& characters);
  // One tick of play: moves the axes of the rods that the hands hold.
  void play(const Sighting& now);
  // The hands leave the rods as they are: another screen, or somebody else works them.
  void rest();
  bool holds(int line) const { return hands_.holds(line); }
  std::array<OwnRod, 4>& rods() { return rods_; }

 private:
  enum class Act { none, draw, set_up, feint, stroke, recover };

  const TableSpec& table() const { return *table_; }
  const RodSpec& spec(int line) const { return table_->rods[rods_[line].index]; }
  double man_y(int line, int man) const;
  double ahead(int line, const Sighting& now) const { return now.ball.x - rods_[line].x; }

  // Hands and guard (computer_mind.cpp).
  void assign_hands(const Sighting& now);
  std::array<int, 2> wanted_lines(const Sighting& now) const;
  void guard(int line, const Sighting& now);
  double guard_y(int line, const Sighting& now) const;
  void swing_while_guarding(int line, const Sighting& now);
  void lower(int line, double swing, const Sighting& now);
  bool ball_under(int line, const Sighting& now) const;
  double slide_for(int line, double y, int* man = nullptr) const;
  void follow(int line, double goal);

  // A ball at the foot (computer_control.cpp).
  bool can_control(int line, const Sighting& now) const;
  void begin_control(int line, const Sighting& now);
  void control(const Sighting& now);
  void draw(const Sighting& now);
  void think(const Sighting& now);
  bool choose(const Sighting& now);
  void choose_by_eye(const Sighting& now);
  double clearance(const Sighting& now, double target) const;
  void set_up(const Sighting& now);
  void feint(const Sighting& now);
  void recover(const Sighting& now);
  void enter(Act act);
  double foot_slide(const Sighting& now, double lead) const;
  int receiver_of(int line) const;

  int team_;
  Temperament t_;
  Random random_;
  Foresight foresight_;
  ComputerHands hands_;
  const TableSpec* table_ = nullptr;
  double half_foot_ = 0.012;
  std::array<OwnRod, 4> rods_;
  double time_ = 0.0;  // of play [s]

  Act act_ = Act::none;
  int line_ = 0, man_ = 0;  // of the ball at the foot
  double since_ = 0.0;      // in this act [s]
  double held_ = 0.0;       // since control began [s]
  double pause_ = 0.0;
  double aside_ = 0.0;     // sidestep while the foot goes back past a ball beside it [m]
  bool thinking_ = false;  // the foresight has a situation of this control
  bool over_ = false;      // the foot is behind the ball
  double noise_ = 0.0;     // of this stroke's aim [m]
  int late_ = 0;           // of this stroke's strike [ticks]
  Stroke stroke_;
  StrokeRun run_;
  bool fed_ = false;  // a pass is under way to the next rod
  double fed_at_ = 0.0;
};

}  // namespace foosball
