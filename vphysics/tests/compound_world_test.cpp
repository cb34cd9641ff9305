// Worlds with compounds: they stand, topple by their exact masses, collide, and are saved and
// restored.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "rig.h"
#include "surfaces.h"

namespace vp::test {
namespace {

constexpr double kWeight = 9.81;
constexpr double kCompoundSteps[] = {1.0 / 60, 1.0 / 240, 0.001};

CompoundPart box_part(const Vec3& half, const Vec3& at) {
  return {Box{half}, SE3(at)};
}

// The lowest points are at z = 0.
Compound table() {
  std::vector<CompoundPart> parts{box_part({0.6, 0.4, 0.02}, {0, 0, 0.72})};
  for (const double x : {-0.55, 0.55}) {
    for (const double y : {-0.35, 0.35})
      parts.push_back(box_part({0.03, 0.03, 0.35}, {x, y, 0.35}));
  }
  return Compound::of(parts).value();
}
Compound chair() {
  std::vector<CompoundPart> parts{box_part({0.2, 0.2, 0.02}, {0, 0, 0.42}),
                                  box_part({0.02, 0.2, 0.25}, {-0.18, 0, 0.69})};
  for (const double x : {-0.18, 0.18}) {
    for (const double y : {-0.18, 0.18}) {
      parts.push_back({Cylinder{0.02, 0.2}, SE3(Vec3{x, y, 0.2})});
    }
  }
  return Compound::of(parts).value();
}
// A post of 0.2 x 0.2 x 1 m over x from 0 to 0.2, with an arm of 0.2 m height at its top that
// extends to x = 0.2 + arm.
Compound ell(double arm) {
  const CompoundPart parts[] = {box_part({0.1, 0.1, 0.5}, {0.1, 0, 0.5}),
                                box_part({0.5 * arm, 0.1, 0.1}, {0.2 + 0.5 * arm, 0, 0.9})};
  return Compound::of(parts).value();
}

BodyId add_compound(World& world, const Compound& shape, const SE3& pose,
                    const Material& material = {}, double density = 1000.0) {
  BodyDesc desc;
  desc.T_world_body = pose;
  desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
  const BodyId body = must(world.create_body(desc));
  ColliderDesc collider;
  collider.shape = shape;
  collider.material = material;
  collider.density = density;
  must(world.add_collider(body, collider));
  must(world.set_mass_from_colliders(body));
  return body;
}

TEST(CompoundWorld, TablesChairsAndAnLStandAtEveryStepAndOnEveryGround) {
  Random random(81);
  const Shape mesh = random_plane(random, 30, 4.0).made();
  double worst = 0.0;
  for (const bool on_mesh : {false, true}) {
    for (const double dt : kCompoundSteps) {
      World world;
      if (on_mesh) {
        add_fixed(world, mesh, {}, SE3(Vec3{-2, -2, 0}));
      } else {
        add_ground(world, {});
      }
      std::vector<BodyId> bodies{
          add_compound(world, table(), SE3(Vec3{-0.7, 0, 0})),
          add_compound(world, chair(), SE3(Vec3{0.5, 0, 0})),
          add_compound(world, ell(0.1), SE3(Vec3{1, 1, 0})),
          add_dynamic(world, {.shape = Box{{0.2, 0.1, 0.1}}, .pose = SE3(Vec3{-0.7, 0.1, 0.84})})};
      std::vector<SE3> before;
      for (const BodyId body : bodies) before.push_back(world.pose(body));
      for (double t = 0.0; t < 3.0; t += dt) must(world.step(dt));
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        const SE3 T = world.pose(bodies[i]);
        const double moved = norm(T.position() - before[i].position());
        worst = std::max(worst, moved);
        EXPECT_LT(moved, 1e-3) << i << on_mesh << dt;
        EXPECT_GT(dot(T.rotation().cz, Vec3{0, 0, 1}), 1.0 - 1e-6) << i << on_mesh << dt;
      }
    }
  }
  EXPECT_LT(worst, 1e-3) << worst;
}

// Its centre of mass is over the foot's edge, x = 0.2, where 0.04 * 0.1 = 0.04 arm * arm / 2, that
// is arm = sqrt(0.2) m. An arm 1% shorter stands, 1% longer topples.
TEST(CompoundWorld, AnLTopplesWhenItsCentreOfMassIsBeyondItsFoot) {
  for (const double share : {0.99, 1.01}) {
    World world;
    add_ground(world, {0.8, 0.0, 0.0});
    const BodyId body = add_compound(world, ell(share * std::sqrt(0.2)), {}, {0.8, 0.0, 0.0});
    for (int i = 0; i < 4000; ++i) must(world.step(0.001));
    const double upright = world.pose(body).rotation().cz.z;
    if (share < 1.0) {
      EXPECT_GT(upright, 0.99999);
    } else {
      EXPECT_LT(upright, 0.5);
    }
  }
}

// Falling over an edge without slip, the potential energy becomes rotation:
//   I w^2 / 2 = m g (h0 - h)
// I about the edge is computed here from the two boxes.
TEST(CompoundWorld, AnLFallsAsItsInertiaAboutTheEdgeSays) {
  const double arm = 0.6, density = 1000.0;
  const double m1 = density * 0.04, m2 = density * 0.04 * arm, m = m1 + m2;
  const double x1 = -0.1, z1 = 0.5, x2 = 0.5 * arm, z2 = 0.9;  // relative to the edge at x = 0.2
  const double x = (m1 * x1 + m2 * x2) / m, z = (m1 * z1 + m2 * z2) / m;
  const double I = m1 * ((0.2 * 0.2 + 1.0) / 12 + x1 * x1 + z1 * z1) +
                   m2 * ((arm * arm + 0.2 * 0.2) / 12 + x2 * x2 + z2 * z2);
  World world;
  const Material rough{4.0, 0.0, 0.0};
  add_ground(world, rough);
  const BodyId body = add_compound(world, ell(arm), {}, rough, density);
  EXPECT_NEAR(world.inertia(body).mass(), m, 1e-12 * m);
  EXPECT_NEAR(world.inertia(body).centre_of_mass().x, 0.2 + x, 1e-12);
  EXPECT_NEAR(world.inertia(body).centre_of_mass().z, z, 1e-12);
  for (int i = 0; i < 2000 && world.pose(body).rotation().cz.x < 0.6; ++i) {
    must(world.step(0.001));
  }
  const Vec3 up = world.pose(body).rotation().cz;  // the sine of the tilt angle is up.x
  const double drop = z - (z * up.z - x * up.x);
  const double rate = std::sqrt(2.0 * m * kWeight * drop / I);
  EXPECT_GT(up.x, 0.6);
  EXPECT_NEAR(world.velocity(body).w.y / rate, 1.0, 0.01);
}

TEST(CompoundWorld, MassOfAllCollidersIsThatOfTheirDensities) {
  World world;
  BodyDesc desc;
  desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
  desc.velocity = {{1, 2, 3}, {4, 5, 6}};
  const BodyId body = must(world.create_body(desc));
  ColliderDesc collider;
  // Two spheres of 1 and 3 kg at x = -0.3 and 0.1, and a sensor, which has no mass.
  const double volume = 4.0 / 3.0 * kPi * 1e-3;
  collider.shape = Sphere{0.1};
  collider.T_body_shape = SE3(Vec3{-0.3, 0, 0});
  collider.density = 1.0 / volume;
  must(world.add_collider(body, collider));
  collider.T_body_shape = SE3(Exp(Vec3{0.3, 0.4, 0.5}), Vec3{0.1, 0, 0});
  collider.density = 3.0 / volume;
  must(world.add_collider(body, collider));
  collider.sensor = true;
  collider.density = 1e5;
  must(world.add_collider(body, collider));
  must(world.set_mass_from_colliders(body));
  const Inertia J = world.inertia(body);
  EXPECT_NEAR(J.mass(), 4.0, 1e-12);
  EXPECT_LT(norm(J.centre_of_mass()), 1e-12);
  const double own = 0.4 * 4.0 * 0.01, apart = 1.0 * 0.09 + 3.0 * 0.01;
  EXPECT_NEAR(J.central().xx, own, 1e-12);
  EXPECT_NEAR(J.central().yy, own + apart, 1e-12);
  EXPECT_NEAR(J.central().zz, own + apart, 1e-12);
  EXPECT_EQ(world.velocity(body).w, desc.velocity.w);
  EXPECT_LT(norm(world.velocity(body).v - desc.velocity.v), 1e-12);
}

TEST(CompoundWorld, MassIsRefusedWhereThereIsNone) {
  World world;
  const auto refused = [&](BodyId body) {
    const std::uint64_t before = world.state_hash();
    const auto result = world.set_mass_from_colliders(body);
    EXPECT_FALSE(result);
    EXPECT_EQ(world.state_hash(), before);
    return result ? std::string() : result.error().message;
  };
  BodyDesc desc;
  desc.inertia = Inertia(1.0, Vec3{1, 1, 1});
  const BodyId bare = must(world.create_body(desc));
  EXPECT_NE(refused(bare).find("add one"), std::string::npos);
  ColliderDesc vast;
  vast.shape = Sphere{1e9};
  must(world.add_collider(bare, vast));
  EXPECT_FALSE(refused(bare).empty());  // 4e30 kg
  const BodyId ground = add_ground(world, {});
  EXPECT_NE(refused(ground).find("not dynamic"), std::string::npos);
  LinkSpec link;
  link.joint = FreeJoint{};
  link.inertia = Inertia(1.0, Vec3{1, 1, 1});
  const ArticulationId tree = must(world.create_articulation({model_of({link})}));
  EXPECT_NE(refused(world.link_body(tree, 0)).find("model"), std::string::npos);
  must(world.destroy_body(bare));
  EXPECT_FALSE(refused(bare).empty());
  EXPECT_FALSE(refused({}).empty());
}

// A compound as one collider collides as separate colliders of its parts do.
TEST(CompoundWorld, FallsAsTheSamePartsGivenOneByOne) {
  SE3 last[2];
  for (const bool one_by_one : {false, true}) {
    World world;
    add_ground(world, {});
    const Compound shape = chair();
    const SE3 pose(Exp(Vec3{0.3, 0.2, 0.1}), Vec3{0, 0, 0.5});
    BodyDesc desc;
    desc.T_world_body = pose;
    desc.inertia = shape.inertia(1000.0);
    const BodyId body = must(world.create_body(desc));
    ColliderDesc collider;
    if (one_by_one) {
      for (const CompoundPart& part : shape.parts()) {
        collider.shape = part.shape;
        collider.T_body_shape = part.T_compound_part;
        must(world.add_collider(body, collider));
      }
    } else {
      collider.shape = shape;
      must(world.add_collider(body, collider));
    }
    for (int i = 0; i < 300; ++i) must(world.step(0.001));  // it has landed on a leg
    EXPECT_LT(world.pose(body).position().z, 0.2);
    last[one_by_one] = world.pose(body);
  }
  // The two are solved in different orders.
  EXPECT_LT(norm(last[0].position() - last[1].position()), 2e-3);
}

TEST(CompoundWorld, AContinuousBallNeverGoesThroughIt) {
  Random random(82);
  int hits = 0;
  for (int shot = 0; shot < 200; ++shot) {
    World world({.gravity = {}});
    const Material material{0.3, 0.6, 0.0};
    // Thin plates of 4 mm, which move 25 mm a step.
    const CompoundPart parts[] = {box_part({0.1, 0.002, 0.1}, {0, 0, 0}),
                                  box_part({0.1, 0.1, 0.002}, {0, 0.1, 0}),
                                  {Capsule{0.01, 0.05}, SE3(Vec3{0.05, -0.06, 0})}};
    const BodyId body = add_compound(world, Compound::of(parts).value(), {}, material, 7800.0);
    must(world.set_velocity(body, {{random.uniform(-20, 20), random.uniform(-20, 20), 5}, {}}));
    const Vec3 direction = random.direction();
    const Vec3 aim{random.uniform(-0.08, 0.08), 0.0, random.uniform(-0.08, 0.08)};
    const BodyId ball = add_ball(world, aim - 0.5 * direction, 25.0 * direction, material);
    const auto local = [&] { return inverse_times(world.pose(body), world.pose(ball).position()); };
    Vec3 before = local();
    for (int i = 0; i < 40; ++i) {
      EXPECT_FALSE(must(world.step(0.001)).impact_limit);
      for (const ContactEvent& e : world.contact_events())
        hits += e.kind == ContactEvent::Kind::hit;
      const Vec3 after = local();
      if (before.y * after.y < 0.0) {
        const Vec3 at = before + (before.y / (before.y - after.y)) * (after - before);
        ASSERT_FALSE(std::max(std::fabs(at.x), std::fabs(at.z)) < 0.099) << shot;
      }
      before = after;
    }
  }
  EXPECT_GT(hits, 150);
}

// Compounds, a mesh and a height field with every kind of shape that can touch them.
struct Yard {
  World world;
  std::vector<BodyId> bodies;
};
Yard make_yard() {
  Yard yard;
  Random random(83);
  MeshPoints rough = random_plane(random, 20, 4.0);
  for (Vec3& v : rough.vertices) v.z = random.uniform(-0.05, 0.05);
  add_fixed(yard.world, rough.made(), {}, SE3(Vec3{-2, -2, 0}));
  std::vector<double> heights;
  for (int k = 0; k < 100; ++k) heights.push_back(random.uniform(-0.3, 0.0));
  add_fixed(yard.world, HeightField::of({10, 10, 0.5, 0.5, heights, {}}).value(), {},
            SE3(Vec3{-2, -2, -0.1}));
  const Shape shapes[] = {chair(), Box{{0.1, 0.1, 0.1}}, table(), Sphere{0.1}, ell(0.3)};
  for (int i = 0; i < 10; ++i) {
    const SE3 pose(random.rotation(),
                   Vec3{random.uniform(-1, 1), random.uniform(-1, 1), 0.6 + 0.5 * i});
    Part part{.shape = shapes[i % 5], .pose = pose};
    part.continuous = i == 3;
    yard.bodies.push_back(add_dynamic(yard.world, part));
  }
  return yard;
}
void play(Yard& yard, int steps) {
  for (int i = 0; i < steps; ++i) must(yard.world.step(0.002));
}

TEST(CompoundWorld, RestoredStepsToTheSameBits) {
  Yard yard = make_yard();
  for (int round = 0; round < 4; ++round) {
    play(yard, 250);
    std::vector<std::byte> bytes;
    yard.world.snapshot(bytes);
    Yard other = make_yard();
    must(other.world.restore(bytes));
    EXPECT_EQ(other.world.state_hash(), yard.world.state_hash());
    play(other, 100);
    must(yard.world.step(0.01));  // moves on, then restores
    must(yard.world.restore(bytes));
    play(yard, 100);
    ASSERT_EQ(other.world.state_hash(), yard.world.state_hash()) << round;
  }
  EXPECT_GT(yard.world.counters().contacts, 20u);
}

TEST(CompoundWorld, EachBeginHasItsEndWhoeverIsDestroyed) {
  Yard yard = make_yard();
  std::map<std::pair<ColliderId, ColliderId>, bool> touching;
  int ends = 0;
  const auto run = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      must(yard.world.step(0.002));
      for (const ContactEvent& e : yard.world.contact_events()) {
        bool& now = touching[{e.a, e.b}];
        if (e.kind == ContactEvent::Kind::begin) {
          EXPECT_FALSE(now);
          now = true;
        } else {
          EXPECT_TRUE(now);
        }
        if (e.kind == ContactEvent::Kind::end) now = false, ++ends;
      }
    }
  };
  run(700);
  for (const BodyId body : yard.bodies) {
    must(yard.world.destroy_body(body));
    run(20);
  }
  EXPECT_GT(ends, 20);
  for (const auto& [pair, now] : touching) EXPECT_FALSE(now);
}

TEST(CompoundWorld, SleepsAndWakesAsOne) {
  WorldDesc desc;
  desc.sleep_after = 0.3;
  World world(desc);
  Random random(84);
  add_fixed(world, random_plane(random, 30, 4.0).made(), {}, SE3(Vec3{-2, -2, 0}));
  const BodyId under = add_compound(world, table(), {});
  const BodyId over =
      add_dynamic(world, {.shape = Box{{0.1, 0.1, 0.1}}, .pose = SE3(Vec3{0, 0, 0.84})});
  for (int i = 0; i < 2000; ++i) must(world.step(0.001));
  EXPECT_TRUE(world.is_asleep(under));
  EXPECT_TRUE(world.is_asleep(over));
  const SE3 before = world.pose(under);
  must(world.apply_impulse(over, {0, 0, 5.0}, world.pose(over).position()));
  must(world.step(0.001));
  EXPECT_FALSE(world.is_asleep(under));
  for (int i = 0; i < 2000; ++i) must(world.step(0.001));
  EXPECT_TRUE(world.is_asleep(under));
  EXPECT_LT(norm(world.pose(under).position() - before.position()), 1e-4);
}

}  // namespace
}  // namespace vp::test
