// How a computer player works one rod that it holds: it guards, takes a ball under control, chooses
// a lane and strikes. Everything is in the team's frame (computer_sight.h).
//
// A forward swing can only send the ball forward. So the feet clear the way of a ball from behind
// by swinging back, not forward. A foot does not swing back while a ball may be in its sweep: it
// steps aside first.
#pragma once

#include "computer_hand.h"
#include "computer_lanes.h"
#include "computer_level.h"
#include "computer_pass.h"
#include "computer_sight.h"
#include "computer_stroke.h"
#include "random.h"

namespace foosball {

class ComputerRod {
 public:
  ComputerRod(const TableSpec& table, int team, int index, const LaneView& lanes, const Foot& foot,
              const Judgment& judgment);

  int index() const { return index_; }
  double x() const { return x_; }  // of the axis [m]
  const RodSpec& spec() const { return table_->rods[static_cast<std::size_t>(index_)]; }
  HandAxis& slide() { return slide_; }
  HandAxis& swing() { return swing_; }
  double angle() const;  // swing relative to hanging straight down, modulo full turns [rad]

  // One tick with a hand on the rod. guard_y: where a man should stand while there is no ball to
  // play.
  void play(const Sighting& now, double guard_y, const Temperament& t, Random& random);
  // One tick without a hand: the rod rests where it was left.
  void rest();
  // Aborts the current action and observes again.
  void give_up() { enter(Act::watch); }
  // Takes over the rod at its current position, which another hand may have set.
  void adopt(double slide, double swing);

  bool has_ball() const { return act_ == Act::draw || act_ == Act::strike || act_ == Act::scoop; }
  bool busy() const { return act_ == Act::strike || act_ == Act::brake; }
  // Its foot met the ball in this tick, and sent it off with sent_velocity().
  bool struck() const { return struck_; }
  vp::Vec3 sent_velocity() const { return sent_; }
  // The receiver of that ball: rod < 0, none.
  const PassPlan& sent_to() const { return pass_; }
  // Announces a pass to this man of the rod, who meets the ball at y after a time [s].
  void expect_pass(int man, double y, double time);
  bool expects_pass() const { return receives_ > 0; }
  // True for a ball that this rod can take under control.
  bool can_control(const Sighting& now) const;
  // The slide that brings a man to y: the man who comes nearest to it, then the one with the
  // shortest slide.
  double slide_for(double y, int* man = nullptr) const;

 private:
  enum class Act { watch, draw, strike, brake, scoop };

  void enter(Act act);
  void watch(const Sighting& now, double guard_y, const Temperament& t, Random& random);
  void begin_control(const Sighting& now, const Temperament& t, Random& random);
  void draw(const Sighting& now, const Temperament& t, Random& random);
  Meeting meeting(const Sighting& now, double rate, const Temperament& t) const;
  double chosen_rate(const Temperament& t) const;
  double square_to(const Meeting& m);
  Sighting met(const Sighting& now, const Meeting& m) const;
  bool can_turn(const Meeting& m, double slope, double natural) const;
  double shot_worth(const Sighting& then, const Meeting& m, double slope,
                    const Temperament& t) const;
  void go_behind(const Sighting& now, double square, double drawn, const Temperament& t);
  void prepare_scoop(const Sighting& now, double square, const Temperament& t, Random& random);
  bool can_stand_beside(double square, double side, double beside) const;
  void choose_hook(const Sighting& now, double square, const Temperament& t, Random& random);
  double beside_ball(double square) const;
  void scoop(const Sighting& now, const Temperament& t);
  void receive(const Sighting& now, const Temperament& t);
  PassPlan pass_worth(const Sighting& now, double slope, double speed, double slope_error,
                      const Temperament& t) const;
  double slope_error(bool flat, const Temperament& t) const;
  void consider_lanes(const Sighting& now, const Temperament& t);
  void wait_for_ball(const Sighting& now, const Meeting& m, double aim, const Temperament& t);
  void strike_if_ready(const Sighting& now, const Meeting& m, bool aligned, const Temperament& t);
  void choose_lane(const Sighting& now, const Temperament& t);
  bool lost(const Sighting& now) const;
  void strike(const Temperament& t);
  void brake(const Temperament& t);
  void swing_back(double goal, const Sighting& now, const AxisLimits& limits);
  double safe_rate(const Sighting& now) const;
  bool ball_in_sweep(double goal, const Sighting& now) const;
  double approach() const;
  bool pinches(const Sighting& now) const;
  bool is_behind_feet(const Sighting& now) const;
  double clear(const Sighting& now) const;
  void step_aside(const Sighting& now);
  void follow(double goal);
  double level() const;  // full turn nearest to the swing, at which the feet hang down
  double ahead(const Sighting& now) const { return now.ball.x - x_; }
  double man_y(int man) const { return man_offset(spec(), man) + slide_.position(); }

  const TableSpec* table_;
  Foot foot_;
  int team_, index_;
  double x_;
  Judgment judgment_;
  LaneView lanes_;
  HandAxis slide_, swing_;
  double goal_ = 0.0;        // target of the slide [m]
  double turned_ = 0.0;      // since the slide last reversed [s]
  double stroke_ago_ = 1e9;  // since a foot last swung at the ball [s]
  Act act_ = Act::watch;
  double since_ = 0.0;                // in this act [s]
  int man_ = 0;                       // who has the ball
  bool over_ = false;                 // his foot is behind the ball
  bool planted_ = false;              // the foot waits at the place where it will strike the ball
  bool feints_ = false;               // before this strike
  double pause_ = 0.0;                // before this strike [s]
  double noise_ = 0.0;                // of this strike's aim [m]
  double slope_ = 0.0, worth_ = 0.0;  // of the chosen lane
  double power_ = 1.0;
  double sends_ = 0.0;    // speed of the ball after this stroke [m/s]
  double through_ = 0.0;  // swing at which the stroke begins to brake [rad]
  vp::Vec3 sent_;
  double scoop_side_ = 0.0;    // 0: not chosen yet
  double scoop_rate_ = 0.0;    // [rad/s]
  double scoop_beside_ = 0.0;  // from the foot's edge to the ball's centre [m]
  bool struck_ = false;        // in this tick
  PassPlan pass_;              // the pass that the stroke plays, if any
  int receives_ = 0;           // ticks that remain to wait for a pass
  double receive_at_ = 0.0;    // slide [m]
};

}  // namespace foosball
