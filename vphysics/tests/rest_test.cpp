// Bouncing and coming to rest, with short and long steps: forces that act within a step do not
// count as approach speed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rig.h"

namespace vp::test {
namespace {

constexpr double kSteps[] = {0.001, 1.0 / 240, 1.0 / 60};

struct Dropped {
  const char* name;
  Shape shape;
  bool continuous;
  double height;  // of the body's origin above its support
};
const Dropped kDropped[] = {{"swept ball", Sphere{0.05}, true, 0.05},
                            {"ball", Sphere{0.05}, false, 0.05},
                            {"capsule", Capsule{0.05, 0.1}, false, 0.15},
                            {"box", Box{{0.5, 0.5, 0.5}}, false, 0.5}};

BodyId add(World& world, const Dropped& kind, double restitution, double drop) {
  Part part{.shape = kind.shape, .pose = SE3(Vec3{0, 0, kind.height + drop})};
  part.material = {0.5, restitution, 0.0};
  part.continuous = kind.continuous;
  return add_dynamic(world, part);
}

// Steps for a time [s]; look(t) runs after each step.
template <class Look>
void play(World& world, double seconds, double dt, const Look& look) {
  for (double t = 0.0; t < seconds; t += dt) {
    must(world.step(dt));
    look(t);
  }
}
// The number of events of the given kind in the last step.
int count(const World& world, ContactEvent::Kind kind) {
  const auto events = world.contact_events();
  return static_cast<int>(std::count_if(events.begin(), events.end(),
                                        [kind](const ContactEvent& e) { return e.kind == kind; }));
}
// Height of the body's origin above its rest height.
double rise(const World& world, BodyId body, const Dropped& kind) {
  return world.pose(body).position().z - kind.height;
}

TEST(Rest, OfABouncyBodyIsOneBeginAndNoMotionAtEveryStep) {
  for (const Dropped& kind : kDropped) {
    for (const double dt : {0.001, 1.0 / 240, 1.0 / 60, 0.1}) {
      World world;
      add_ground(world, {});
      const BodyId body = add(world, kind, 0.6, 0.0);
      int begins = 0, others = 0;
      double farthest = 0.0;
      play(world, 5.0, dt, [&](double) {
        begins += count(world, ContactEvent::Kind::begin);
        others += count(world, ContactEvent::Kind::hit) + count(world, ContactEvent::Kind::end);
        farthest = std::max(farthest, std::fabs(rise(world, body, kind)));
      });
      EXPECT_EQ(begins, 1) << kind.name << ", step " << dt;
      EXPECT_EQ(others, 0) << kind.name << ", step " << dt;
      // Penetration that supports the weight: 0.2 mm at 0.1 s, 0.003 mm at 1/60 s. Before the fix:
      // 8 mm at 1/60 s.
      EXPECT_LT(farthest, dt == 0.1 ? 2.5e-4 : 1.1e-4) << kind.name << ", step " << dt;
    }
  }
}

TEST(Rest, IsReachedByWhatBouncesLessEachTime) {
  for (const Dropped& kind : kDropped) {
    for (const double dt : kSteps) {
      World world;
      add_ground(world, {});
      const BodyId body = add(world, kind, 0.6, 0.2);
      int bounces = 0, late = 0;
      double highest = 0.0;
      play(world, 5.0, dt, [&](double t) {
        (t < 2.5 ? bounces : late) += count(world, ContactEvent::Kind::hit);
        if (t > 2.5) highest = std::max(highest, rise(world, body, kind));
      });
      EXPECT_GE(bounces, 4) << kind.name << ", step " << dt;
      EXPECT_EQ(late, 0) << kind.name << ", step " << dt;
      EXPECT_LT(highest, 1.1e-4) << kind.name << ", step " << dt;
    }
  }
}

// Maximum height after the first bounce, of a body dropped from the given height.
double height_after_bounce(const Dropped& kind, double e, double drop, double dt) {
  World world;
  add_ground(world, {});
  const BodyId body = add(world, kind, e, drop);
  const double flight = std::sqrt(2 * drop / kG);
  bool bounced = false;
  double top = 0.0;
  play(world, flight * (1 + 1.5 * e), dt, [&](double) {
    bounced |= count(world, ContactEvent::Kind::hit) > 0;
    if (bounced) top = std::max(top, rise(world, body, kind));
  });
  return top;
}

// From many heights, so that contact occurs at any instant within a step.
TEST(Bounce, HeightFallsByTheSquareOfRestitutionAtEveryStep) {
  for (const Dropped& kind : kDropped) {
    for (const double dt : kSteps) {
      double worst = 0.0;
      for (const double e : {0.3, 0.6, 0.9, 1.0}) {
        for (int i = 0; i < 20; ++i) {
          const double drop = 1.0 + 0.01 * i;
          const double top = height_after_bounce(kind, e, drop, dt);
          worst = std::max(worst, std::fabs(top - e * e * drop) / drop);
        }
      }
      // As a fraction of the drop: 0.0001 at 1 ms, 0.0004 at 1/60 s. Before the fix: 0.08 at 1/60
      // s.
      EXPECT_LT(worst, 0.001) << kind.name << ", step " << dt;
    }
  }
}

struct OnABox {
  double highest_at_end = 0.0;
  int late_hits = 0;
  double first_top = 0.0;
};
// A ball dropped on a box that rests on the ground: its bounce must not include the load on the
// box.
OnABox drop_on_a_box(const Dropped& kind, double drop, double dt) {
  World world;
  add_ground(world, {});
  add_dynamic(world, {.shape = Box{{0.5, 0.5, 0.5}}, .pose = SE3(Vec3{0, 0, 0.5})});
  play(world, 0.5, dt, [](double) {});
  Dropped raised = kind;
  raised.height += 1.0;
  const BodyId body = add(world, raised, 0.6, drop);
  OnABox out;
  bool bounced = false, again = false;
  play(world, 5.0, dt, [&](double t) {
    const int hits = count(world, ContactEvent::Kind::hit);
    again |= hits > (bounced ? 0 : 1);
    bounced |= hits > 0;
    const double z = rise(world, body, raised);
    if (bounced && !again) out.first_top = std::max(out.first_top, z);
    if (t <= 3.0) return;
    out.late_hits += hits;
    out.highest_at_end = std::max(out.highest_at_end, z);
  });
  return out;
}

TEST(Rest, IsReachedOnWhatRestsItself) {
  for (const Dropped& kind : {kDropped[0], kDropped[1]}) {
    for (const double dt : kSteps) {
      for (const double drop : {0.0, 0.1, 0.3, 1.0}) {
        const OnABox out = drop_on_a_box(kind, drop, dt);
        EXPECT_EQ(out.late_hits, 0) << kind.name << ", step " << dt << ", drop " << drop;
        EXPECT_LT(out.highest_at_end, 1.1e-4) << kind.name << ", step " << dt << ", drop " << drop;
        // 0.0003 m at 1/60 s. A body that is not continuous bounces before the solver has the
        // forces that support the box: errors up to 0.0015 m at 1 ms and 0.037 m at 1/60 s.
        const double bound = kind.continuous ? 0.001 : dt < 0.002 ? 0.01 : 0.05;
        EXPECT_NEAR(out.first_top, 0.36 * drop, bound) << kind.name << ", step " << dt;
      }
    }
  }
}

// Measured 1.0003 m at 1/60 s. Before the fix: 1.66 m.
TEST(Bounce, OfRestitutionOneNeitherGainsNorLosesHeight) {
  for (const Dropped& kind : kDropped) {
    for (const double dt : kSteps) {
      World world;
      add_ground(world, {});
      const BodyId body = add(world, kind, 1.0, 1.0);
      double top = 0.0, highest = 0.0, lowest = 9.0;
      int tops = 0;
      play(world, 9.5, dt, [&](double) {
        const bool hit = count(world, ContactEvent::Kind::hit) > 0;
        if (hit && tops++ > 0) {
          highest = std::max(highest, top);
          lowest = std::min(lowest, top);
        }
        top = hit ? 0.0 : std::max(top, rise(world, body, kind));
      });
      EXPECT_GE(tops, 8) << kind.name << ", step " << dt;
      EXPECT_NEAR(highest, 1.0, 0.001) << kind.name << ", step " << dt;
      EXPECT_NEAR(lowest, 1.0, 0.001) << kind.name << ", step " << dt;
    }
  }
}

}  // namespace
}  // namespace vp::test
