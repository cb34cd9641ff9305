// Eight rods with hands on them, and what passes under the sensors that look at them: the truth.
#pragma once

#include <random>

#include "controller.h"
#include "simulated_mount.h"

namespace cabinet_bench {

struct Pose {
  double slide = 0, angle = 0;  // [m], [rad]
};

enum class Mounting {
  square,  // no error of any kind: what the nominal calibration is for
  drawn,   // tilt and lean up to 4 degrees, 3 % of scale, 0.15 mm of eccentricity, 0.4 % of noise
};

class Table {
 public:
  Table(Mounting mounting, double counts_per_mm, std::uint32_t seed);

  // The hands move the rods in one millisecond.
  void move(const PerRod<Pose>& to);
  // The rods are taken for feet down after whole turns; nothing passes under a sensor.
  void forget_turns();

  const PerRod<Pose>& poses() const { return poses_; }
  const PerRod<Surface>& surfaces() const { return surfaces_; }

 private:
  static constexpr int kNoiseMs = 5;  // a sensor's error of scale lasts so long

  PerRod<cabinet_test::Mount> mounts_;
  PerRod<Pose> poses_{};
  PerRod<Surface> surfaces_{}, scale_{};
  std::mt19937 random_;
  int ms_ = 0;
};

}  // namespace cabinet_bench
