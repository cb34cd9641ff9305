// Continuous bodies other than spheres: fast and spinning, against resting and moving bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "collide/distance.h"
#include "random.h"
#include "rig.h"
#include "surfaces.h"

namespace vp::test {
namespace {

double separation(const Shape& a, const SE3& Ta, const Shape& b, const SE3& Tb) {
  collide::PairCache fresh;
  return closest_points(collide::make_geometry(a), Ta, collide::make_geometry(b), Tb, fresh)
      .distance;
}

Shape floor_mesh(Random& random, double size, const MeshOptions& options) {
  MeshPoints points = random_plane(random, 12, size);
  for (Vec3& v : points.vertices) v -= Vec3{0.5 * size, 0.5 * size, 0};
  return points.made(options);
}

// Rods of 0.4 m length and 1 cm thickness, at 25 m/s and 150 rad/s, and a wall of 2 mm. In a step
// of 1 ms they move 25 mm, their tips 40 mm.
TEST(Continuous, SpinningRodsNeverPassAThinWall) {
  Random random(801);
  const Shape rods[] = {Capsule{0.005, 0.195}, Box{{0.2, 0.005, 0.01}}, Cylinder{0.005, 0.2}};
  const Box wall{{0.001, 3.0, 3.0}};
  int hits = 0;
  double deepest = 0.0, most = 0.0;
  for (int i = 0; i < 60; ++i) {
    World world({.gravity = {}});
    add_fixed(world, wall, {0.3, random.uniform(0.0, 0.9)});
    Part part;
    part.shape = rods[i % 3];
    part.material = {0.3, 0.5};
    part.continuous = true;
    part.pose = SE3(random.rotation(), {-0.35, 0, 0});
    const Vec3 v{25.0, random.uniform(-5, 5), random.uniform(-5, 5)};
    part.velocity = {part.pose.unrotate(150.0 * random.direction()), part.pose.unrotate(v)};
    const BodyId rod = add_dynamic(world, part);
    const Inertia inertia = solid_inertia(part.shape, part.density);
    const double energy = kinetic_energy(world, rod, inertia);
    const double dt = i % 2 ? 0.001 : 0.004;
    for (int k = 0; k * dt < 0.06; ++k) {
      must(world.step(dt));
      ASSERT_LT(world.pose(rod).position().x, 0.0) << "rod " << i;
      deepest = std::min(deepest, separation(part.shape, world.pose(rod), wall, SE3{}));
      for (const ContactEvent& e : world.contact_events()) {
        hits += e.kind == ContactEvent::Kind::hit ? 1 : 0;
      }
      most = std::max(most, kinetic_energy(world, rod, inertia) / energy);
    }
  }
  std::printf("%d hits, deepest %.3f mm, at most %.4f of the energy\n", hits, -1e3 * deepest, most);
  EXPECT_GE(hits, 60);
  EXPECT_GT(deepest, -1e-3);
  EXPECT_LT(most, 1.05);
}

// Plates of 2 mm, spinning, fly at one another at 25 m/s each. At least one of them is continuous.
TEST(Continuous, PlatesThatFlyAtOneAnotherMeet) {
  Random random(802);
  int rotated_back = 0;
  for (int i = 0; i < 40; ++i) {
    World world({.gravity = {}});
    const auto add_plate = [&](double side) {
      Part part;
      part.shape = Box{{0.001, 0.5, 0.5}};
      part.material = {0.3, 0.3};
      part.continuous = side < 0.0 || i % 2 == 0;
      part.pose = SE3(Exp(0.2 * random.direction()).matrix(), {0.3 * side, 0, 0});
      part.velocity = {5.0 * random.direction(), part.pose.unrotate({-25.0 * side, 0, 0})};
      return add_dynamic(world, part);
    };
    const BodyId left = add_plate(-1.0), right = add_plate(1.0);
    const Inertia inertia = solid_inertia(Box{{0.001, 0.5, 0.5}}, 1000.0);
    const auto momentum = [&] {
      Vec3 sum;
      for (const BodyId b : {left, right})
        sum += inertia.mass() * world.pose(b).rotate(world.velocity(b).v);
      return sum;
    };
    const Vec3 before = momentum();
    for (int k = 0; k < 25; ++k) {
      must(world.step(0.001));
      ASSERT_LT(world.pose(left).position().x, world.pose(right).position().x) << i;
    }
    EXPECT_LT(norm(momentum() - before), 1e-9 * inertia.mass() * 25.0);
    rotated_back += world.pose(left).rotate(world.velocity(left).v).x < 10.0 ? 1 : 0;
  }
  EXPECT_EQ(rotated_back, 40);
}

// Bodies that come to rest stay at rest, at most as deep as the slop.
TEST(Continuous, BodiesOfAnyShapeComeToRest) {
  for (const Shape& shape :
       {Shape{Box{{0.05, 0.04, 0.03}}}, Shape{Cylinder{0.04, 0.03}}, Shape{Cone{0.04, 0.03}}}) {
    World world;
    add_ground(world, {0.5, 0.2});
    Part part;
    part.shape = shape;
    part.material = {0.5, 0.2};
    part.continuous = true;
    part.pose = SE3(Exp(Vec3{0.2, 0.1, 0}).matrix(), {0, 0, 0.12});
    part.velocity = {Vec3{3, 0, 0}, Vec3{}};
    const BodyId body = add_dynamic(world, part);
    for (int k = 0; k < 3000; ++k) {
      const StepStatus status = must(world.step(0.001));
      ASSERT_FALSE(status.impact_limit);
      ASSERT_GT(separation(shape, world.pose(body), HalfSpace{}, SE3{}), -5e-4);
    }
    const se3 V = world.velocity(body);
    EXPECT_LT(norm(V.v), 1e-3);
    EXPECT_LT(norm(V.w), 0.05);
    EXPECT_LT(separation(shape, world.pose(body), HalfSpace{}, SE3{}), 2e-4);
  }
}

// Two sticks of 1 cm thickness fly at one another head on, each spinning at 150 rad/s. In any
// orientation a stick contains its centre, so they collide before their centres would.
TEST(Continuous, SpinningSticksNeverPassOneAnother) {
  Random random(803);
  constexpr double kThick = 0.005, kSpeed = 25.0, kStart = 0.31;
  double latest = 0.0, nearest = 1.0;
  for (int i = 0; i < 120; ++i) {
    World world({.gravity = {}});
    const auto add_stick = [&](double side) {
      Part part;
      part.shape = i % 2 ? Shape{Box{{0.2, kThick, kThick}}} : Shape{Capsule{kThick, 0.195}};
      part.material = {0.3, random.uniform(0.0, 0.8)};
      part.continuous = side < 0.0 || i % 3 != 0;  // one continuous body of the pair is enough
      part.pose = SE3(random.rotation(), {kStart * side, 0, 0});
      part.velocity = {part.pose.unrotate(150.0 * random.direction()),
                       part.pose.unrotate({-kSpeed * side, 0, 0})};
      return add_dynamic(world, part);
    };
    const BodyId left = add_stick(-1.0), right = add_stick(1.0);
    const double dt = i % 4 < 2 ? 0.001 : 0.004;
    double met = -1.0;
    for (int k = 0; met < 0.0 && k * dt < 0.02; ++k) {
      must(world.step(dt));
      for (const ContactEvent& e : world.contact_events()) {
        if (e.kind == ContactEvent::Kind::hit && met < 0.0) met = k * dt + e.time;
      }
      nearest = std::min(nearest, norm(world.pose(right).position() - world.pose(left).position()));
    }
    ASSERT_GE(met, 0.0) << i;
    ASSERT_LE(met, (kStart - kThick) / kSpeed) << i;  // their inscribed spheres touch
    latest = std::max(latest, met);
  }
  std::printf("the latest hit after %.2f ms, middles as near as %.2f mm\n", 1e3 * latest,
              1e3 * nearest);
  EXPECT_GE(nearest, 2.0 * kThick - 3e-4);
}

// The first hit of tumbling bodies, found in steps of 4 ms, matches that of steps of 20 us.
TEST(Continuous, HitsWhenSmallStepsSayThatItDoes) {
  Random random(804);
  double most = 0.0;
  for (int i = 0; i < 12; ++i) {
    const SE3 pose(random.rotation(), {-0.4, 0, 0});
    const Vec3 spin = 30.0 * random.direction();
    const auto first_hit = [&](double dt) {
      World world({.gravity = {}});
      add_fixed(world, Box{{0.001, 3.0, 3.0}}, {0.3, 0.5});
      Part part;
      part.shape = Cylinder{0.03, 0.2};
      part.continuous = true;
      part.pose = pose;
      part.velocity = {pose.unrotate(spin), pose.unrotate({20.0, 1.0, 2.0})};
      add_dynamic(world, part);
      for (int k = 0; k * dt < 0.05; ++k) {
        must(world.step(dt));
        for (const ContactEvent& e : world.contact_events()) {
          if (e.kind == ContactEvent::Kind::hit) return k * dt + e.time;
        }
      }
      return -1.0;
    };
    const double coarse = first_hit(0.004), fine = first_hit(2e-5);
    ASSERT_GT(fine, 0.0);
    most = std::max(most, std::fabs(coarse - fine));
  }
  std::printf("times of hits differ by at most %.1f us\n", 1e6 * most);
  EXPECT_LT(most, 50e-6);  // measured 20 us, of 4000
}

// A box at 100 m/s moves 1.7 m in a step of 60 Hz. The wall is 1 mm thick.
TEST(Continuous, AThinWallStopsABoxOf100MetresASecondAt60Hertz) {
  Random random(805);
  const Box wall{{0.0005, 5.0, 5.0}};
  for (int i = 0; i < 60; ++i) {
    World world({.gravity = {}});
    add_fixed(world, wall, {0.3, 0.0});
    Part part;
    part.shape = Box{{0.1, random.uniform(0.02, 0.1), 0.05}};
    part.material = {0.3, i % 2 ? 0.0 : 0.5};
    part.continuous = true;
    part.pose = SE3(random.rotation(), {random.uniform(-2.5, -0.2), 0, 0});
    part.velocity = {random.uniform(0.0, 50.0) * random.direction(),
                     part.pose.unrotate({100.0, 0, 0})};
    const BodyId box = add_dynamic(world, part);
    for (int k = 0; k < 12; ++k) {
      const StepStatus status = must(world.step(1.0 / 60.0));
      ASSERT_FALSE(status.non_finite);
      ASSERT_LT(world.pose(box).position().x, 0.0) << i;
      ASSERT_GT(separation(part.shape, world.pose(box), wall, SE3{}), -1e-3) << i;
    }
    // After a hit of one corner without bounce, the centre may move on, as slowly as the corner
    // rotates.
    const se3 V = world.velocity(box);
    EXPECT_LT(world.pose(box).rotate(V.v).x, 1e-3 + 0.15 * norm(V.w)) << i;
  }
}

// Two equal elastic boxes collide head on within a step. They exchange velocities at the time of
// impact, and no time is lost: each ends where the other would have been.
TEST(Continuous, ElasticBoxesGoOnAsIfTheyHadPassed) {
  for (const double dt : {1.0 / 60.0, 0.001}) {
    World world({.gravity = {}});
    const auto add_box = [&](double x, double v) {
      Part part;
      part.shape = Box{{0.05, 0.05, 0.05}};
      part.material = {0.0, 1.0};
      part.continuous = true;
      part.pose = SE3(Vec3{x, 0, 0});
      part.velocity = {{}, {v, 0, 0}};
      return add_dynamic(world, part);
    };
    const BodyId left = add_box(-1.0, 40.0), right = add_box(1.0, -20.0);
    const int steps = static_cast<int>(std::lround(0.1 / dt));
    for (int k = 0; k < steps; ++k) must(world.step(dt));
    const double t = steps * dt;
    // Faces collide, not centres: each is one box width behind the box it exchanged velocities
    // with.
    EXPECT_NEAR(world.pose(left).position().x, 1.0 - 20.0 * t - 0.1, 2e-4) << dt;
    EXPECT_NEAR(world.pose(right).position().x, -1.0 + 40.0 * t + 0.1, 2e-4) << dt;
    EXPECT_NEAR(world.velocity(left).v.x, -20.0, 1e-9);
    EXPECT_NEAR(world.velocity(right).v.x, 40.0, 1e-9);
  }
}

Shape hammer() {
  const CompoundPart parts[] = {{Capsule{0.006, 0.12}, SE3(Exp(Vec3{0, kPi / 2, 0}).matrix(), {})},
                                {Box{{0.02, 0.02, 0.05}}, SE3(Vec3{0.12, 0, 0})},
                                {Cone{0.01, 0.02}, SE3(Vec3{-0.13, 0, 0})}};
  return Compound::of(parts).value();
}

// Hammers at 25 m/s and 150 rad/s in a closed room of thin walls, one of them a mesh: none escapes.
TEST(Continuous, ThrownCompoundsStayInARoomOfThinWalls) {
  Random random(806);
  int hits = 0;
  double held = 0.0;
  for (int i = 0; i < 8; ++i) {
    World world;
    for (const int axis : {0, 1, 2}) {
      for (const double side : {-1.0, 1.0}) {
        Vec3 half{0.5, 0.5, 0.5}, centre{};
        half[axis] = 0.001;
        centre[axis] = 0.5 * side;
        if (axis == 2 && side < 0.0) {
          add_fixed(world, floor_mesh(random, 1.0, {true, false}), {0.3, 0.4}, SE3(centre));
        } else {
          add_fixed(world, Box{half}, {0.3, 0.4}, SE3(centre));
        }
      }
    }
    std::vector<BodyId> hammers;
    for (const double x : {-0.2, 0.2}) {
      Part part;
      part.shape = hammer();
      part.material = {0.3, 0.4};
      part.continuous = true;
      part.pose = SE3(random.rotation(), {x, 0, 0});
      part.velocity = {150.0 * random.direction(), 25.0 * random.direction()};
      hammers.push_back(add_dynamic(world, part));
    }
    for (int k = 0; k < 150; ++k) {
      const StepStatus status = must(world.step(0.002));
      ASSERT_FALSE(status.non_finite);
      held += status.time_lost;
      for (const ContactEvent& e : world.contact_events()) {
        hits += e.kind == ContactEvent::Kind::hit ? 1 : 0;
      }
      for (const BodyId body : hammers) {
        const Vec3 x = world.pose(body).position();
        ASSERT_LT(std::max({std::fabs(x.x), std::fabs(x.y), std::fabs(x.z)}), 0.5) << i;
      }
    }
  }
  std::printf("%d hits, held for %.2f ms of 2400\n", hits, 1e3 * held);
  EXPECT_GT(hits, 100);
  EXPECT_LT(held, 0.024);
}

// A box slides over a mesh without friction: internal edges neither slow nor lift nor stop it.
TEST(Continuous, InnerEdgesOfAMeshDoNotBrakeABoxThatSlides) {
  Random random(810);
  World world;
  add_fixed(world, floor_mesh(random, 4.0, {}), {0.0, 0.0});
  Part part;
  part.shape = Box{{0.05, 0.05, 0.05}};
  part.material = {0.0, 0.0};
  part.continuous = true;
  part.pose = SE3(Exp(Vec3{0, 0, 0.3}).matrix(), {-1.5, 0.013, 0.05});
  part.velocity = {{}, part.pose.unrotate({3.0, 0.2, 0})};
  const BodyId box = add_dynamic(world, part);
  for (int k = 0; k < 900; ++k) {
    const StepStatus status = must(world.step(0.001));
    ASSERT_FALSE(status.impact_limit);
  }
  const Vec3 x = world.pose(box).position(), v = world.pose(box).rotate(world.velocity(box).v);
  EXPECT_NEAR(x.x, -1.5 + 3.0 * 0.9, 1e-3);
  EXPECT_NEAR(x.y, 0.013 + 0.2 * 0.9, 1e-3);
  EXPECT_NEAR(x.z, 0.05, 2e-4);
  EXPECT_NEAR(v.x, 3.0, 1e-6);
}

// A kinematic paddle and a driven rod hit boxes that fly at them.
TEST(Continuous, PaddlesAndMenTurnBoxesBack) {
  Random random(807);
  for (int i = 0; i < 40; ++i) {
    World world({.gravity = {}});
    const bool man = i % 2 == 0;
    if (man) {
      const Rod rod = add_rod(world, 0.0, 0.0, 9, 0.02, {0.3, 0.5});
      const double rate = random.uniform(-150.0, 150.0);
      must(world.set_joint_state(rod.articulation, 0, 1, random.uniform(-0.2, 0.2), rate));
      must(world.set_drive(rod.articulation, 0, 1, {0.0, rate, 0.0, 10.0, 20.0}));
    } else {
      BodyDesc desc;
      desc.motion = Motion::kinematic;
      desc.velocity = {{0, random.uniform(-150.0, 150.0), 0}, {}};
      const BodyId paddle = must(world.create_body(desc));
      ColliderDesc blade;
      blade.shape = Box{{0.002, 0.1, 0.08}};
      must(world.add_collider(paddle, blade));
    }
    Part part;
    part.shape = Box{{0.01, 0.015, 0.02}};
    part.material = {0.3, 0.5};
    part.continuous = true;
    part.pose = SE3(random.rotation(), {-0.15, 0, random.uniform(-0.005, 0.005)});
    part.velocity = {100.0 * random.direction(), part.pose.unrotate({25.0, 0, 0})};
    const BodyId box = add_dynamic(world, part);
    bool met = false;
    for (int k = 0; k < 20 && !met; ++k) {
      const StepStatus status = must(world.step(0.001));
      ASSERT_FALSE(status.non_finite);
      met = !world.contact_events().empty();
      // The axis is inside the man and the blade at every angle, and the box is larger than the
      // axis.
      ASSERT_TRUE(met || world.pose(box).position().x < 0.0) << i;
    }
    ASSERT_TRUE(met) << i;
  }
}

// Boxes among boxes, compounds and spheres: a world restored at every step continues with the same
// bits.
TEST(Continuous, RestoredStepsGiveTheSameBits) {
  World world, other;
  for (World* w : {&world, &other}) {
    Random same(809);
    add_fixed(*w, floor_mesh(same, 12.0, {}), {0.4, 0.3});
    for (int i = 0; i < 12; ++i) {
      Part part;
      part.shape = i % 3 == 0   ? hammer()
                   : i % 3 == 1 ? Shape{Box{{0.05, 0.03, 0.02}}}
                                : Sphere{0.03};
      part.material = {0.4, 0.7};
      part.continuous = i % 4 != 3;
      part.pose = SE3(same.rotation(), same.in_cube(0.3) + Vec3{0, 0, 0.6});
      part.velocity = {50.0 * same.direction(), 2.0 * same.direction()};
      add_dynamic(*w, part);
    }
  }
  std::vector<std::byte> bytes;
  std::uint32_t impacts = 0;
  for (int k = 0; k < 700; ++k) {
    bytes.clear();
    world.snapshot(bytes);
    must(world.step(0.002));
    impacts += world.counters().impacts;
    must(other.restore(bytes));
    must(other.step(0.002));
    ASSERT_EQ(world.state_hash(), other.state_hash()) << k;
  }
  EXPECT_GT(impacts, 15u);
}

}  // namespace
}  // namespace vp::test
