// Random shots on the real table, with a check that is independent of the engine: the chord of the
// ball's centre over each tick, against every man's boxes and the table's inner bounds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "../src/random.h"
#include "../src/table_world.h"
#include "bodies.h"

namespace foosball {

struct ShotsReport {
  int shots = 0;
  long ticks = 0;
  long man_hits = 0, table_hits = 0;
  long over_the_wall = 0;  // left the table over a wall: allowed
  long through_a_man = 0;  // never allowed
  long outside = 0;        // never allowed
  long held_steps = 0;     // steps in which the engine reached its impact limit
  double held_seconds = 0.0;
  double deepest_in_man = 0.0;    // [m]
  double deepest_in_table = 0.0;  // [m], including the field
};

class ShotGallery {
 public:
  ShotGallery(Layout layout, std::uint64_t seed)
      : bodies_(bodies_of_seed(seed)), world_(layout, bodies_), random_(seed) {}

  void shoot(int shots) {
    for (int i = 0; i < shots; ++i) shot();
  }
  const ShotsReport& report() const { return report_; }

  static TeamBodies bodies_of_seed(std::uint64_t seed) {
    const auto n = static_cast<std::uint64_t>(built_in_count());
    return built_in(static_cast<int>(seed % n), static_cast<int>(seed / n % n));
  }

  // True if the segment intersects the box about the origin (slab method).
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

  // Distance of a point from the box about the origin; negative inside.
  static double distance(const vp::Vec3& p, const vp::Vec3& half) {
    const vp::Vec3 q{std::fabs(p.x) - half.x, std::fabs(p.y) - half.y, std::fabs(p.z) - half.z};
    const vp::Vec3 out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
    return vp::norm(out) + std::min(0.0, std::max({q.x, q.y, q.z}));
  }

 private:
  static constexpr int kTicks = 16;  // 0.4 m at 25 m/s: past two rods and to a wall
  static constexpr double kSlowest = 5.0, kFastest = 25.0;  // [m/s]
  static constexpr double kCore = 0.6;  // scale of a box: no chord may cross the scaled box

  const TableSpec& table() const { return world_.table(); }

  // In half of the shots the rods are at rest; in the other half they rotate and slide.
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
    const vp::Vec3 way = random_.unit() < 0.5 ? towards_a_man(place) : anywhere();
    const double length = vp::norm(way);
    // Half of the shots have the maximum speed.
    const double speed = random_.unit() < 0.5 ? kFastest : random_.between(kSlowest, kFastest);
    world_.set_ball(place, (speed / std::max(length, 0.01)) * way);
  }

  // Mostly along the field; a quarter in any direction.
  vp::Vec3 anywhere() {
    const bool steep = random_.unit() < 0.25;
    return {random_.between(-1.0, 1.0), random_.between(-1.0, 1.0),
            steep ? random_.between(-1.0, 0.5) : random_.between(-0.05, 0.05)};
  }

  // Towards a random part of a man of the nearest or a neighbouring rod.
  vp::Vec3 towards_a_man(const vp::Vec3& from) {
    const int nearest = static_cast<int>((from.x + 0.6) / 0.150);
    const int rod = std::clamp(nearest + random_.below(3) - 1, 0, kRods - 1);
    const int man = random_.below(table().rods[rod].men);
    const auto boxes = boxes_of(bodies_[table().rods[rod].team]);
    const ManBox& box = boxes[random_.below(static_cast<int>(boxes.size()))];
    const vp::SE3 T_world_man =
        man_pose(table(), rod, man, with_man(world_.rod(rod), world_.men()[rod][man]));
    return T_world_man * box.centre - from;
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
      men_before_ = world_.men();
      const vp::Vec3 from = world_.ball().pose.position();
      world_.step();
      ++report_.ticks;
      for (const vp::ContactEvent& event : world_.contacts()) {
        const BallContact contact = ball_contact(event);
        if (contact.kind != vp::ContactEvent::Kind::hit) continue;
        ++(contact.other.what == Tag::What::man ? report_.man_hits : report_.table_hits);
      }
      report_.held_steps += world_.status().impact_limit ? 1 : 0;
      report_.held_seconds += world_.status().time_lost;
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
        const vp::SE3 T_before =
            man_pose(table(), rod, man, with_man(before_[rod], men_before_[rod][man]));
        const vp::SE3 T_after =
            man_pose(table(), rod, man, with_man(world_.rod(rod), world_.men()[rod][man]));
        if (std::fabs(to.y - T_after.position().y) > 0.1) continue;
        for (const ManBox& box : boxes_of(bodies_[spec.team])) {
          const vp::Vec3 a = inverse_times(T_before, from) - box.centre;
          const vp::Vec3 b = inverse_times(T_after, to) - box.centre;
          if (crosses(a, b, kCore * box.half_extents)) ++report_.through_a_man;
          const double depth = table().ball_radius - distance(b, box.half_extents);
          report_.deepest_in_man = std::max(report_.deepest_in_man, depth);
        }
      }
    }
  }

  // Penetration of the ball into the table: field, walls, goal boxes. Not checked above the walls,
  // nor for the curvature of a ball that passes over an edge. Returns false once the ball is out.
  bool judge_table(const vp::Vec3& ball) {
    const double r = table().ball_radius;
    const double past_side = std::fabs(ball.y) - (0.5 * table().width - r);
    const double past_end = std::fabs(ball.x) - (0.5 * table().length - r);
    if (ball.z > table().wall_height) {
      const bool out = std::max(past_side, past_end) > r;
      report_.over_the_wall += out ? 1 : 0;
      return !out;
    }
    double depth = std::max(past_side, r - ball.z);
    if (past_end > 0.0) depth = std::max(depth, depth_at_end(ball, past_end));
    report_.deepest_in_table = std::max(report_.deepest_in_table, depth);
    report_.outside += depth > 0.5 * r ? 1 : 0;
    return true;
  }

  // For a ball that overlaps the plane of an end wall by past_end.
  double depth_at_end(const vp::Vec3& ball, double past_end) const {
    const double r = table().ball_radius;
    const double post = std::fabs(ball.y) - 0.5 * table().goal_width;  // beside the opening if > 0
    const double lintel = ball.z - table().goal_height;                // above it if > 0
    if (past_end < r) {
      // The centre is still over the field: distance to the nearest point of the wall's face.
      if (post > 0.0 || lintel > 0.0) return past_end;
      const double to_edge = std::min(-post, -lintel);
      const double to_face = r - past_end;
      return r - std::sqrt(to_edge * to_edge + to_face * to_face);
    }
    return std::max({past_end - table().goal_depth, post + r, lintel + r});
  }

  TeamBodies bodies_;
  TableWorld world_;
  Random random_;
  std::array<RodTarget, kRods> motion_{};
  std::array<RodState, kRods> before_{};
  ManStates men_before_{};
  ShotsReport report_;
};

}  // namespace foosball
