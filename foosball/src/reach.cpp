#include "foosball/reach.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

double squared(double x) {
  return x * x;
}

}  // namespace

bool can_reach(const TableSpec& table, int rod, const CharacterBody& c, const vp::Vec3& ball) {
  const RodSpec& spec = table.rods[rod];
  const double dx = ball.x - spec.x, dz = ball.z - table.rod_height;
  const double r = table.ball_radius;
  const double foot = std::sqrt(squared(c.foot_reach) + squared(0.5 * c.foot_depth));
  const double in_plane = dx * dx + dz * dz;
  if (in_plane > squared(foot + r)) return false;
  // The nearest man, at the slide that brings him closest to the ball.
  const double beside = std::fabs(ball.y - man_offset(spec, man_nearest(spec, ball.y)));
  const double clearance = std::max(0.0, beside - spec.slide_limit - 0.5 * c.foot_width);
  if (clearance >= r) return false;
  return in_plane <= squared(foot + std::sqrt(r * r - clearance * clearance));
}

std::uint8_t rods_in_reach(const TableSpec& table, const TeamBodies& bodies, const vp::Vec3& ball) {
  std::uint8_t rods = 0;
  for (int rod = 0; rod < kRods; ++rod) {
    const bool reaches = can_reach(table, rod, bodies[table.rods[rod].team], ball);
    rods |= static_cast<std::uint8_t>((reaches ? 1u : 0u) << rod);
  }
  return rods;
}

}  // namespace foosball
