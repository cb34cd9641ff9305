#include "cabinet/calibration_guide.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cabinet {
namespace {

using Motion = CalibrationRequest::Motion;
using Kind = CalibrationMark::Kind;

constexpr int kStrokesToAndFro = 3, kStrokes = 8, kEighths = 7, kTurns = 5;

// Min counts of a stroke: one per millimetre, for rods with a reach of 100 mm.
constexpr double kMinStroke = 100;
// Tolerance of a stop's position, as a fraction of a stroke, around the ends of the strokes to and
// fro. For a rod that is 0.15 mm eccentric, a stroke has up to 4 % more or fewer counts, depending
// on its angle.
constexpr double kAtStop = 0.12;
// Strokes to and fro restart when one is longer by this factor.
constexpr double kLonger = 1.1;
constexpr double kMinTurn = 0.06;       // [turns] half of the requested eighth
constexpr double kNearlyDown = 0.08;    // [turns]
constexpr double kReadSeconds = 2.0;    // time to read a request
constexpr double kMaxOffDown = 0.3;     // [turns] from straight down, by scales not yet fitted
constexpr double kRestCounts = 2;       // a sensor at rest may flicker
constexpr double kRestStrokes = 0.002;  // 0.4 mm

struct Script {
  std::array<CalibrationRequest, 2 + kStrokes + 2 * kEighths + 1 + 4> steps;
  constexpr Script() : steps{} {
    std::size_t at = 0;
    const auto ask = [&](Motion motion, int times = 1, bool slowly = false) {
      steps[at++] = {motion, times, slowly};
    };
    ask(Motion::start);
    ask(Motion::to_and_fro, kStrokesToAndFro);
    for (int i = 0; i < kStrokes; ++i) ask(i % 2 == 0 ? Motion::push : Motion::pull, 1, i % 4 >= 2);
    for (int i = 0; i < kEighths; ++i) {
      ask(Motion::turn_and_push);
      ask(Motion::pull_as_turned);
    }
    ask(Motion::turn_feet_down);
    for (int i = 0; i < 2; ++i) {
      ask(Motion::turn_forward, kTurns);
      ask(Motion::turn_back, kTurns);
    }
  }
};
constexpr Script kScript;

bool ends_away(Motion motion) {
  return motion == Motion::push || motion == Motion::turn_and_push;
}
bool ends_feet_down(Motion motion) {
  return motion != Motion::to_and_fro && motion != Motion::turn_and_push &&
         motion != Motion::pull_as_turned;
}

}  // namespace

CalibrationGuide::CalibrationGuide(const GuideOptions& options) : options_(options) {}

int CalibrationGuide::steps() {
  return static_cast<int>(kScript.steps.size());
}

CalibrationRequest CalibrationGuide::request() const {
  return kScript.steps[static_cast<std::size_t>(step_)];
}

bool CalibrationGuide::seen_stroke() const {
  return std::hypot(stroke_.slide, stroke_.spin) >= kMinStroke;
}

double CalibrationGuide::along(const Counts& from) const {
  const double squared = stroke_.slide * stroke_.slide + stroke_.spin * stroke_.spin;
  if (squared == 0) return 0;
  return ((at_.slide - from.slide) * stroke_.slide + (at_.spin - from.spin) * stroke_.spin) /
         squared;
}

double CalibrationGuide::turned(const Counts& from) const {
  const double squared = stroke_.slide * stroke_.slide + stroke_.spin * stroke_.spin;
  if (squared == 0) return 0;
  const double strokes =
      ((at_.spin - from.spin) * stroke_.slide - (at_.slide - from.slide) * stroke_.spin) / squared;
  const double turns = strokes * options_.reach / (M_PI * options_.rod_radius);
  return turn_sign_ == 0 ? std::abs(turns) : turn_sign_ * turns;
}

bool CalibrationGuide::at_stop(double strokes) const {
  return std::abs(along({}) - strokes) < kAtStop;
}

bool CalibrationGuide::rests() const {
  if (recent_.empty() || recent_.back().time - recent_.front().time < options_.rest_seconds)
    return false;
  return std::ranges::all_of(recent_, [&](const Sample& s) { return is_here(s.at); });
}

bool CalibrationGuide::is_here(const Counts& at) const {
  const double max = std::max(kRestCounts, kRestStrokes * std::hypot(stroke_.slide, stroke_.spin));
  return std::hypot(at.slide - at_.slide, at.spin - at_.spin) <= max;
}

double CalibrationGuide::resting() const {
  if (finished() || step_ < 2 || missing() != GuideAdvice::none) return 0;
  double since = time_;
  for (auto s = recent_.rbegin(); s != recent_.rend() && is_here(s->at); ++s) since = s->time;
  return std::clamp((time_ - since) / options_.rest_seconds, 0.0, 1.0);
}

double CalibrationGuide::progress() const {
  const CalibrationRequest asked = request();
  const auto share = [](double of) { return std::clamp(of, 0.0, 1.0); };
  switch (asked.motion) {
    case Motion::start:
      return 0;
    case Motion::to_and_fro:
      return share(0.5 * halves_ / asked.times);
    case Motion::push:
    case Motion::turn_and_push:
      return share(along({}));
    case Motion::pull:
    case Motion::pull_as_turned:
      return share(1 - along({}));
    case Motion::turn_feet_down:
      return share(turned(began_at_) / 0.125);
    case Motion::turn_forward:
      return share(turned(began_at_) / asked.times);
    case Motion::turn_back:
      return share(-turned(began_at_) / asked.times);
  }
  return 0;
}

GuideAdvice CalibrationGuide::missing() const {
  const CalibrationRequest asked = request();
  const double turns = turned(began_at_), all = turned({});
  if (!at_stop(ends_away(asked.motion) ? 1 : 0)) return GuideAdvice::further;
  switch (asked.motion) {
    case Motion::turn_and_push:
      if (turns < -kMinTurn) return GuideAdvice::wrong_way;
      return turns < kMinTurn ? GuideAdvice::turn_more : GuideAdvice::none;
    case Motion::turn_feet_down:
      if (turns < -kMinTurn) return GuideAdvice::wrong_way;
      // If the previous eighths were larger than asked, the feet may already hang down. The step
      // ends if the person has had time to read the request and left them so.
      if (turns < kMinTurn && (std::abs(all - 1) > kNearlyDown || time_ - began_s_ < kReadSeconds))
        return GuideAdvice::turn_more;
      break;
    case Motion::turn_forward:
    case Motion::turn_back: {
      const double way = asked.motion == Motion::turn_forward ? turns : -turns;
      if (way < -0.5) return GuideAdvice::wrong_way;
      if (way < 0.5 * asked.times) return GuideAdvice::turn_more;
      break;
    }
    default:
      return GuideAdvice::none;
  }
  return std::abs(all - std::round(all)) > kMaxOffDown ? GuideAdvice::feet_down : GuideAdvice::none;
}

void CalibrationGuide::learn_stroke() {
  const double here = std::hypot(at_.slide, at_.spin);
  const double longest = std::hypot(stroke_.slide, stroke_.spin);
  if (here > longest) {
    if (here > kLonger * longest) halves_ = 0;
    stroke_ = at_;
  }
  if (!seen_stroke()) return;
  const double strokes = along({});
  if (away_ ? strokes > 0.25 : strokes < 0.75) return;
  away_ = !away_;
  ++halves_;
}

void CalibrationGuide::add(const CountIncrement& counts) {
  if (step_ == 0 || finished()) return;
  run_.increments.push_back(counts);
  at_.slide += counts.slide;
  at_.spin += counts.spin;
  time_ += static_cast<double>(counts.seconds);
  recent_.push_back({at_, time_});
  while (recent_.size() > 2 && recent_[1].time <= time_ - options_.rest_seconds)
    recent_.pop_front();
  const CalibrationRequest asked = request();
  if (asked.motion == Motion::to_and_fro) {
    learn_stroke();
    if (halves_ >= 2 * asked.times && at_stop(0)) put_marks();
    return;
  }
  if (!rests()) {
    advice_ = GuideAdvice::none;
    return;
  }
  // A rod that was not moved since the request gets no advice.
  const bool moved =
      std::abs(along(began_at_)) > 2 * kAtStop || std::abs(turned(began_at_)) > kMinTurn;
  advice_ = missing();
  if (advice_ == GuideAdvice::none) return put_marks();
  if (!moved) advice_ = GuideAdvice::none;
}

void CalibrationGuide::mark() {
  if (finished() || (step_ > 0 && !seen_stroke())) return;
  put_marks();
}

void CalibrationGuide::put_marks() {
  const CalibrationRequest asked = request();
  marks_before_.push_back(run_.marks.size());
  if (asked.motion == Motion::to_and_fro) return begin(step_ + 1);
  if (asked.motion == Motion::turn_and_push && turn_sign_ == 0) {
    turn_sign_ = 1;
    if (turned(began_at_) < 0) turn_sign_ = -1;
  }
  const double side = ends_away(asked.motion) ? options_.push_side : -options_.push_side;
  const std::size_t at = run_.increments.size();
  run_.marks.push_back({at, Kind::slide, side * options_.reach});
  if (ends_feet_down(asked.motion)) {
    const double turns = turn_sign_ == 0 ? 0 : std::round(turned({}));
    run_.marks.push_back({at, Kind::angle, options_.forward_sign * turns * 2 * M_PI});
  }
  begin(step_ + 1);
}

void CalibrationGuide::begin(int step) {
  step_ = step;
  began_at_ = at_;
  began_s_ = time_;
  recent_.clear();
  advice_ = GuideAdvice::none;
}

void CalibrationGuide::back() {
  if (step_ <= 2) {
    *this = CalibrationGuide(options_);
    return;
  }
  run_.marks.resize(marks_before_.back());
  marks_before_.pop_back();
  begin(step_ - 1);
}

}  // namespace cabinet
