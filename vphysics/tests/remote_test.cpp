// Articulations beyond the reach of all bodies are not processed link by link
// (src/world/remote.cpp). This changes the cost of a step, and no bit of its result.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "random.h"
#include "rig.h"

namespace vp::test {
namespace {

constexpr double kHeight = 0.09, kPitch = 0.15;
constexpr int kRows = 4, kMenOfRow = 3;

// Rows of men, each hinged on a slider for its row, as in the paper layout of the foosball table,
// and a fast ball between walls. The men collide with the ball only.
struct Rows {
  World world{{}};
  std::vector<ArticulationId> rows;
  BodyId ball;
};

Model row_model(double x) {
  ModelBuilder builder;
  LinkSpec slide;
  slide.joint = PrismaticJoint{};
  slide.T_parent_joint = SE3(Mat3{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, Vec3{x, 0, kHeight});
  slide.armature = 1.0;
  slide.forces = {{.lower = -0.06, .upper = 0.06}};
  const int parent = must(builder.add(slide));
  for (int man = 0; man < kMenOfRow; ++man) {
    LinkSpec hinge;
    hinge.parent = parent;
    hinge.joint = RevoluteJoint{};
    hinge.T_parent_joint = SE3(Vec3{0, 0, 0.12 * (man - 1)});
    hinge.inertia = Inertia(0.07, Vec3{1e-4, 1e-4, 1e-4});
    hinge.armature = 1e-3;
    must(builder.add(hinge));
  }
  return must(builder.build());
}

Rows make_rows() {
  Rows s;
  const Material m{0.4, 0.7, 0.0};
  add_ground(s.world, m);
  for (const double side : {-0.32, 0.32}) {
    add_fixed(s.world, Box{{0.02, 0.4, 0.1}}, m, SE3(Vec3{side, 0, 0.1}));
    add_fixed(s.world, Box{{0.4, 0.02, 0.1}}, m, SE3(Vec3{0, side, 0.1}));
  }
  for (int row = 0; row < kRows; ++row) {
    s.rows.push_back(must(s.world.create_articulation({row_model(kPitch * (row - 1.5))})));
    for (int man = 0; man < kMenOfRow; ++man) {
      ColliderDesc foot;
      foot.shape = Box{{0.01, 0.03, 0.012}};
      foot.T_body_shape = SE3(Vec3{0, 0.045, 0});
      foot.material = m;
      foot.filter = {2, 4};
      must(s.world.add_collider(s.world.link_body(s.rows.back(), 1 + man), foot));
    }
  }
  BodyDesc ball;
  ball.inertia = solid_inertia(Sphere{kBallRadius}, kBallDensity);
  ball.T_world_body = SE3(Vec3{0.01, 0.02, 0.02});
  ball.velocity = {{}, {6, 4, 0}};
  ball.continuous = true;
  s.ball = must(s.world.create_body(ball));
  ColliderDesc sphere;
  sphere.shape = Sphere{kBallRadius};
  sphere.material = m;
  sphere.filter = {4, ~0u};
  must(s.world.add_collider(s.ball, sphere));
  return s;
}

void drive(Rows& s, Random& random) {
  for (const ArticulationId row : s.rows) {
    must(s.world.set_drive(row, 0, 0, {random.uniform(-0.08, 0.08), 0, 3e4, 400, 300}));
    for (int man = 0; man < kMenOfRow; ++man) {
      must(s.world.set_drive(row, 1 + man, 0, {random.uniform(-9, 9), 0, 60, 0.5, 10}));
    }
  }
}

void shoot(Rows& s, Random& random) {
  must(s.world.set_pose(s.ball, SE3(Vec3{random.uniform(-0.02, 0.02), random.uniform(-0.2, 0.2),
                                         kBallRadius + 0.002})));
  must(s.world.set_velocity(
      s.ball, {{}, {random.uniform(-12, 12), random.uniform(-12, 12), random.uniform(0, 1)}}));
}

// A pose query ends the remote state of an articulation, so no articulation of the second world is
// remote.
TEST(Remote, ChangesNoBitOfAGame) {
  Rows plain = make_rows(), asked = make_rows();
  Random one(5), other(5);
  long hits = 0;
  for (int tick = 0; tick < 12000; ++tick) {
    if (tick % 40 == 0) {
      drive(plain, one);
      drive(asked, other);
    }
    if (tick % 500 == 0) {
      shoot(plain, one);
      shoot(asked, other);
    }
    for (const ArticulationId row : asked.rows) {
      for (int link = 0; link <= kMenOfRow; ++link) {
        (void)asked.world.pose(asked.world.link_body(row, link));
      }
    }
    must(plain.world.step(kDt));
    must(asked.world.step(kDt));
    for (const ContactEvent& event : plain.world.contact_events()) {
      hits += event.kind == ContactEvent::Kind::hit ? 1 : 0;
    }
    if (tick % 50 == 0) {
      ASSERT_EQ(plain.world.state_hash(), asked.world.state_hash()) << tick;
    }
  }
  EXPECT_EQ(plain.world.state_hash(), asked.world.state_hash());
  EXPECT_GT(hits, 200);  // measured 286
}

TEST(Remote, PosesAndVelocitiesAreThoseOfTheCoordinates) {
  Rows s = make_rows();
  Random random(6);
  must(s.world.set_velocity(s.ball, {}));
  must(s.world.set_pose(s.ball, SE3(Vec3{-0.25, 0.25, kBallRadius})));
  for (int tick = 0; tick < 300; ++tick) {
    if (tick % 40 == 0) drive(s, random);
    must(s.world.step(kDt));
    if (tick % 17 != 0) continue;  // remote in between
    for (int row = 0; row < kRows; ++row) {
      const auto q = s.world.coordinates(s.rows[static_cast<std::size_t>(row)]);
      const auto v = s.world.velocities(s.rows[static_cast<std::size_t>(row)]);
      for (int man = 0; man < kMenOfRow; ++man) {
        const auto k = static_cast<std::size_t>(1 + man);
        const BodyId body = s.world.link_body(s.rows[static_cast<std::size_t>(row)], 1 + man);
        const SE3 T = s.world.pose(body);
        const Vec3 at{kPitch * (row - 1.5), q[0] + 0.12 * (man - 1), kHeight};
        EXPECT_LT(norm(T.position() - at), 1e-12);
        EXPECT_NEAR(T.rotation().cx.x, std::cos(q[k]), 1e-12);
        EXPECT_NEAR(s.world.velocity(body).w.z, v[k], 1e-9);
        EXPECT_NEAR(s.world.velocity(body).v.z, v[0], 1e-12);
      }
    }
  }
}

TEST(Remote, QueriesFindMenWhereTheyAre) {
  Rows s = make_rows();
  must(s.world.set_velocity(s.ball, {}));
  must(s.world.set_pose(s.ball, SE3(Vec3{-0.25, 0.25, kBallRadius})));
  const ArticulationId row = s.rows.back();
  must(s.world.set_drive(row, 2, 0, {1.5, 0, 60, 0.5, 10}));
  for (int tick = 0; tick < 400; ++tick) must(s.world.step(kDt));
  // The foot has swung from below the axis to beside it.
  std::vector<ColliderId> found;
  const QueryFilter men{.collision = {4, 2}};
  const double x = kPitch * 1.5;
  must(s.world.overlapping(Sphere{0.005}, SE3(Vec3{x, 0, kHeight - 0.05}), found, men));
  EXPECT_TRUE(found.empty());
  for (const double side : {-0.05, 0.05}) {
    must(s.world.overlapping(Sphere{0.005}, SE3(Vec3{x + side, 0, kHeight}), found, men));
  }
  EXPECT_EQ(found.size(), 1u);
}

// A remote row slides to its stop; then a ball at 20 m/s is shot at its current place.
TEST(Remote, ABallMeetsARowThatHasSlidFarMeanwhile) {
  for (const double to : {-0.059, 0.059}) {
    Rows s = make_rows();
    must(s.world.set_velocity(s.ball, {}));
    must(s.world.set_pose(s.ball, SE3(Vec3{-0.25, 0.25, kBallRadius})));
    must(s.world.set_drive(s.rows.back(), 0, 0, {to, 0, 3e4, 400, 300}));
    for (int tick = 0; tick < 300; ++tick) must(s.world.step(kDt));
    must(s.world.set_pose(s.ball, SE3(Vec3{0.15, to, 0.05})));
    must(s.world.set_velocity(s.ball, {{}, {20, 0, 0}}));
    bool hit = false;
    for (int tick = 0; tick < 6; ++tick) {
      must(s.world.step(kDt));
      for (const ContactEvent& event : s.world.contact_events())
        hit = hit || (event.kind == ContactEvent::Kind::hit && event.normal.x < -0.9);
      ASSERT_LT(s.world.pose(s.ball).position().x, kPitch * 1.5);
    }
    EXPECT_TRUE(hit);
  }
}

// Otherwise it would converge into the range of denormal numbers, where every step takes several
// times as long. Without a threshold, its speed is 4e-285 rad/s here, and denormal soon after.
TEST(RestOfALink, AJointThatHasComeToItsTargetStands) {
  World world;
  const Rod rod = add_rod(world, 0.0, 0.09, 1, 0.0, {});
  must(world.set_joint_state(rod.articulation, 0, 1, 0.5, 0.0));
  must(world.set_drive(rod.articulation, 0, 1, {0.0, 0.0, 2.0, 0.1, 10.0}));
  for (int tick = 0; tick < 20'000; ++tick) must(world.step(0.001));
  EXPECT_EQ(world.joint_velocity(rod.articulation, 0, 1), 0.0);
  const double angle = world.joint_position(rod.articulation, 0, 1);
  EXPECT_LT(std::fabs(angle), 1e-20);
  EXPECT_TRUE(angle == 0.0 || std::isnormal(angle)) << angle;
}

}  // namespace
}  // namespace vp::test
