// Results of the contact solver at one time of impact, against the contact laws: complementarity of
// normal velocity and impulse, and Coulomb's disc.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "random.h"
#include "solve/contact_solver.h"
#include "solve/instant_scratch.h"

namespace vp::solve {
namespace {

using test::Random;

constexpr double kStep = 1e-3;

struct Instant {
  std::vector<SolverBody> bodies;
  std::vector<ContactConstraint> contacts;
  InstantScratch scratch;
  std::vector<double> rows;

  StepContext context() {
    return {bodies, contacts, {}, {}, {}, rows, scratch, kStep, kStep, 1e-4, 1e9, 12};
  }
  std::uint32_t add_body(double mass, const Vec3& at, const Vec3& v, const Vec3& w) {
    SolverBody body{};
    body.articulation = -1;
    body.x = at;
    body.v = v;
    body.w = w;
    if (mass > 0.0) {
      body.inverse_mass = 1.0 / mass;
      const double own = 1.0 / (0.4 * mass * 0.01);  // a ball of 0.1 m
      body.angular = {own, own, own, 0.0, 0.0, 0.0};
    }
    bodies.push_back(body);
    return static_cast<std::uint32_t>(bodies.size() - 1);
  }
  void add_contact(std::uint32_t a, std::uint32_t b, const Vec3& at, const Vec3& normal,
                   double friction) {
    ContactConstraint c{};
    c.a = a;
    c.b = b;
    c.friction = friction;
    c.count = 1;
    set_normal(c, normal);
    c.points[0].position = at;
    contacts.push_back(c);
  }
  Vec3 speed_at(const ContactConstraint& c) const {
    const Vec3& at = c.points[0].position;
    const SolverBody &a = bodies[c.a], &b = bodies[c.b];
    return b.v + cross(b.w, at - b.x) - a.v - cross(a.w, at - a.x);
  }
};

// A wall of balls on the ground, each in the gap between two balls of the row below. All are hit
// from all sides at once.
Instant wall(std::uint64_t seed, int lowest, double most_friction) {
  Random random(seed);
  Instant instant;
  const std::uint32_t ground = instant.add_body(0.0, {}, {}, {});
  const double rise = std::sqrt(0.03);
  std::vector<std::uint32_t> below;
  for (int row = 0; row < lowest; ++row) {
    std::vector<std::uint32_t> balls;
    for (int k = 0; k < lowest - row; ++k) {
      const Vec3 at{0.2 * k + 0.1 * row, 0.0, 0.1 + rise * row};
      const double mass = std::pow(10.0, random.uniform(-0.5, 0.5));
      const Vec3 v = random.in_cube(1.0), w = random.in_cube(5.0);
      balls.push_back(instant.add_body(mass, at, v, w));
    }
    const auto touch = [&](std::uint32_t a, std::uint32_t b) {
      const Vec3 from = a == ground ? Vec3{instant.bodies[b].x.x, 0, -0.1} : instant.bodies[a].x;
      const Vec3 normal = 5.0 * (instant.bodies[b].x - from);
      instant.add_contact(a, b, from + 0.1 * normal, normal, random.uniform(0.0, most_friction));
    };
    for (std::size_t k = 0; k < balls.size(); ++k) {
      if (row == 0) touch(ground, balls[k]);
      if (k > 0) touch(balls[k - 1], balls[k]);
      if (row > 0) touch(below[k], balls[k]), touch(below[k + 1], balls[k]);
    }
    below = balls;
  }
  return instant;
}

// Largest violation of the contact laws: in velocities, and in impulses of bodies of about 1 kg.
double worst_error(const Instant& instant) {
  double worst = 0.0;
  for (const ContactConstraint& c : instant.contacts) {
    const ContactPoint& p = c.points[0];
    const Vec3 u = instant.speed_at(c);
    const double normal = dot(c.normal, u), most = c.friction * p.normal_impulse;
    const double t[2] = {p.tangent_impulse[0], p.tangent_impulse[1]};
    const double slip[2] = {dot(c.tangent[0], u), dot(c.tangent[1], u)};
    const double friction = std::hypot(t[0], t[1]), sliding = std::hypot(slip[0], slip[1]);
    worst = std::max({worst, -p.normal_impulse, -normal, friction - most});
    if (p.normal_impulse > 0.0) worst = std::max(worst, normal);
    if (friction < most - 1e-5) worst = std::max(worst, sliding);
    // Friction opposes sliding.
    const double power = slip[0] * t[0] + slip[1] * t[1];
    worst = std::max(worst, std::fabs(power + sliding * friction));
  }
  return worst;
}

// Iterations with Coulomb friction need not converge, and Newton steps that do not reduce the error
// are undone. Of these walls, one in fifty does not converge.
TEST(Instant, SmallWallsObeyTheLawsOfContact) {
  int astray = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Instant instant = wall(seed, 1 + static_cast<int>(seed % 4), 0.6);
    solve(instant.context());
    const double error = worst_error(instant);
    if (error < 2e-5) continue;
    ++astray;
    std::printf("seed %d: off by %.2g\n", static_cast<int>(seed), error);
  }
  EXPECT_LE(astray, 4);
}

// Too many rows for a dense matrix: the result is as accurate as the iterations make it.
TEST(Instant, LargeWallsAreStoppedToo) {
  Instant instant = wall(7, 10, 0.5);
  ASSERT_GT(3 * instant.contacts.size(), kMaxDenseRows);
  const auto closing = [&] {
    double sum = 0.0;
    for (const ContactConstraint& c : instant.contacts) {
      sum += std::max(0.0, -dot(c.normal, instant.speed_at(c)));
    }
    return sum;
  };
  const double before = closing();
  solve(instant.context());
  EXPECT_LT(closing(), 0.1 * before);
}

// A ball of 24 g between the ground and a plate of a tonne that moves down. Iterations alone would
// pass the load back and forth thousands of times.
TEST(Instant, ALightBallBetweenHeavyPlatesStops) {
  Instant instant;
  const std::uint32_t ground = instant.add_body(0.0, {}, {}, {});
  const std::uint32_t ball = instant.add_body(0.024, {0, 0, 0.1}, {0.1, 0, -1}, {});
  const std::uint32_t plate = instant.add_body(1000.0, {0, 0, 0.3}, {0, 0, -1}, {});
  instant.add_contact(ground, ball, {0, 0, 0}, {0, 0, 1}, 0.5);
  instant.add_contact(ball, plate, {0, 0, 0.2}, {0, 0, 1}, 0.5);
  solve(instant.context());
  EXPECT_LT(worst_error(instant), 1e-6);
  EXPECT_NEAR(instant.bodies[plate].v.z, 0.0, 1e-6);
  EXPECT_NEAR(instant.contacts[0].points[0].normal_impulse, 1000.024, 1e-3);
}

// Islands do not affect one another, not even in the last bit.
TEST(Instant, IslandsDoNotFeelOneAnother) {
  Instant alone = wall(3, 3, 0.5), both = wall(3, 3, 0.5);
  const auto count = static_cast<std::uint32_t>(both.bodies.size());
  Instant other = wall(4, 4, 0.5);
  both.bodies.insert(both.bodies.end(), other.bodies.begin(), other.bodies.end());
  for (ContactConstraint c : other.contacts) {
    c.a += count;
    c.b += count;
    both.contacts.insert(both.contacts.begin(), c);
  }
  solve(alone.context());
  solve(both.context());
  for (std::size_t i = 0; i < alone.bodies.size(); ++i) {
    EXPECT_EQ(alone.bodies[i].v, both.bodies[i].v);
    EXPECT_EQ(alone.bodies[i].w, both.bodies[i].w);
  }
  EXPECT_EQ(both.scratch.islands.all().size(), 2u);
}

}  // namespace
}  // namespace vp::solve
