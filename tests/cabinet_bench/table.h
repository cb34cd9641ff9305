// Eight rods with hands on them, and the motion of their surfaces under the sensors: the truth.
#pragma once

#include <random>

#include "controller.h"
#include "simulated_mount.h"

namespace cabinet_bench {

struct Pose {
  double slide = 0, angle = 0;  // [m], [rad]
};

enum class Mounting {
  square,  // no errors: what the nominal calibration is for
  drawn,   // tilt and lean up to 4 degrees, 3 % of scale, 0.15 mm of eccentricity, 0.4 % of noise
};

enum class Marks {
  none,
  drawn,  // one magnet per rod, up to an eighth of a turn from the feet, with a switch at the near
          // stop
};

class Table {
 public:
  Table(Mounting mounting, Marks marks, double counts_per_mm, std::uint32_t seed);

  // The hands move the rods for one millisecond.
  void move(const PerRod<Pose>& to);
  // Runs that millisecond on the controller; its switches have their state at its midpoint.
  void pass(Controller& controller) const;
  // Takes the rods as feet down after whole turns; no surface moves under a sensor.
  void forget_turns();

  const PerRod<Pose>& poses() const { return poses_; }
  const PerRod<Surface>& surfaces() const { return surfaces_; }
  bool has_marks() const { return marks_ == Marks::drawn; }
  bool under(std::size_t rod) const { return (under_ >> rod & 1) != 0; }
  // Towards the person, along the rod.
  static double near_stop(std::size_t rod);

 private:
  static constexpr int kNoiseMs = 5;  // duration of one sample of a sensor's scale error

  void draw_marks(std::uint32_t seed);

  Marks marks_;
  PerRod<cabinet_test::Mount> mounts_;
  PerRod<Pose> poses_{};
  PerRod<Surface> surfaces_{}, scale_{};
  std::mt19937 random_;
  std::uint8_t under_ = 0;
  int ms_ = 0;
};

}  // namespace cabinet_bench
