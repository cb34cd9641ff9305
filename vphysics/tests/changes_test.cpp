// Changes to the bodies, colliders and joints of a running world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "random.h"
#include "surfaces.h"
#include "tree_scenes.h"

namespace vp::test {
namespace {

void run_steps(World& world, int steps) {
  for (int i = 0; i < steps; ++i) must(world.step(kLongDt));
}
int count(const World& world, ContactEvent::Kind kind) {
  const auto events = world.contact_events();
  return static_cast<int>(
      std::count_if(events.begin(), events.end(), [&](const auto& e) { return e.kind == kind; }));
}
struct Boxed {
  BodyId body;
  ColliderId collider;
};
Boxed add_box(World& world, const Vec3& at, const Material& material = {},
              Motion motion = Motion::dynamic, bool continuous = false) {
  BodyDesc desc;
  desc.motion = motion;
  desc.T_world_body = SE3(at);
  desc.continuous = continuous;
  Boxed b;
  b.body = must(world.create_body(desc));
  b.collider = must(world.add_collider(b.body, collider_of(kBox, material)));
  return b;
}

// --- mass

TEST(Mass, OfABodyWithoutAnInertiaIsThatOfItsColliders) {
  World world;
  const BodyId body = must(world.create_body({}));
  EXPECT_EQ(world.inertia(body).mass(), 1.0);  // default of a body without colliders
  ColliderDesc a = collider_of(Sphere{0.5}, {});
  a.density = 300.0;
  const ColliderId first = must(world.add_collider(body, a));
  EXPECT_DOUBLE_EQ(world.inertia(body).mass(), solid_inertia(a.shape, 300.0).mass());
  ColliderDesc b = collider_of(Box{{0.1, 0.2, 0.3}}, {}, SE3(Vec3{2, 0, 0}));
  must(world.add_collider(body, b));
  ColliderDesc sensor = collider_of(Sphere{5.0}, {});
  sensor.sensor = true;
  must(world.add_collider(body, sensor));

  BodyDesc stated;
  const BodyId twin = must(world.create_body(stated));
  must(world.add_collider(twin, a));
  must(world.add_collider(twin, b));
  must(world.set_mass_from_colliders(twin));
  EXPECT_EQ(world.inertia(body).mass(), world.inertia(twin).mass());
  EXPECT_EQ(world.inertia(body).first_moment(), world.inertia(twin).first_moment());

  must(world.remove_collider(first));
  EXPECT_NEAR(world.inertia(body).mass(), 0.048 * 1000.0, 1e-12);
  EXPECT_NEAR(world.inertia(body).first_moment().x, 2.0 * 48.0, 1e-12);
}

TEST(Mass, ThatIsStatedStays) {
  World world;
  BodyDesc desc;
  desc.inertia = Inertia(3.0, Vec3{1, 1, 1});
  const BodyId body = must(world.create_body(desc));
  must(world.add_collider(body, collider_of(kBox, {})));
  EXPECT_EQ(world.inertia(body).mass(), 3.0);
  const BodyId other = must(world.create_body({}));
  must(world.set_inertia(other, Inertia(2.0, Vec3{1, 1, 1})));
  must(world.add_collider(other, collider_of(kBox, {})));
  EXPECT_EQ(world.inertia(other).mass(), 2.0);
}

TEST(Mass, OfNoColliderFallsAndIsPushed) {
  World world;
  const BodyId body = must(world.create_body({}));
  must(world.apply_force(body, {3, 0, 0}));
  must(world.step(0.01));
  EXPECT_NEAR(world.velocity(body).v.x, 0.03, 1e-15);
  EXPECT_NEAR(world.velocity(body).v.z, -0.0981, 1e-15);
}

TEST(Mass, ChangedInFlightLeavesTheVelocityOfTheOrigin) {
  World world(WorldDesc{.gravity = {}});
  const Boxed box = add_box(world, {0, 0, 5});
  must(world.set_velocity(box.body, {{1, 2, 3}, {4, 5, 6}}));
  must(world.add_collider(box.body, collider_of(kBox, {}, SE3(Vec3{1, 0, 0}))));
  EXPECT_LT(norm(world.velocity(box.body).v - Vec3{4, 5, 6}), 1e-12);
  must(world.set_inertia(box.body, Inertia(2.0, {0.4, 0, 0}, Sym3{1, 1, 1, 0, 0, 0})));
  EXPECT_LT(norm(world.velocity(box.body).v - Vec3{4, 5, 6}), 1e-12);
  EXPECT_LT(norm(world.velocity(box.body).w - Vec3{1, 2, 3}), 1e-12);
}

TEST(Mass, ChangedKeepsTheForcesThatWait) {
  World world(WorldDesc{.gravity = {}});
  BodyDesc desc;
  desc.inertia = Inertia(2.0, Vec3{1, 1, 1});
  const BodyId body = must(world.create_body(desc)), twin = must(world.create_body(desc));
  const Inertia other(2.0, {0.4, 0, 0}, Sym3{1, 2, 2, 0, 0, 0});
  must(world.apply_force(body, {0, 0, 3}, {1, 1, 0}));
  must(world.set_inertia(body, other));
  must(world.set_inertia(twin, other));
  must(world.apply_force(twin, {0, 0, 3}, {1, 1, 0}));
  must(world.step(kLongDt));
  EXPECT_LT(norm(world.velocity(body).w - world.velocity(twin).w), 1e-15);
}

// A crate with a third of the mass is lifted by a force that did not lift it before.
TEST(SetInertia, IsFeltByWhatItLiesOn) {
  World world;
  add_ground(world, {});
  const Boxed box = add_box(world, {0, 0, 0.5});
  run_steps(world, 100);
  const auto push = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      must(world.apply_force(box.body, {0, 0, 0.5 * 1000.0 * kG}));
      must(world.step(kLongDt));
    }
  };
  push(100);
  EXPECT_NEAR(world.pose(box.body).position().z, 0.5, 1e-3);
  must(world.set_inertia(box.body, solid_inertia(kBox, 300.0)));
  push(100);
  EXPECT_GT(world.pose(box.body).position().z, 0.7);
}

// --- gravity, damping, sleep

TEST(GravityScale, ScalesTheFallOfABody) {
  for (const bool continuous : {false, true}) {
    World world;
    BodyDesc desc;
    desc.gravity_scale = 0.25;
    desc.continuous = continuous;
    const BodyId body = must(world.create_body(desc));
    run_steps(world, 100);
    EXPECT_NEAR(world.velocity(body).v.z, -0.25 * kG * 0.5, 1e-12);
    must(world.set_gravity_scale(body, 0.0));
    run_steps(world, 100);
    EXPECT_NEAR(world.velocity(body).v.z, -0.25 * kG * 0.5, 1e-12);
    must(world.set_gravity_scale(body, -1.0));
    run_steps(world, 100);
    EXPECT_NEAR(world.velocity(body).v.z, 0.75 * kG * 0.5, 1e-12);
  }
}

TEST(GravityScale, IsTheLoadOnWhatCarriesIt) {
  World world;
  add_ground(world, {0.4, 0, 0});
  const Boxed box = add_box(world, {0, 0, 0.5}, {0.4, 0, 0});
  must(world.set_gravity_scale(box.body, 0.5));
  run_steps(world, 100);
  for (const double share : {0.98, 1.02}) {
    const double start = world.pose(box.body).position().x;
    for (int i = 0; i < 200; ++i) {
      must(world.apply_force(box.body, {share * 0.4 * 0.5 * 1000.0 * kG, 0, 0}));
      must(world.step(kLongDt));
    }
    const double way = world.pose(box.body).position().x - start;
    EXPECT_TRUE(share < 1.0 ? way < 1e-3 : way > 0.01) << share << ' ' << way;
  }
}

TEST(SetDamping, SlowsFromTheNextStepOn) {
  World world(WorldDesc{.gravity = {}});
  const BodyId body = must(world.create_body({}));
  must(world.set_velocity(body, {{1, 0, 0}, {1, 0, 0}}));
  run_steps(world, 10);
  EXPECT_EQ(world.velocity(body).v.x, 1.0);
  must(world.set_damping(body, 2.0, 1.0));
  run_steps(world, 200);
  EXPECT_NEAR(world.velocity(body).v.x, std::exp(-2.0), 2e-3);
  EXPECT_NEAR(world.velocity(body).w.x, std::exp(-1.0), 2e-3);
}

TEST(AllowSleep, KeepsABodyAwakeWithAllThatItCarries) {
  WorldDesc settings;
  settings.sleep_after = 0.1;
  World world(settings);
  add_ground(world, {});
  const Boxed below = add_box(world, {0, 0, 0.5}), above = add_box(world, {0, 0, 1.5}),
              aside = add_box(world, {5, 0, 0.5});
  must(world.set_allow_sleep(below.body, false));
  run_steps(world, 200);
  EXPECT_FALSE(world.is_asleep(below.body));
  EXPECT_FALSE(world.is_asleep(above.body));
  EXPECT_TRUE(world.is_asleep(aside.body));
  must(world.set_allow_sleep(below.body, true));
  run_steps(world, 200);
  EXPECT_TRUE(world.is_asleep(below.body));
  EXPECT_TRUE(world.is_asleep(above.body));
  must(world.set_allow_sleep(above.body, false));
  EXPECT_FALSE(world.is_asleep(below.body));
}

// --- motion

TEST(SetMotion, OfAFixedBodyMakesItFallWithTheMassOfItsColliders) {
  World world;
  add_ground(world, {});
  const Boxed shelf = add_box(world, {0, 0, 3.5}, {}, Motion::fixed);
  const Boxed box = add_box(world, {0, 0, 4.5});
  run_steps(world, 200);
  EXPECT_NEAR(world.pose(box.body).position().z, 4.5, 1e-3);
  must(world.set_motion(shelf.body, Motion::dynamic));
  EXPECT_NEAR(world.inertia(shelf.body).mass(), 1000.0, 1e-9);
  run_steps(world, 600);
  EXPECT_NEAR(world.pose(shelf.body).position().z, 0.5, 1e-2);
  EXPECT_NEAR(world.pose(box.body).position().z, 1.5, 1e-2);
}

TEST(SetMotion, ToFixedStopsABodyInTheAir) {
  for (const bool continuous : {false, true}) {
    World world;
    add_ground(world, {});
    const Boxed box = add_box(world, {0, 0, 3}, {}, Motion::dynamic, continuous);
    run_steps(world, 40);
    must(world.set_motion(box.body, Motion::fixed));
    const Vec3 at = world.pose(box.body).position();
    const Boxed rider = add_box(world, at + Vec3{0, 0, 1.0});
    run_steps(world, 200);
    EXPECT_EQ(world.pose(box.body).position(), at);
    EXPECT_NEAR(world.pose(rider.body).position().z, at.z + 1.0, 1e-2);
    must(world.set_motion(box.body, Motion::dynamic));
    run_steps(world, 600);
    EXPECT_NEAR(world.pose(box.body).position().z, 0.5, 1e-2);
    EXPECT_NEAR(world.pose(rider.body).position().z, 1.5, 1e-2);
  }
}

TEST(SetMotion, KeepsTheVelocity) {
  World world(WorldDesc{.gravity = {}});
  const Boxed box = add_box(world, {0, 0, 0});
  must(world.set_velocity(box.body, {{0, 0, 1}, {2, 0, 0}}));
  must(world.set_motion(box.body, Motion::kinematic));
  run_steps(world, 10);
  EXPECT_EQ(world.velocity(box.body), (se3{{0, 0, 1}, {2, 0, 0}}));
  must(world.set_motion(box.body, Motion::dynamic));
  EXPECT_LT(norm(world.velocity(box.body).v - Vec3{2, 0, 0}), 1e-12);
  must(world.set_motion(box.body, Motion::fixed));
  must(world.set_motion(box.body, Motion::dynamic));
  EXPECT_EQ(world.velocity(box.body), se3{});
}

// Each begin event is followed by exactly one end event, whatever happens to a body.
TEST(SetMotion, EndsContactsOnce) {
  Random random(5);
  for (const bool continuous : {false, true}) {
    World world;
    add_ground(world, {});
    const Boxed box = add_box(world, {0, 0, 0.5}, {}, Motion::dynamic, continuous);
    const Boxed other = add_box(world, {0, 0, 1.5});
    int begun = 0;
    for (int i = 0; i < 400; ++i) {
      if (i % 7 == 0) {
        const auto motion = static_cast<Motion>(static_cast<int>(random.uniform(0.0, 2.999)));
        must(world.set_motion(box.body, motion));
        if (motion == Motion::kinematic) must(world.set_velocity(box.body, {}));
      }
      must(world.step(kLongDt));
      begun += count(world, ContactEvent::Kind::begin) - count(world, ContactEvent::Kind::end);
      ASSERT_GE(begun, 0);
      ASSERT_LE(begun, 2);
    }
    EXPECT_NEAR(world.pose(box.body).position().z, 0.5, 0.02);
    EXPECT_NEAR(world.pose(other.body).position().z, 1.5, 0.02);
    must(world.destroy_body(box.body));
    must(world.destroy_body(other.body));
    must(world.step(kLongDt));
    begun -= count(world, ContactEvent::Kind::end);
    EXPECT_EQ(begun, 0);
  }
}

TEST(SetMotion, RefusesWhatItsCollidersAndJointsForbid) {
  World world;
  const BodyId ground = add_ground(world, {});
  EXPECT_FALSE(world.set_motion(ground, Motion::dynamic));
  EXPECT_FALSE(world.set_motion(ground, Motion::kinematic));
  const Boxed a = add_box(world, {0, 0, 2}), b = add_box(world, {2, 0, 2}, {}, Motion::fixed);
  JointDesc joint;
  joint.kind = Weld{};
  joint.T_a_joint = SE3(Vec3{2, 0, 0});
  must(world.create_joint(a.body, b.body, joint));
  const std::uint64_t before = world.state_hash();
  EXPECT_FALSE(world.set_motion(a.body, Motion::fixed));
  EXPECT_FALSE(world.set_motion(a.body, static_cast<Motion>(7)));
  EXPECT_EQ(world.state_hash(), before);
  must(world.set_motion(b.body, Motion::dynamic));
  must(world.set_motion(a.body, Motion::fixed));
  run_steps(world, 100);
  EXPECT_NEAR(world.pose(b.body).position().z, 2.0, 0.02);  // the other body now carries it
}

TEST(SetMotion, OfABodyOfAPairThatDidNotCountBefore) {
  World world;
  const Boxed shelf = add_box(world, {0, 0, 0}, {}, Motion::fixed);
  const Boxed box = add_box(world, {0, 0, 1.0}, {}, Motion::kinematic);
  run_steps(world, 10);
  must(world.set_motion(box.body, Motion::dynamic));
  run_steps(world, 200);
  EXPECT_NEAR(world.pose(box.body).position().z, 1.0, 1e-3);
  EXPECT_EQ(world.contains(shelf.collider), true);
}

// --- colliders

TEST(SetMaterial, OfTheFloorChangesTheFrictionOfWhatLiesOnIt) {
  WorldDesc settings;
  settings.gravity = {2.0, 0, -kG};
  settings.sleep_after = 0.2;
  World world(settings);
  BodyDesc desc;
  desc.motion = Motion::fixed;
  const BodyId ground = must(world.create_body(desc));
  const ColliderId floor = must(world.add_collider(ground, collider_of(HalfSpace{}, {1, 0, 0})));
  const Boxed box = add_box(world, {0, 0, 0.5}, {1, 0, 0});
  run_steps(world, 200);
  ASSERT_TRUE(world.is_asleep(box.body));
  const double start = world.pose(box.body).position().x;
  must(world.set_material(floor, {0.01, 0, 0}));  // the pair's friction becomes 0.1
  EXPECT_FALSE(world.is_asleep(box.body));
  run_steps(world, 200);
  const double expected = 0.5 * (2.0 - 0.1 * kG);
  EXPECT_NEAR(world.pose(box.body).position().x - start, expected, 0.02 * expected);
  must(world.set_material(floor, {1.0, 0, 0}));
  run_steps(world, 400);
  EXPECT_LT(norm(world.velocity(box.body).v), 1e-3);
}

TEST(SetSurfaceVelocity, StartsAConveyor) {
  World world;
  BodyDesc desc;
  desc.motion = Motion::fixed;
  const BodyId ground = must(world.create_body(desc));
  const ColliderId belt = must(world.add_collider(ground, collider_of(HalfSpace{}, {1, 0, 0})));
  const Boxed box = add_box(world, {0, 0, 0.5}, {1, 0, 0});
  run_steps(world, 100);
  must(world.set_surface_velocity(belt, {0.5, 0, 0}));
  run_steps(world, 200);
  EXPECT_NEAR(world.velocity_world(box.body).linear.x, 0.5, 1e-3);
}

TEST(SetFilter, EndsAndBeginsContacts) {
  for (const bool continuous : {false, true}) {
    WorldDesc settings;
    settings.sleep_after = 0.2;
    World world(settings);
    add_ground(world, {});
    const Boxed below = add_box(world, {0, 0, 0.5}, {}, Motion::fixed);
    const Boxed above = add_box(world, {0, 0, 1.5}, {}, Motion::dynamic, continuous);
    run_steps(world, 200);
    EXPECT_EQ(world.is_asleep(above.body), !continuous);
    must(world.set_filter(below.collider, {2, 2}));  // the ground is of category 1
    EXPECT_FALSE(world.is_asleep(above.body));
    must(world.step(kLongDt));
    EXPECT_EQ(count(world, ContactEvent::Kind::end), 1) << continuous;
    run_steps(world, 200);
    EXPECT_NEAR(world.pose(above.body).position().z, 0.5, 0.01) << "it fell through";
    must(world.set_pose(above.body, SE3(Vec3{0, 0, 2.5})));
    must(world.set_filter(below.collider, {}));
    run_steps(world, 300);
    EXPECT_NEAR(world.pose(above.body).position().z, 1.5, 0.01);
  }
}

TEST(RemoveCollider, EndsItsContactsAndLeavesTheOthers) {
  WorldDesc settings;
  settings.sleep_after = 0.2;
  World world(settings);
  BodyDesc desc;
  desc.motion = Motion::fixed;
  const BodyId table = must(world.create_body(desc));
  const ColliderId left =
      must(world.add_collider(table, collider_of(kBox, {}, SE3(Vec3{-2, 0, 0}))));
  const ColliderId right =
      must(world.add_collider(table, collider_of(kBox, {}, SE3(Vec3{2, 0, 0}))));
  const Boxed a = add_box(world, {-2, 0, 1}), b = add_box(world, {2, 0, 1});
  run_steps(world, 200);
  ASSERT_TRUE(world.is_asleep(a.body));
  EXPECT_EQ(world.body_of(left), table);
  must(world.remove_collider(left));
  EXPECT_FALSE(world.contains(left));
  EXPECT_EQ(world.body_of(left), BodyId{});
  EXPECT_TRUE(world.contains(right));
  EXPECT_FALSE(world.remove_collider(left));
  must(world.step(kLongDt));
  ASSERT_EQ(count(world, ContactEvent::Kind::end), 1);
  EXPECT_EQ(world.contact_events()[0].a, left);
  run_steps(world, 200);
  EXPECT_LT(world.pose(a.body).position().z, 0.0);
  EXPECT_NEAR(world.pose(b.body).position().z, 1.0, 1e-3);
  const auto hit = world.ray_cast({-2, 0, 5}, {0, 0, -1}, 5.2);
  EXPECT_FALSE(*hit);
  must(world.remove_collider(right));
  must(world.add_collider(table, collider_of(kBox, {}, SE3(Vec3{2, 0, -1}))));
  run_steps(world, 300);
  EXPECT_NEAR(world.pose(b.body).position().z, 0.0, 1e-2);
}

TEST(RemoveCollider, OfALinkAndOfASweptBody) {
  World world;
  const ArticulationId id =
      must(world.create_articulation({model_of(hanging_chain(1, RevoluteJoint{{0, 1, 0}}))}));
  const BodyId link = world.link_body(id, 0);
  const Material bouncy{0.5, 0.5, 0.0};
  const ColliderId plate = must(
      world.add_collider(link, collider_of(Box{{0.2, 0.2, 0.02}}, bouncy, SE3(Vec3{0, 0, -0.3}))));
  const BodyId ball = add_ball(world, {0, 0, 0.3}, {}, bouncy);
  for (int i = 0; i < 20; ++i) must(world.step(kLongDt));
  must(world.remove_collider(plate));
  run_steps(world, 100);
  EXPECT_LT(world.pose(ball).position().z, -0.5);
}

// --- articulations

TEST(DestroyArticulation, FreesWhatLaysOnItAndItsSlots) {
  WorldDesc settings;
  settings.sleep_after = 0.2;
  World world(settings);
  add_ground(world, {});
  LinkSpec lift;
  lift.joint = PrismaticJoint{{0, 0, 1}};
  lift.T_parent_joint = SE3(Vec3{0, 0, 2});
  lift.inertia = solid_inertia(kBox, 1000.0);
  lift.forces = {stops(0.0, 0.0)};
  const ArticulationDesc desc{model_of({lift})};
  const ArticulationId id = must(world.create_articulation(desc));
  must(world.add_collider(world.link_body(id, 0), collider_of(kBox, {})));
  const ArticulationId other =
      must(world.create_articulation({model_of(hanging_chain(3, RevoluteJoint{{0, 1, 0}}))}));
  const Boxed box = add_box(world, {0, 0, 3});
  run_steps(world, 100);
  EXPECT_NEAR(world.pose(box.body).position().z, 3.0, 1e-2);
  const BodyId link = world.link_body(id, 0);
  must(world.destroy_articulation(id));
  EXPECT_FALSE(world.contains(id));
  EXPECT_FALSE(world.contains(link));
  EXPECT_TRUE(world.contains(other));
  EXPECT_FALSE(world.destroy_articulation(id));
  EXPECT_FALSE(world.set_drive(id, 0, 0, {}));
  EXPECT_EQ(world.link_body(id, 0), BodyId{});
  must(world.step(kLongDt));
  EXPECT_EQ(count(world, ContactEvent::Kind::end), 1);
  run_steps(world, 400);
  EXPECT_NEAR(world.pose(box.body).position().z, 0.5, 1e-2);

  const ArticulationId heir = must(world.create_articulation(desc));
  EXPECT_NE(heir, id);
  EXPECT_EQ(heir.index, id.index);
  EXPECT_FALSE(world.contains(id));
  must(world.apply_joint_force(heir, 0, 0, 1.0));
  std::vector<std::byte> bytes;
  world.snapshot(bytes);
  run_steps(world, 5);
  const std::uint64_t hash = world.state_hash();
  must(world.restore(bytes));
  run_steps(world, 5);
  EXPECT_EQ(world.state_hash(), hash);
}

// A rod that no body can reach is remote. It can be destroyed, too.
TEST(DestroyArticulation, OfARemoteOneAndOfTheLast) {
  World world;
  add_ground(world, {});
  const Rod rod = add_rod(world, 3, 0.5, 2, 0.1, {}), other = add_rod(world, -3, 0.5, 2, 0.1, {});
  const BodyId ball = add_ball(world, {0, 0, 0.1}, {}, {});
  run_steps(world, 20);
  must(world.destroy_articulation(rod.articulation));
  run_steps(world, 20);
  std::vector<std::byte> bytes;
  world.snapshot(bytes);
  must(world.restore(bytes));
  must(world.destroy_articulation(other.articulation));
  run_steps(world, 20);
  EXPECT_NEAR(world.pose(ball).position().z, kBallRadius, 1e-3);
}

// --- velocities

TEST(VelocityWorld, IsThatOfTheCentreOfMassInTheWorldsAxes) {
  World world(WorldDesc{.gravity = {}});
  BodyDesc desc;
  desc.T_world_body = SE3(Exp(Vec3{0.3, -1.1, 0.7}), {1, 2, 3});
  desc.inertia = Inertia(2.0, {0.4, 0.2, 0}, Sym3{1, 1, 1, 0, 0, 0});
  const BodyId body = must(world.create_body(desc));
  must(world.set_velocity_world(body, {{1, 2, 3}, {4, 5, 6}}));
  const VelocityWorld V = world.velocity_world(body);
  EXPECT_LT(norm(V.linear - Vec3{1, 2, 3}), 1e-14);
  EXPECT_LT(norm(V.angular - Vec3{4, 5, 6}), 1e-14);
  const Vec3 centre = desc.T_world_body * Vec3{0.2, 0.1, 0};
  EXPECT_LT(norm(world.velocity_at(body, centre) - V.linear), 1e-14);
  const Vec3 at{7, 8, 9};
  EXPECT_LT(norm(world.velocity_at(body, at) - V.linear - cross(V.angular, at - centre)), 1e-13);
  const SE3 T = world.pose(body);
  EXPECT_LT(norm(T.rotate(world.velocity(body).v) - world.velocity_at(body, T.position())), 1e-13);

  const ArticulationId id =
      must(world.create_articulation({model_of(hanging_chain(2, RevoluteJoint{{0, 1, 0}}))}));
  must(world.set_joint_state(id, 0, 0, 0.0, 2.0));
  const BodyId link = world.link_body(id, 1);  // its bar from z = -0.2 to -0.4
  EXPECT_LT(norm(world.velocity_world(link).linear - Vec3{-0.6, 0, 0}), 1e-14);
  EXPECT_LT(norm(world.velocity_at(link, {0, 0, -0.4}) - Vec3{-0.8, 0, 0}), 1e-14);
  EXPECT_FALSE(world.set_velocity_world(link, {}));
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(world.set_velocity_world(body, {{none, 0, 0}, {}}));
  EXPECT_FALSE(world.set_velocity_world({}, {}));
}

// --- rejected arguments

TEST(Changes, RefuseWhatIsNone) {
  World world;
  const Boxed box = add_box(world, {0, 0, 0.5});
  const Rod rod = add_rod(world, 3, 0.5, 1, 0.1, {});
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t before = world.state_hash();
  const auto refused = [&](const Expected<void>& result) {
    EXPECT_EQ(world.state_hash(), before);
    return !result && result.error().message.size() > 20;
  };
  for (const double x : {none, -1.0, 1e300}) {
    EXPECT_TRUE(refused(world.set_damping(box.body, x, 0)));
    EXPECT_TRUE(refused(world.set_damping(box.body, 0, x)));
    EXPECT_TRUE(refused(world.set_inertia(box.body, Inertia(x, Vec3{1, 1, 1}))));
    EXPECT_TRUE(refused(world.set_surface_velocity(box.collider, {x - 2e9, 0, 0})));
  }
  EXPECT_TRUE(refused(world.set_gravity_scale(box.body, none)));
  EXPECT_TRUE(refused(world.set_gravity_scale(box.body, 1e7)));
  EXPECT_TRUE(refused(world.set_material(box.collider, {-1, 0, 0})));
  EXPECT_TRUE(refused(world.set_material(box.collider, {1, 2, 0})));
  for (const BodyId id : {rod.body, BodyId{}}) {
    EXPECT_TRUE(refused(world.set_motion(id, Motion::fixed)));
    EXPECT_TRUE(refused(world.set_inertia(id, Inertia(1, Vec3{1, 1, 1}))));
    EXPECT_TRUE(refused(world.set_damping(id, 1, 1)));
    EXPECT_TRUE(refused(world.set_gravity_scale(id, 1)));
    EXPECT_TRUE(refused(world.set_allow_sleep(id, false)));
  }
  EXPECT_TRUE(refused(world.set_material({}, {})));
  EXPECT_TRUE(refused(world.set_filter({}, {})));
  EXPECT_TRUE(refused(world.set_surface_velocity({}, {})));
  EXPECT_TRUE(refused(world.remove_collider({})));
  EXPECT_TRUE(refused(world.destroy_articulation({})));
  BodyDesc desc;
  desc.gravity_scale = none;
  EXPECT_FALSE(world.create_body(desc));
}

// A snapshot from before a change has another topology hash.
TEST(Changes, EnterTheDigestOfTheWorld) {
  using Make = void (*)(World&, const Boxed&, const Rod&);
  const Make changes[] = {
      [](World& w, const Boxed& b, const Rod&) { must(w.set_motion(b.body, Motion::fixed)); },
      [](World& w, const Boxed& b, const Rod&) {
        must(w.set_inertia(b.body, Inertia(1, Vec3{1, 1, 1})));
      },
      [](World& w, const Boxed& b, const Rod&) { must(w.set_damping(b.body, 1, 0)); },
      [](World& w, const Boxed& b, const Rod&) { must(w.set_gravity_scale(b.body, 2)); },
      [](World& w, const Boxed& b, const Rod&) { must(w.set_allow_sleep(b.body, false)); },
      [](World& w, const Boxed& b, const Rod&) {
        must(w.set_material(b.collider, {0.1, 0, 0}));
      },
      [](World& w, const Boxed& b, const Rod&) {
        must(w.set_filter(b.collider, {3, 3}));
      },
      [](World& w, const Boxed& b, const Rod&) {
        must(w.set_surface_velocity(b.collider, {1, 0, 0}));
      },
      [](World& w, const Boxed& b, const Rod&) { must(w.remove_collider(b.collider)); },
      [](World& w, const Boxed&, const Rod& r) { must(w.destroy_articulation(r.articulation)); },
  };
  for (const Make& change : changes) {
    const auto which = &change - changes;
    const auto build = [](World& world, Boxed& box, Rod& rod) {
      add_ground(world, {});
      box = add_box(world, {0, 0, 0.5});
      rod = add_rod(world, 3, 0.5, 1, 0.1, {});
      run_steps(world, 20);
    };
    World a, b;
    Boxed box;
    Rod rod;
    build(a, box, rod);
    build(b, box, rod);
    std::vector<std::byte> before, after;
    a.snapshot(before);
    change(a, box, rod);
    EXPECT_FALSE(a.restore(before)) << which;
    change(b, box, rod);
    run_steps(a, 20);
    a.snapshot(after);
    must(b.restore(after));
    for (int i = 0; i < 5; ++i) {
      must(a.step(kLongDt));
      must(b.step(kLongDt));
      EXPECT_EQ(a.state_hash(), b.state_hash()) << which;
    }
  }
}

}  // namespace
}  // namespace vp::test
