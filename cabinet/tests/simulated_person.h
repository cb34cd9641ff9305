// A simulated hand that follows the calibration guide, on a simulated rod.
#pragma once

#include <cmath>
#include <functional>

#include "cabinet/calibration_guide.h"
#include "simulated_mount.h"

namespace cabinet_test {

// Carries out the guide's requests as a person would, with small errors.
class Person {
  using Motion = cabinet::CalibrationRequest::Motion;

 public:
  Person(cabinet::CalibrationGuide& guide, SimulatedRod& rod, const cabinet::GuideOptions& options)
      : guide_(guide), rod_(rod), options_(options) {}

  double stop_error = 1e-4, angle_error = 0.026, eighth_error = 0.1;  // [m], [rad], [rad]
  int turns = 5;  // number of turns that it can count
  // Called before a step; true: it has replaced the step.
  std::function<bool(const cabinet::CalibrationRequest&)> instead;

  // Called with each increment, and at the key that starts the run, for other observers.
  std::function<void(const cabinet::CountIncrement&)> on_counts = [](const auto&) {};
  std::function<void()> on_start = [] {};

  // Runs until the guide is finished or makes no progress.
  void follow() {
    int tries = 0;
    for (int last = -1; !guide_.finished() && tries < 5; ++tries) {
      if (guide_.step() != last) tries = 0;
      last = guide_.step();
      const cabinet::CalibrationRequest asked = guide_.request();
      if (!instead || !instead(asked)) obey(asked);
    }
  }
  void move(double slide, double angle, double seconds) {
    const std::size_t before = rod_.increments.size();
    rod_.move(slide, angle, seconds);
    for (std::size_t i = before; i < rod_.increments.size(); ++i) {
      guide_.add(rod_.increments[i]);
      on_counts(rod_.increments[i]);
    }
  }
  // Waits until the guide has its next step, at most a second.
  void rest() {
    const int step = guide_.step();
    for (int i = 0; i < 20 && guide_.step() == step; ++i) move(rod_.slide, rod_.angle, 0.05);
  }
  double stop(bool away) {
    const double side = away ? options_.push_side : -options_.push_side;
    return side * (options_.reach + std::abs(rod_.draw(stop_error)));
  }
  // The nearest integer number of turns after a rotation by this many turns forward.
  double feet_down(double by = 0) {
    const double forward = options_.forward_sign * rod_.angle / (2 * M_PI);
    return options_.forward_sign * std::round(forward + by) * 2 * M_PI + rod_.draw(angle_error);
  }
  void obey(const cabinet::CalibrationRequest& asked) {
    const double pace = asked.slowly ? 3 : 0.5;
    const double eighth = options_.forward_sign * (M_PI / 4 + rod_.draw(eighth_error));
    switch (asked.motion) {
      case Motion::start:
        go(
            stop(false), [&] { return feet_down(); }, 1);
        guide_.mark();
        on_start();
        return;
      case Motion::to_and_fro:
        for (int i = 0; i < asked.times; ++i) {
          go(
              stop(true), [&] { return rod_.draw(0.1); }, 0.5);
          go(
              stop(false), [&] { return rod_.draw(0.1); }, 0.5);
        }
        return;
      case Motion::push:
      case Motion::pull:
        go(
            stop(asked.motion == Motion::push), [&] { return feet_down(); }, pace);
        return rest();
      case Motion::turn_and_push:
        move(rod_.slide, rod_.angle + eighth, 0.5);
        go(
            stop(true), [&] { return rod_.angle + rod_.draw(0.1); }, 0.6);
        return rest();
      case Motion::pull_as_turned:
        go(
            stop(false), [&] { return rod_.angle + rod_.draw(0.1); }, 0.6);
        return rest();
      case Motion::turn_feet_down:
        go(
            stop(false), [&] { return feet_down(0.5); }, 0.5);
        return rest();
      case Motion::turn_forward:
        go(
            stop(false), [&] { return feet_down(turns); }, 2.6);
        return rest();
      case Motion::turn_back:
        go(
            stop(false), [&] { return feet_down(-turns); }, 2.6);
        return rest();
    }
  }

 private:
  // Draws for the slide before drawing for the angle, with every compiler.
  template <class Angle>
  void go(double slide, const Angle& angle, double seconds) {
    move(slide, angle(), seconds);
  }

  cabinet::CalibrationGuide& guide_;
  SimulatedRod& rod_;
  cabinet::GuideOptions options_;
};

}  // namespace cabinet_test
