// A model of a sensor on a rod, from mechanics and optics, and of a person's hand on that rod. It
// is independent of the code under test: it maps displacements of the surface through the lens step
// by step.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "cabinet/calibration_fit.h"

namespace cabinet_test {

struct Mount {
  double counts_per_mm = 8;
  double rod_radius = 0.008;  // [m]
  double tilt = 0;            // [rad] rotation about the line of sight
  double lean = 0;            // [rad] angle of the line of sight to the surface normal
  double lean_towards = 0;    // [rad] direction of the lean, from along the rod
  double scale = 1;           // factor of the counts
  double eccentricity = 0;    // [m] offset of the rod's surface from its bearings
  double towards = 0;  // [rad] angle of the rod at which its surface is closest to the sensor
  double optical_distance = 0.005;  // [m] from lens to surface; magnification is inverse to it
  double dead_band = 0;             // [counts / s]
  double noise = 0;                 // relative, per report
  double loss = 0;                  // probability that a report is lost
  int report = 5;                   // [ms] report period

  // The index mark: a magnet with this angular width while the rod is at `slide`, narrower beside
  // it, and zero beyond `reach`. Width 0: no mark.
  struct Mark {
    double angle = 0, width = 0;     // [rad]
    double hysteresis = 0;           // [rad] delay of switching off relative to switching on
    double slide = 0, reach = 4e-3;  // [m]
  };
  Mark mark{};
};

// Whether the switch is on at this pose of the rod.
inline bool switched_on(const Mount::Mark& mark, bool was_on, double slide, double angle) {
  const double beside = std::abs(slide - mark.slide) / mark.reach;
  const double half = beside < 1 ? 0.5 * mark.width * std::sqrt(1 - beside * beside) : 0;
  const double switches = half + (was_on ? 0.5 : -0.5) * mark.hysteresis;
  return half > 0 && std::abs(std::remainder(angle - mark.angle, 2 * M_PI)) < switches;
}

struct SurfaceCounts {
  double slide, spin;
};

// Counts for a small motion of the rod, mapped through the lens, exact in the middle of the motion.
inline SurfaceCounts surface_counts(const Mount& mount, double slide, double angle, double to_slide,
                                    double to_angle) {
  const double middle = 0.5 * (angle + to_angle) - mount.towards;
  const double closer = mount.eccentricity * std::cos(middle);
  double x = to_slide - slide;
  double y = (mount.rod_radius + closer) * (to_angle - angle);
  const double lx = std::cos(mount.lean_towards), ly = std::sin(mount.lean_towards);
  const double foreshortened = (1 - std::cos(mount.lean)) * (x * lx + y * ly);
  x -= foreshortened * lx;
  y -= foreshortened * ly;
  const double counts = mount.counts_per_mm * 1e3 * mount.scale * mount.optical_distance /
                        (mount.optical_distance - closer);
  const double c = std::cos(mount.tilt), s = std::sin(mount.tilt);
  return {counts * (c * x + s * y), counts * (c * y - s * x)};
}

// The true pose, and the sensor's counts.
class SimulatedRod {
 public:
  static constexpr double kStep = 1e-3;  // [s]

  SimulatedRod(const Mount& mount, std::uint32_t seed) : mount_(mount), random_(seed) {
    for (double& part : left_) part = between(0, 1);
  }
  virtual ~SimulatedRod() = default;
  SimulatedRod(const SimulatedRod&) = delete;
  SimulatedRod& operator=(const SimulatedRod&) = delete;

  double slide = 0, angle = 0;
  bool under = false;  // the switch is on
  std::vector<cabinet::CountIncrement> increments;

  virtual void step(double to_slide, double to_angle) {
    const SurfaceCounts passed = surface_counts(mount_, slide, angle, to_slide, to_angle);
    seen_[0] += passed.slide;
    seen_[1] += passed.spin;
    slide = to_slide;
    angle = to_angle;
    under = switched_on(mount_.mark, under, slide, angle);
    if (++steps_ % mount_.report == 0) report();
  }

  // Moves at the speed of a hand that starts and ends at rest, for this time.
  void move(double to_slide, double to_angle, double seconds) {
    const double from_slide = slide, from_angle = angle;
    const int n = std::max(1, static_cast<int>(std::lround(seconds / kStep)));
    for (int i = 1; i <= n; ++i) {
      const double t = static_cast<double>(i) / n, ease = t * t * (3 - 2 * t);
      step(std::lerp(from_slide, to_slide, ease), std::lerp(from_angle, to_angle, ease));
    }
  }
  void rest(double seconds) { move(slide, angle, seconds); }

  double draw(double deviation) { return std::normal_distribution<double>(0, deviation)(random_); }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

 private:
  void report() {
    std::int16_t told[2];
    const bool lost = mount_.loss > 0 && between(0, 1) < mount_.loss;
    for (int axis = 0; axis < 2; ++axis) {
      double c = seen_[axis] * (mount_.noise > 0 ? 1 + draw(mount_.noise) : 1.0);
      c = std::copysign(std::max(std::abs(c) - mount_.dead_band * kStep * mount_.report, 0.0), c);
      if (lost) c = 0;
      left_[axis] += c;
      told[axis] = static_cast<std::int16_t>(std::floor(left_[axis]));
      left_[axis] -= told[axis];
      seen_[axis] = 0;
    }
    increments.push_back({told[0], told[1], static_cast<float>(kStep * mount_.report), under});
  }

  Mount mount_;
  std::mt19937 random_;
  // [counts] since the last report, and left before it.
  double seen_[2] = {0, 0}, left_[2] = {0, 0};
  int steps_ = 0;
};

// The run described in docs/cabinet.md, by a hand that marks to 0.1 mm and 1.5 degrees: strokes to
// both stops with the feet down; strokes to and fro at each eighth of a turn; turns at a stop, in
// both directions.
struct RunDesc {
  double reach = 0.1;  // [m] of the rod from its centre position to each stop
  double stop_error = 1e-4, angle_error = 0.026;
  int eighths = 8, turns = 5;
};

inline cabinet::CalibrationRun calibration_run(SimulatedRod& rod, const RunDesc& desc = {}) {
  using Kind = cabinet::CalibrationMark::Kind;
  cabinet::CalibrationRun run;
  const auto at_stop = [&](double side) {
    run.marks.push_back({rod.increments.size(), Kind::slide, side * desc.reach});
  };
  const auto feet_down = [&](int turns) {
    run.marks.push_back({rod.increments.size(), Kind::angle, turns * 2 * M_PI});
  };
  const auto stop = [&](double side) {
    return side * (desc.reach + std::abs(rod.draw(desc.stop_error)));
  };
  const auto down = [&](int turns) { return turns * 2 * M_PI + rod.draw(desc.angle_error); };

  rod.move(stop(-1), rod.draw(desc.angle_error), 1);
  rod.rest(0.3);
  at_stop(-1);
  feet_down(0);
  for (int stroke = 0; stroke < 8; ++stroke) {
    const double side = stroke % 2 == 0 ? 1 : -1;
    rod.move(stop(side), down(0), stroke % 4 < 2 ? 0.5 : 3);  // fast, then slowly
    rod.rest(0.3);
    at_stop(side);
    feet_down(0);
  }
  for (int eighth = 1; eighth < desc.eighths; ++eighth) {
    rod.move(rod.slide, eighth * M_PI / 4 + rod.draw(0.1), 0.5);
    for (const double side : {1.0, -1.0}) {
      rod.move(stop(side), rod.angle + rod.draw(0.1), rod.between(0.3, 1.5));
      rod.rest(0.2);
      at_stop(side);
    }
  }
  int turns = desc.eighths > 4 ? 1 : 0;
  rod.move(stop(-1), down(turns), 0.5);
  rod.rest(0.3);
  at_stop(-1);
  feet_down(turns);
  for (const int by : {desc.turns, -desc.turns, desc.turns, -desc.turns}) {
    turns += by;
    rod.move(stop(-1), down(turns), 0.5 * std::abs(by) + 0.1);
    rod.rest(0.3);
    at_stop(-1);
    feet_down(turns);
  }
  run.increments = rod.increments;
  return run;
}

// A typical mount: docs/cabinet.md, "Calibrate".
inline Mount drawn_mount(std::mt19937& random, double counts_per_mm) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Mount mount;
  mount.counts_per_mm = counts_per_mm;
  mount.tilt = between(-4, 4) * M_PI / 180;
  mount.lean = between(0, 4) * M_PI / 180;
  mount.lean_towards = between(0, 2 * M_PI);
  mount.scale = between(0.97, 1.03);
  mount.eccentricity = 0.15e-3;
  mount.towards = between(0, 2 * M_PI);
  mount.optical_distance = between(0.004, 0.006);
  mount.noise = 0.004;
  return mount;
}

// Near a stop, at any angle, with a hysteresis of up to 2 degrees.
inline Mount::Mark drawn_mark(std::mt19937& random, double near_stop) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Mount::Mark mark;
  mark.angle = between(-M_PI, M_PI);
  mark.width = between(18, 26) * M_PI / 180;
  mark.hysteresis = between(0.5, 2) * M_PI / 180;
  mark.slide = near_stop + between(-0.5e-3, 0.5e-3);
  return mark;
}

struct PlayErrors {
  double slide = 0, angle = 0;  // [m], [rad] rms
};

// A hand that plays for this long, starting at rest in the centre with the feet down.
inline PlayErrors play(const Mount& mount, const cabinet::RodCalibration& calibration,
                       double seconds, std::uint32_t seed) {
  SimulatedRod rod(mount, seed);
  cabinet::RodIntegrator integrator(calibration);
  double slide = 0, angle = 0, squares[2] = {0, 0};
  std::size_t read = 0, samples = 0;
  while (static_cast<double>(rod.increments.size()) * SimulatedRod::kStep * mount.report <
         seconds) {
    // In separate statements, so that every compiler draws in the same order.
    const double to_slide = rod.between(-0.1, 0.1), to_angle = rod.between(-1.5, 1.5);
    rod.move(to_slide, to_angle, rod.between(0.08, 0.4));
    for (; read < rod.increments.size(); ++read) {
      const cabinet::CountIncrement& c = rod.increments[read];
      const auto moved = integrator.add(c.slide, c.spin, static_cast<double>(c.seconds), angle);
      slide += moved.slide;
      angle += moved.angle;
    }
    squares[0] += (slide - rod.slide) * (slide - rod.slide);
    squares[1] += (angle - rod.angle) * (angle - rod.angle);
    ++samples;
  }
  const auto n = static_cast<double>(samples);
  return {std::sqrt(squares[0] / n), std::sqrt(squares[1] / n)};
}

}  // namespace cabinet_test
