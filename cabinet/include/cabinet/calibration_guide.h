// Guides a person through the run of one rod that fit_rod() needs. The person has both hands on the
// rod, so the guide sets the marks itself. Each step asks for a motion to a known position and ends
// when the rod has moved there and is at rest.
//
// The guide starts without a known scale. The first strokes give the counts D of one stroke. Later
// motion along D is slide, and motion perpendicular to D is rotation. The sensor's pixels are
// square: the same distance of surface motion gives the same number of counts in both directions.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "cabinet/calibration_fit.h"

namespace cabinet {

struct GuideOptions {
  double reach = 0.1;              // [m] of the rod from its centre position to each stop
  double push_side = 1;            // sign of the slide at the stop away from the person
  double forward_sign = 1;         // sign of the angle when the feet swing forward
  double rod_radius = kRodRadius;  // [m]
  double rest_seconds = 0.5;       // time that a rod must rest at a position
};

// What the person is asked to do.
struct CalibrationRequest {
  enum class Motion {
    start,           // pull to the near stop, feet straight down, and confirm: mark()
    to_and_fro,      // push to the other stop and pull back, `times` times
    push,            // to the other stop, feet straight down
    pull,            // back, feet straight down
    turn_and_push,   // the feet forward by an eighth of a turn, and push
    pull_as_turned,  // back, the feet as they are
    turn_feet_down,  // at the stop, on until the feet are straight down
    turn_forward,    // at the stop, `times` full revolutions, to the feet straight down
    turn_back,
  };
  Motion motion = Motion::start;
  int times = 1;
  bool slowly = false;  // one stroke takes three seconds
};

// What prevents a step from ending.
enum class GuideAdvice {
  none,       // the rod moves, or has not moved yet
  further,    // at rest, but has not moved far enough
  turn_more,  // at rest at the stop, but not turned enough
  wrong_way,  // turned in the opposite direction
  feet_down,  // at rest, but the feet are not straight down
};

class CalibrationGuide {
 public:
  explicit CalibrationGuide(const GuideOptions& options = {});

  // Adds the counts since the previous frame. Does nothing before the start and once finished.
  void add(const CountIncrement& counts);
  // Declares that the rod is at the requested position and overrides the guide's own judgement.
  // Does nothing before a stroke was seen, except at the start.
  void mark();
  void back();  // repeats the previous step; its marks are dropped

  static int steps();
  int step() const { return step_; }  // 0 to steps()
  bool finished() const { return step_ == steps(); }
  CalibrationRequest request() const;  // precondition: not finished
  double progress() const;             // of the requested motion, 0 to 1
  double resting() const;              // elapsed fraction of the required rest time, 0 to 1
  GuideAdvice advice() const { return advice_; }
  const CalibrationRun& run() const { return run_; }

 private:
  struct Counts {
    double slide = 0, spin = 0;
  };
  struct Sample {
    Counts at;
    double time;  // [s]
  };

  void begin(int step);
  void put_marks();
  void learn_stroke();
  bool rests() const;
  bool is_here(const Counts& at) const;
  // Whether the rod is at the position of the step; otherwise what is missing.
  GuideAdvice missing() const;
  bool seen_stroke() const;
  double along(const Counts& from) const;  // [strokes] away from the person
  // [turns] forward; unsigned while the direction is unknown.
  double turned(const Counts& from) const;
  bool at_stop(double strokes) const;

  GuideOptions options_;
  CalibrationRun run_;
  std::vector<std::size_t> marks_before_;  // number of marks before each completed step
  std::deque<Sample> recent_;              // samples within the required rest time
  GuideAdvice advice_ = GuideAdvice::none;
  int step_ = 0;
  double time_ = 0, began_s_ = 0;  // [s]
  Counts at_, began_at_, stroke_;  // stroke_: D; at_ is 0 at the start
  int halves_ = 0;                 // half-strokes of to_and_fro
  bool away_ = false;              // to_and_fro: the rod is past the centre
  double turn_sign_ = 0;           // sign of a forward turn perpendicular to D; 0: unknown yet
};

}  // namespace cabinet
