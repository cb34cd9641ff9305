// One axis of a rod with mass m, driven by f = k (p - q) + d (u - v) with |f| <= F, integrated
// implicitly over h (Catto, "Soft constraints", 2011):
//   gain = h (h k + d),  target = h (k (p - q) + d u) / gain,  softness = 1 / gain
//   impulse = clamp((target - v) / (1 / m + softness), +-h F),  v+ = v + impulse / m
//   stops:   v+ clamped so that q + h v+ stays within them,     q+ = q + h v+
#include "foosball/rod_motion.h"

#include <algorithm>
#include <cmath>

#include "vphysics/lie.h"

namespace foosball {
namespace {

// A drive that is critically damped for the inertia, towards the hand's position at the end of the
// tick. It limits the displacement so that the drive's terminal speed v, at which stiffness *
// displacement + damping * (rate - v) = 0, stays within max_rate.
AxisDrive drive_towards(double target, double target_rate, double now, double inertia,
                        double max_force, double max_rate, double frequency) {
  const double stiffness = inertia * frequency * frequency;
  const double damping = 2.0 * inertia * frequency;
  const double rate = std::clamp(target_rate, -max_rate, max_rate);
  const double time = damping / stiffness;
  const double goal = std::clamp(target + rate * kTick, now - (max_rate + rate) * time,
                                 now + (max_rate - rate) * time);
  return {goal, rate, stiffness, damping, max_force};
}

double step_rate(const AxisDrive& drive, double mass, double position, double rate) {
  constexpr double h = kTick;
  const double gain = h * (h * drive.stiffness + drive.damping);
  const double target =
      h * (drive.stiffness * (drive.position - position) + drive.damping * drive.velocity) / gain;
  const double max = h * drive.max_force;
  const double impulse = std::clamp((target - rate) / (1.0 / mass + 1.0 / gain), -max, max);
  return rate + impulse / mass;
}

}  // namespace

HandLimits hand_limits(const CharacterBody& c, const Tuning& tuning) {
  return {std::min(c.slide_force, tuning.hand_force), std::min(c.turn_torque, tuning.hand_torque),
          tuning.hand_frequency, std::min(c.slide_speed, tuning.slide_rate),
          std::min(c.turn_speed, tuning.turn_rate)};
}

AxisDrive slide_drive(const RodSpec& rod, const RodInertia& inertia, const RodState& now,
                      const RodTarget& target) {
  const double slide = std::clamp(target.slide, -rod.slide_limit, rod.slide_limit);
  const bool against_stop = slide != target.slide && slide * target.slide_rate > 0.0;
  const HandLimits& limits = inertia.limits;
  return drive_towards(slide, against_stop ? 0.0 : target.slide_rate, now.slide, inertia.slide,
                       limits.force, limits.slide_rate, limits.frequency);
}

AxisDrive angle_drive(const RodInertia& inertia, double angle, const RodTarget& target) {
  const HandLimits& limits = inertia.limits;
  return drive_towards(target.angle, target.angle_rate, angle, inertia.turn, limits.torque,
                       limits.angle_rate, limits.frequency);
}

double turns_ahead(double angle, double hand_angle) {
  constexpr double kTurn = 2.0 * vp::kPi;
  const double ahead = angle - hand_angle;
  return std::fabs(ahead) <= vp::kPi ? 0.0 : kTurn * std::nearbyint(ahead / kTurn);
}

AxisDrive man_drive(const RodInertia& inertia, double angle, double hand_angle,
                    const RodTarget& target) {
  RodTarget his = target;
  his.angle += turns_ahead(angle, hand_angle);
  return angle_drive(inertia, angle, his);
}

RodInertia rod_inertia(const TableSpec& table, const RodSpec& rod, const CharacterBody& c,
                       const Tuning& tuning) {
  const double men = rod.men * c.mass;
  // The mass of a man is in torso and foot: his radius of gyration is 60 % of the foot's reach.
  const double gyration = 0.6 * c.foot_reach;
  const double man_axial = c.mass * gyration * gyration;
  const double mass = table.rod_mass + men;
  const double axial =
      0.5 * table.rod_mass * table.rod_radius * table.rod_radius + rod.men * man_axial;
  return {.limits = hand_limits(c, tuning),
          .rod_and_men = mass,
          .slide = mass + tuning.hand_mass,
          .axial = axial,
          .turn = axial + tuning.hand_inertia,
          .man = c.mass,
          .man_axial = man_axial};
}

RodState step_rod(const RodSpec& rod, const RodInertia& inertia, const RodState& now,
                  const RodTarget& target) {
  const AxisDrive slide = slide_drive(rod, inertia, now, target);
  const AxisDrive angle = angle_drive(inertia, now.angle, target);
  RodState next;
  next.slide_rate =
      std::clamp(step_rate(slide, inertia.slide, now.slide, now.slide_rate),
                 (-rod.slide_limit - now.slide) / kTick, (rod.slide_limit - now.slide) / kTick);
  next.angle_rate = step_rate(angle, inertia.turn, now.angle, now.angle_rate);
  next.slide = now.slide + kTick * next.slide_rate;
  next.angle = now.angle + kTick * next.angle_rate;
  return next;
}

}  // namespace foosball
