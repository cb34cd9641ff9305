// Leads a person through the run of one rod that fit_rod() wants, and marks the places by itself:
// both hands are on the rod. Each step asks for a motion to a place that is known, and is over when
// the rod has gone there and rests.
//
// It knows no scale beforehand. The first strokes show which counts D are one; from then on a
// motion is judged along D, which slides, and across it, which turns: a sensor's pixels are square,
// so that a turn of the surface by so many metres is as many counts as a slide.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "cabinet/calibration_fit.h"

namespace cabinet {

struct GuideOptions {
  double reach = 0.1;              // [m] of the rod from the middle to each stop
  double push_side = 1;            // sign of the slide at the stop away from the person
  double forward_sign = 1;         // of the angle when the feet swing forward
  double rod_radius = kRodRadius;  // [m]
  double rest_seconds = 0.5;       // so long a rod has to rest at a place
};

// What a person is asked to do.
struct CalibrationRequest {
  enum class Motion {
    start,           // pull to the stop towards the person, feet straight down, and say so: mark()
    to_and_fro,      // push to the other stop and pull back, `times` times
    push,            // to the other stop, feet straight down
    pull,            // back, feet straight down
    turn_and_push,   // the feet forward by an eighth of a turn, and push
    pull_as_turned,  // back, the feet as they are
    turn_feet_down,  // at the stop, on to the feet straight down
    turn_forward,    // at the stop, `times` whole turns, to the feet straight down
    turn_back,
  };
  Motion motion = Motion::start;
  int times = 1;
  bool slowly = false;  // a stroke of three seconds
};

// What keeps a step from being over.
enum class GuideAdvice {
  none,       // the rod is on its way, or was not moved yet
  further,    // it rests, and has not gone far enough
  turn_more,  // it rests at the stop, and was not turned enough
  wrong_way,  // it was turned the other way
  feet_down,  // it rests, and its feet are not straight down
};

class CalibrationGuide {
 public:
  explicit CalibrationGuide(const GuideOptions& options = {});

  // Those since the frame before. Nothing before the start and once finished.
  void add(const CountIncrement& counts);
  // The rod is where the step asks it to be, whatever the guide makes of it. Nothing before a
  // stroke was seen, but at the start.
  void mark();
  void back();  // asks for the step before once more; its marks are dropped

  static int steps();
  int step() const { return step_; }  // 0 to steps()
  bool finished() const { return step_ == steps(); }
  CalibrationRequest request() const;  // precondition: not finished
  double progress() const;             // of the motion that is asked for, 0 to 1
  double resting() const;              // of the time that the rod has to rest, 0 to 1
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
  // Whether the rod is where the step wants it; what is missing otherwise.
  GuideAdvice missing() const;
  bool seen_stroke() const;
  double along(const Counts& from) const;   // [strokes] away from the person
  double turned(const Counts& from) const;  // [turns] forward; either way while that is not known
  bool at_stop(double strokes) const;

  GuideOptions options_;
  CalibrationRun run_;
  std::vector<std::size_t> marks_before_;  // of each step that is over, how many there were
  std::deque<Sample> recent_;              // of the time that the rod has to rest
  GuideAdvice advice_ = GuideAdvice::none;
  int step_ = 0;
  double time_ = 0, began_s_ = 0;  // [s]
  Counts at_, began_at_, stroke_;  // stroke_: D; at_ is 0 at the start
  int halves_ = 0;                 // of the strokes to and fro
  bool away_ = false;              // beyond the middle, of these
  double turn_sign_ = 0;           // of a forward turn across D; 0: not known yet
};

}  // namespace cabinet
