// Steps between configurations, against poses and against each other.
#include "vphysics/multibody/configuration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trees.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;

Numbers between(const Model& model, const Numbers& q0, const Numbers& q1) {
  Numbers delta(static_cast<std::size_t>(model.velocities()));
  difference<double>(model, q0, q1, delta);
  return delta;
}
SE3 pose(const Model& model, const Numbers& q, int link) {
  Data data(model);
  forward_kinematics<double>(model, data, q, Numbers(static_cast<std::size_t>(model.velocities())));
  return T_world_link<double>(model, data, link);
}
Model one_link(Random& random, const Joint& joint) {
  ModelBuilder builder;
  must_build(builder.add({"link", kWorld, joint, random.pose(1), random_body(random)}));
  return must_build(builder.build());
}
double distance(const SE3& A, const SE3& B) {
  const se3 off = Log(Inv(A) * B);
  return norm(off.w) + norm(off.v);
}

// Measured: 1.7e-15.
TEST(Integrate, MovesAFreeAndABallAlongTheirOwnScrew) {
  Random random(71);
  const Model free = one_link(random, FreeJoint{}), ball = one_link(random, BallJoint{});
  double worst = 0.0;
  for (int round = 0; round < 500; ++round) {
    // Angles from zero, over both sides of the series threshold, to more than a revolution.
    const double angle = round % 5 == 0 ? 0.0 : std::pow(10.0, random.uniform(-9.0, 0.9));
    const Vec3 w = angle * random.direction(), v = random.in_cube(2);
    for (const Model* model : {&free, &ball}) {
      const State s = random_state(random, *model);
      const bool slides = model == &free;
      const Numbers delta = slides ? Numbers{w.x, w.y, w.z, v.x, v.y, v.z} : Numbers{w.x, w.y, w.z};
      const SE3 moved = pose(*model, stepped(*model, s.q, delta), 0);
      const SE3 expected = pose(*model, s.q, 0) * Exp(se3{w, slides ? v : Vec3{}});
      worst = std::max(worst, distance(moved, expected));
    }
  }
  std::printf("worst: %.1e\n", worst);
  EXPECT_LT(worst, 1e-14);
}

TEST(Integrate, AddsTheCoordinatesOfEveryOtherJoint) {
  Random random(72);
  for (int kind = 0; kind < 10; ++kind) {
    const Joint joint = random_joint(random, kind);
    if (velocities_of(joint) == 0 || coordinates_of(joint) != velocities_of(joint)) continue;
    const Model model = one_link(random, joint);
    const State s = random_state(random, model);
    const Numbers moved = stepped(model, s.q, s.v);
    for (std::size_t i = 0; i < s.q.size(); ++i) EXPECT_EQ(moved[i], s.q[i] + s.v[i]) << kind;
  }
}

// Measured: 1.6e-15, and 2.2e-15 within 1e-7 of half a revolution.
TEST(Difference, IsTheStepThatIntegrateTook) {
  Random random(73);
  double worst = 0.0;
  for (int round = 0; round < 200; ++round) {
    const Model model = random_tree(random, 12);
    const State s = random_state(random, model);
    Numbers delta = s.v;
    const double scale = round % 4 == 0 ? 1e-8 : 1.7;  // 1.7 sqrt(3) < pi
    for (double& x : delta) x *= scale;
    const Numbers found = between(model, s.q, stepped(model, s.q, delta));
    worst = std::max(worst, largest_difference(found, delta));
    for (const double x : between(model, s.q, s.q)) ASSERT_NEAR(x, 0.0, 1e-15);
  }
  const Model free = one_link(random, FreeJoint{});
  double near_half_turn = 0.0;
  for (int round = 0; round < 200; ++round) {
    const State s = random_state(random, free);
    const Vec3 w = (kPi - std::pow(10.0, random.uniform(-7.0, -1.0))) * random.direction();
    const Numbers delta{w.x, w.y, w.z, 1, -2, 0.5};
    near_half_turn = std::max(
        near_half_turn, largest_difference(between(free, s.q, stepped(free, s.q, delta)), delta));
  }
  std::printf("worst: %.1e, near half a turn: %.1e\n", worst, near_half_turn);
  EXPECT_LT(worst, 1e-14);
  EXPECT_LT(near_half_turn, 1e-14);
}

// With either sign of the quaternions, between two arbitrary configurations.
TEST(Difference, LeadsFromAnyConfigurationToAnyOther) {
  Random random(74);
  for (int round = 0; round < 100; ++round) {
    const Model model = random_tree(random, 12);
    const State from = random_state(random, model);
    State to = random_state(random, model);
    if (round % 2 == 0) {
      for (int link = 0; link < model.links(); ++link) {
        if (!std::holds_alternative<BallJoint>(model.link(link).joint)) continue;
        for (int k = 0; k < 4; ++k) {
          double& x = to.q[static_cast<std::size_t>(model.first_coordinate(link) + k)];
          x = -x;
        }
      }
    }
    const Numbers there = stepped(model, from.q, between(model, from.q, to.q));
    for (int link = 0; link < model.links(); ++link) {
      ASSERT_LT(distance(pose(model, there, link), pose(model, to.q, link)), 1e-13) << link;
    }
  }
}

TEST(Integrate, KeepsQuaternionsOfUnitLengthAndWithoutAJump) {
  Random random(75);
  const Model model = one_link(random, BallJoint{});
  State s = random_state(random, model);
  Numbers q = s.q;
  const Numbers delta{0.02, -0.05, 0.03};
  for (int i = 0; i < 100000; ++i) {
    const Numbers before = q;
    integrate<double>(model, q, delta, q);  // in place
    ASSERT_LT(largest_difference(q, before), 0.04) << i;
  }
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  EXPECT_NEAR(length, 1.0, 1e-15);
  const Vec3 whole{0.02e5, -0.05e5, 0.03e5};
  const Mat3 turned =
      from_quaternion(Quaternion{s.q[0], s.q[1], s.q[2], s.q[3]}) * Exp(whole).matrix();
  const Mat3 reached = from_quaternion(Quaternion{q[0], q[1], q[2], q[3]});
  const double off = distance(SE3(turned, {}), SE3(reached, {}));
  std::printf("off after 100000 steps: %.1e\n", off);
  EXPECT_LT(off, 1e-10);
}

template <class T, int N>
void lanes_step_alike(double bound) {
  using P = PackT<T, N>;
  Random random(76);
  const Model model = random_tree(random, 14);
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): of double alone it is a copy
  const ModelT<T> narrow(model);
  std::vector<State> states;
  std::vector<P> q(static_cast<std::size_t>(model.coordinates())), out(q.size());
  std::vector<P> v(static_cast<std::size_t>(model.velocities())), back(v.size());
  for (int lane = 0; lane < N; ++lane) {
    states.push_back(random_state(random, model));
    State& s = states.back();
    for (double& x : s.v) x *= lane % 2 == 0 ? 1.0 : 1e-3;  // both sides of the threshold
    for (std::size_t i = 0; i < q.size(); ++i) q[i].set(lane, static_cast<T>(s.q[i]));
    for (std::size_t i = 0; i < v.size(); ++i) v[i].set(lane, static_cast<T>(s.v[i]));
  }
  integrate<P>(narrow, q, v, out);
  difference<P>(narrow, q, out, back);
  for (int lane = 0; lane < N; ++lane) {
    const State& s = states[static_cast<std::size_t>(lane)];
    const Numbers alone = stepped(model, s.q, s.v);
    for (std::size_t i = 0; i < q.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(out[i][lane]), alone[i], bound);
    }
    for (std::size_t i = 0; i < v.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(back[i][lane]), s.v[i], bound);
    }
  }
}

TEST(Integrate, GivesInEachLaneWhatOneStateGives) {
  lanes_step_alike<double, 4>(1e-14);
#ifndef VP_FEW_SCALARS
  lanes_step_alike<double, 8>(1e-14);
  lanes_step_alike<float, 8>(3e-6);
  lanes_step_alike<float, 16>(3e-6);
#endif
}

}  // namespace
}  // namespace vp::test
