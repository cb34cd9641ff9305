// Random shots on the real table, judged by a truth that knows nothing of the engine: the chord of
// the ball's centre over each tick, seen from every man's boxes, and the table's inner bounds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "../src/random.h"
#include "../src/table_world.h"

namespace foosball {

struct ShotsReport {
  int shots = 0;
  long ticks = 0;
  long man_hits = 0, wall_hits = 0;
  long over_the_wall = 0;  // left over a wall: allowed
  long through_a_man = 0;  // never allowed
  long outside = 0;        // never allowed
  long held_steps = 0;     // the engine met its impact limit
  double held_seconds = 0.0;
  double deepest_in_man = 0.0;   // [m]
  double deepest_in_wall = 0.0;  // [m], field included
};

class ShotGallery {
 public:
  ShotGallery(Layout layout, std::uint64_t seed)
      : world_(layout, {static_cast<int>(seed % 3), static_cast<int>((seed / 3) % 3)}),
        characters_{static_cast<int>(seed % 3), static_cast<int>((seed / 3) % 3)},
        random_(seed) {}

  void shoot(int shots) {
    for (int i = 0; i < shots; ++i) shot();
  }
  const ShotsReport& report() const { return report_; }

 private:
  static constexpr int kTicks = 16;       // 20 m/s: 0.32 m, two rods and a wall away
  static constexpr double kSpeed = 20.0;  // [m/s]
  static constexpr double kCore = 0.6;    // of a box: no chord may cross what is left of it

  const TableSpec& table() const { return world_.table(); }

  // Half of the shots with rods at rest, half with them turning and sliding.
  void set_rods() {
    const bool moving = random_.unit() < 0.5;
    for (int rod = 0; rod < kRods; ++rod) {
      const double limit = table().rods[rod].slide_limit;
      motion_[rod] = {random_.between(-limit, limit), random_.between(-vp::kPi, vp::kPi),
                      moving ? random_.between(-3.0, 3.0) : 0.0,
                      moving ? random_.between(-150.0, 150.0) : 0.0, true};
      const RodTarget& m = motion_[rod];
      world_.set_rod(rod, {m.slide, m.angle, m.slide_rate, m.angle_rate});
    }
  }

  void set_ball() {
    const double r = table().ball_radius;
    vp::Vec3 place;
    do {
      place = {random_.between(-0.5 * table().length + r, 0.5 * table().length - r),
               random_.between(-0.5 * table().width + r, 0.5 * table().width - r),
               random_.unit() < 0.7 ? r + 0.011 : random_.between(r + 0.011, 0.09)};
    } while (!world_.free_for_ball(place));
    // Mostly along the field; a quarter at any slope.
    vp::Vec3 way{random_.between(-1.0, 1.0), random_.between(-1.0, 1.0), 0.0};
    way.z = random_.unit() < 0.25 ? random_.between(-1.0, 0.5) : random_.between(-0.05, 0.05);
    const double length = vp::norm(way);
    world_.set_ball(place, (kSpeed / std::max(length, 0.01)) * way);
  }

  void shot() {
    set_rods();
    set_ball();
    ++report_.shots;
    for (int tick = 0; tick < kTicks; ++tick) {
      for (int rod = 0; rod < kRods; ++rod) {
        motion_[rod].slide += motion_[rod].slide_rate * kTick;
        motion_[rod].angle += motion_[rod].angle_rate * kTick;
        world_.drive(rod, motion_[rod]);
        before_[rod] = world_.rod(rod);
      }
      const vp::Vec3 from = world_.ball().pose.position();
      world_.step();
      ++report_.ticks;
      for (const BallContact& contact : world_.contacts()) {
        if (contact.kind != vp::ContactEvent::Kind::hit) continue;
        ++(contact.other.what == Tag::What::man ? report_.man_hits : report_.wall_hits);
      }
      report_.held_steps += world_.status().impact_limit ? 1 : 0;
      report_.held_seconds += world_.status().time_held;
      const vp::Vec3 to = world_.ball().pose.position();
      judge_men(from, to);
      if (!judge_table(to)) break;
    }
  }

  void judge_men(const vp::Vec3& from, const vp::Vec3& to) {
    for (int rod = 0; rod < kRods; ++rod) {
      if (std::fabs(to.x - table().rods[rod].x) > 0.15) continue;
      const RodSpec& spec = table().rods[rod];
      for (int man = 0; man < spec.men; ++man) {
        const vp::SE3 T_before = man_pose(table(), rod, man, before_[rod]);
        const vp::SE3 T_after = man_pose(table(), rod, man, world_.rod(rod));
        if (std::fabs(to.y - T_after.position().y) > 0.1) continue;
        for (const ManBox& box : man_boxes(characters_[spec.team])) {
          const vp::Vec3 a = inverse_times(T_before, from) - box.centre;
          const vp::Vec3 b = inverse_times(T_after, to) - box.centre;
          if (crosses(a, b, kCore * box.half_extents)) ++report_.through_a_man;
          const double depth = table().ball_radius - distance(b, box.half_extents);
          report_.deepest_in_man = std::max(report_.deepest_in_man, depth);
        }
      }
    }
  }

  // False once the ball has left over a wall.
  bool judge_table(const vp::Vec3& ball) {
    const double r = table().ball_radius;
    const double past_side = std::fabs(ball.y) - (0.5 * table().width - r);
    const double past_end = std::fabs(ball.x) - (0.5 * table().length - r);
    const bool at_mouth =
        std::fabs(ball.y) < 0.5 * table().goal_width && ball.z < table().goal_height;
    const double past_box = past_end - table().goal_depth;
    double depth = std::max({past_side, r - ball.z, at_mouth ? past_box : past_end});
    // Above the wall the ball may be over it; its rounding may then overlap the edge.
    const bool over = ball.z > table().wall_height - r;
    if (over && std::max(past_side, past_end) > 0.0) {
      if (std::max(past_side, past_end) > r) ++report_.over_the_wall;
      return std::max(past_side, past_end) <= r;
    }
    // On the posts and under the lintel only a part of the ball is in the mouth.
    if (at_mouth || past_end < 0.0 || !near_mouth(ball)) {
      report_.deepest_in_wall = std::max(report_.deepest_in_wall, depth);
      if (depth > 0.5 * r) ++report_.outside;
    }
    return true;
  }
  bool near_mouth(const vp::Vec3& ball) const {
    const double r = table().ball_radius;
    return std::fabs(ball.y) < 0.5 * table().goal_width + r && ball.z < table().goal_height + r &&
           std::fabs(ball.x) < 0.5 * table().length;
  }

  // Whether the segment meets the box about the origin (slabs).
  static bool crosses(const vp::Vec3& a, const vp::Vec3& b, const vp::Vec3& half) {
    double enter = 0.0, leave = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double way = b[axis] - a[axis];
      if (std::fabs(way) < 1e-12) {
        if (std::fabs(a[axis]) > half[axis]) return false;
        continue;
      }
      const double t0 = (-half[axis] - a[axis]) / way, t1 = (half[axis] - a[axis]) / way;
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    return enter <= leave;
  }

  // Of a point from the box about the origin; negative inside.
  static double distance(const vp::Vec3& p, const vp::Vec3& half) {
    const vp::Vec3 q{std::fabs(p.x) - half.x, std::fabs(p.y) - half.y, std::fabs(p.z) - half.z};
    const vp::Vec3 out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
    return vp::norm(out) + std::min(0.0, std::max({q.x, q.y, q.z}));
  }

  TableWorld world_;
  std::array<int, kTeams> characters_;
  Random random_;
  std::array<RodTarget, kRods> motion_{};
  std::array<RodState, kRods> before_{};
  ShotsReport report_;
};

}  // namespace foosball
