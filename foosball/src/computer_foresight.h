// A computer player's imagination: strokes tried on a table of its own, a bounded number of ticks
// of it for each tick of play, so that no tick of play is late. Judges a stroke by where the ball
// is a moment later, with the player's own motor noise.
//
// Deterministic: what it finds follows from the situations, the seed and the number of ticks.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "computer_sight.h"
#include "computer_stroke.h"
#include "random.h"
#include "table_world.h"

namespace foosball {

// In the team's frame. The ball is where the foot will be set up to play it.
struct Situation {
  int rod = 0, man = 0;  // of the stroke; rod indexes TableSpec::rods
  vp::Vec3 ball, velocity;
  std::array<double, kRods> slide{}, swing{};
  int receiver = -1;  // rod that a hand moves to meet a pass, or -1
};

class Foresight {
 public:
  struct Idea {
    Stroke stroke;
    double sum = 0.0;  // of the worths of its trials
    int trials = 0;
    double worth() const { return trials > 0 ? sum / trials : -1.0; }
  };

  Foresight(int team, const Temperament& t, std::uint64_t seed);

  // The table to imagine. Allocates: not in a tick of play.
  void set_table(Layout layout, const std::array<int, kTeams>& characters);
  // Forgets its ideas and begins anew.
  void consider(const Situation& situation);
  // Up to `ticks` of the imagined table.
  void think(int ticks);
  const Situation& situation() const { return situation_; }
  int ideas() const { return static_cast<int>(ideas_.size()) - (running_new_ ? 1 : 0); }
  const Idea* best() const;  // of those tried as often as any; null while there is none

 private:
  void start_trial();
  void place();
  void step_trial();
  void finish_trial(double worth);
  Stroke invent();
  Stroke invent_slide_shot(double ahead);
  void aim_at_rolling_ball();
  void move_receiver(const vp::Vec3& ball, const vp::Vec3& velocity);
  void move_opponents(const vp::Vec3& ball);
  void drive(int rod, const HandAxis& slide, const HandAxis& swing);
  double worth_of(const vp::Vec3& ball, const vp::Vec3& velocity) const;

  int team_;
  Temperament t_;
  Random random_;
  std::unique_ptr<TableWorld> world_;
  double half_foot_ = 0.012;
  Situation situation_;
  std::vector<Idea> ideas_;

  // The trial under way.
  int trial_ = -1;  // index into ideas_
  bool running_new_ = false;
  int ticks_ = 0, ticks_since_strike_ = 0, late_ = 0;
  double stray_ = 0.0;  // the ball strays from the foot by the player's own error [m]
  StrokeRun run_;
  std::array<HandAxis, kRods> slide_, swing_;
};

}  // namespace foosball
