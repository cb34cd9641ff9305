// Articulated dynamics by independent routes: the paper's recursion of appendix A, inverse against
// forward dynamics, joints against their equivalents, conserved momentum.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "trees.h"
#include "vphysics/lie/dual.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;

Numbers forward(const Model& model, const State& s, const Loads& loads = {}) {
  Data data(model);
  Numbers a(s.v.size());
  const auto done = forward_dynamics<double>(model, data, s.q, s.v, s.tau, loads, a);
  EXPECT_TRUE(done) << done.error().message;
  return a;
}
Numbers inverse(const Model& model, const State& s, const Numbers& a, const Loads& loads = {}) {
  Data data(model);
  Numbers tau(s.v.size());
  inverse_dynamics<double>(model, data, s.q, s.v, a, loads, tau);
  return tau;
}

// Appendix A line by line, in the links' frames, for joints M_i e^(S_i q_i) with one degree of
// freedom. The only load is gravity, as an acceleration of the world.
Numbers appendix_a(const Model& model, const State& s, const Vec3& gravity) {
  const auto n = static_cast<std::size_t>(model.links());
  std::vector<SE3> f(n);
  std::vector<se3> S(n), V(n), c(n), V_dot(n);
  std::vector<Inertia> J(n);
  std::vector<AInertia> J_hat(n);
  std::vector<dse3> b(n);
  Numbers Omega(n), tau(n), q_ddot(n);
  for (std::size_t i = 0; i < n; ++i) {
    const LinkSpec& link = model.link(static_cast<int>(i));
    if (const auto* revolute = std::get_if<RevoluteJoint>(&link.joint)) {
      S[i] = {(1 / norm(revolute->axis)) * revolute->axis, {}};
    } else if (const auto* prismatic = std::get_if<PrismaticJoint>(&link.joint)) {
      S[i] = {{}, (1 / norm(prismatic->axis)) * prismatic->axis};
    } else {
      const auto& helical = std::get<HelicalJoint>(link.joint);
      const Vec3 axis = (1 / norm(helical.axis)) * helical.axis;
      S[i] = {axis, helical.pitch * axis};
    }
    J[i] = link.inertia;
    f[i] = link.T_parent_joint * Exp(s.q[i] * S[i]);
    const se3 before = link.parent == kWorld ? se3{} : V[static_cast<std::size_t>(link.parent)];
    V[i] = Ad(Inv(f[i]), before) + s.v[i] * S[i];
    c[i] = ad(V[i], s.v[i] * S[i]);
    tau[i] = s.tau[i] - link.damping * s.v[i];
    J_hat[i] = J[i];
    b[i] = -1.0 * dad(V[i], J[i] * V[i]);
  }
  for (std::size_t i = n; i-- > 0;) {
    const LinkSpec& link = model.link(static_cast<int>(i));
    const dse3 eta = J_hat[i] * S[i];
    Omega[i] = S[i] * eta + link.armature;
    if (link.parent == kWorld) continue;
    const auto p = static_cast<std::size_t>(link.parent);
    const dse3 beta = J_hat[i] * c[i] + b[i];
    J_hat[p] = J_hat[p] + (J_hat[i] - (eta * eta) / Omega[i]).Xform(Inv(f[i]));
    b[p] = b[p] + dAd(Inv(f[i]), beta) + ((tau[i] - S[i] * beta) / Omega[i]) * dAd(Inv(f[i]), eta);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const LinkSpec& link = model.link(static_cast<int>(i));
    const se3 before =
        link.parent == kWorld ? se3{{}, -gravity} : V_dot[static_cast<std::size_t>(link.parent)];
    const se3 carried = Ad(Inv(f[i]), before) + c[i];
    q_ddot[i] = (tau[i] - S[i] * (J_hat[i] * carried + b[i])) / Omega[i];
    V_dot[i] = carried + q_ddot[i] * S[i];
  }
  return q_ddot;
}

// Measured: 4e-14 of the largest.
TEST(ForwardDynamics, IsThePapersAppendixA) {
  Random random(41);
  for (int round = 0; round < 100; ++round) {
    const Model model = random_tree(random, 12, 3);
    const State s = random_state(random, model);
    const Loads loads{.gravity = {1.0, -2.0, -9.0}};
    const Numbers a = forward(model, s, loads), expected = appendix_a(model, s, loads.gravity);
    ASSERT_LT(largest_difference(a, expected), 1e-12 * (1 + largest_of(expected))) << round;
  }
}

TEST(ForwardDynamics, InvertsInverseDynamicsOnTreesOfEveryJoint) {
  Random random(42);
  double worst = 0.0;
  for (int round = 0; round < 200; ++round) {
    const Model model = random_tree(random, 15);
    const State s = random_state(random, model);
    std::vector<dse3> external(static_cast<std::size_t>(model.links()));
    for (dse3& F : external) F = {random.in_cube(1), random.in_cube(1)};
    const Loads loads{.gravity = random.in_cube(10), .external = external};
    const Numbers a = forward(model, s, loads), tau = inverse(model, s, a, loads);
    const double scale = 1 + largest_of(a);
    worst = std::max(worst, largest_difference(tau, s.tau) / scale);
    State t = s;
    t.tau = inverse(model, s, s.a, loads);
    worst = std::max(worst,
                     largest_difference(forward(model, t, loads), s.a) / (1 + largest_of(t.tau)));
  }
  std::printf("worst: %.1e\n", worst);
  EXPECT_LT(worst, 1e-12);
}

TEST(MassMatrix, HasInverseDynamicsForItsColumns) {
  Random random(43);
  for (int round = 0; round < 50; ++round) {
    const Model model = random_tree(random, 12);
    State s = random_state(random, model);
    const std::size_t n = s.v.size();
    std::fill(s.v.begin(), s.v.end(), 0.0);
    Data data(model);
    Numbers M(n * n);
    mass_matrix<double>(model, data, s.q, M);
    const Loads weightless{.gravity = {}};
    for (std::size_t k = 0; k < n; ++k) {
      Numbers unit(n);
      unit[k] = 1.0;
      const Numbers column = inverse(model, s, unit, weightless);
      for (std::size_t i = 0; i < n; ++i) {
        ASSERT_NEAR(M[i * n + k], column[i], 1e-12 * (1 + largest_of(column)));
        ASSERT_EQ(M[i * n + k], M[k * n + i]);
      }
    }
  }
}

// One link on the joint, and the same link on a chain of simpler joints without mass.
struct Equivalent {
  const char* name;
  Joint joint;
  std::vector<Joint> chain;
};

TEST(Joint, DoesWhatItsEquivalentDoes) {
  const Vec3 axis{0.6, 0, 0.8};
  const Equivalent cases[] = {
      {"cylindrical", CylindricalJoint{axis}, {PrismaticJoint{axis}, RevoluteJoint{axis}}},
      {"cylindrical, turned first",
       CylindricalJoint{axis},
       {PrismaticJoint{axis}, RevoluteJoint{axis}}},
      {"universal",
       UniversalJoint{{1, 0, 0}, axis},
       {RevoluteJoint{{1, 0, 0}}, RevoluteJoint{axis}}},
      {"planar",
       PlanarJoint{},
       {PrismaticJoint{{1, 0, 0}}, PrismaticJoint{{0, 1, 0}}, RevoluteJoint{{0, 0, 1}}}},
      {"helical of no pitch", HelicalJoint{axis, 0.0}, {RevoluteJoint{axis}}},
  };
  Random random(44);
  for (const Equivalent& e : cases) {
    Model models[2] = {random_tree(random, 1), random_tree(random, 1)};
    const Inertia body = random_body(random), tip = random_body(random);
    const SE3 place = random.pose(1), onwards = random.pose(1);
    for (int which = 0; which < 2; ++which) {
      ModelBuilder builder;
      must_build(builder.add({.name = "base", .joint = RevoluteJoint{}, .inertia = tip}));
      if (which == 0) {
        must_build(builder.add({"link", 0, e.joint, place, body}));
      } else {
        for (std::size_t i = 0; i < e.chain.size(); ++i) {
          const bool last = i + 1 == e.chain.size();
          must_build(builder.add({"part", static_cast<int>(i), e.chain[i], i == 0 ? place : SE3{},
                                  last ? body : Inertia{}}));
        }
      }
      const int last = which == 0 ? 1 : static_cast<int>(e.chain.size());
      must_build(builder.add({"tip", last, RevoluteJoint{{0, 1, 0}}, onwards, tip}));
      models[which] = must_build(builder.build());
    }
    for (int round = 0; round < 20; ++round) {
      const State s = random_state(random, models[0]);
      EXPECT_LT(largest_difference(forward(models[0], s), forward(models[1], s)), 1e-12) << e.name;
    }
  }
}

// Rates of quaternions are not rates of coordinates. A ball joint and three axes through one point
// are compared by the angular acceleration, in the link's frame.
TEST(Joint, BallDoesWhatThreeAxesInOnePointDo) {
  Random random(45);
  const Inertia body = random_body(random), tip = random_body(random);
  const SE3 onwards = random.pose(1);
  ModelBuilder one, three;
  must_build(one.add({"ball", kWorld, BallJoint{}, {}, body}));
  must_build(one.add({"tip", 0, RevoluteJoint{}, onwards, tip}));
  must_build(three.add({"x", kWorld, RevoluteJoint{{1, 0, 0}}, {}, {}}));
  must_build(three.add({"y", 0, RevoluteJoint{{0, 1, 0}}, {}, {}}));
  must_build(three.add({"z", 1, RevoluteJoint{{0, 0, 1}}, {}, body}));
  must_build(three.add({"tip", 2, RevoluteJoint{}, onwards, tip}));
  const Model ball = must_build(one.build()), axes = must_build(three.build());
  for (int round = 0; round < 50; ++round) {
    State s = random_state(random, axes);
    const Mat3 X = Exp(Vec3{s.q[0], 0, 0}).matrix(), Y = Exp(Vec3{0, s.q[1], 0}).matrix(),
               Z = Exp(Vec3{0, 0, s.q[2]}).matrix();
    // w = Z^T (Y^T ex x' + ey y') + ez z', all in the link's frame
    const Vec3 columns[3] = {transposed_times(Z, transposed_times(Y, Vec3{1, 0, 0})),
                             transposed_times(Z, Vec3{0, 1, 0}), Vec3{0, 0, 1}};
    s.tau[0] = s.tau[1] = s.tau[2] = 0.0;
    const Numbers a = forward(axes, s);
    State b;
    const Quaternion turn = to_quaternion(X * Y * Z);
    b.q = {turn.x, turn.y, turn.z, turn.w, s.q[3]};
    const Vec3 w = s.v[0] * columns[0] + s.v[1] * columns[1] + s.v[2] * columns[2];
    b.v = {w.x, w.y, w.z, s.v[3]};
    b.tau = {0, 0, 0, s.tau[3]};
    const Numbers c = forward(ball, b);
    // The rates of the columns: each rotates backwards with the axes after it.
    const Vec3 wz = s.v[2] * columns[2], wyz = wz + s.v[1] * columns[1];
    const Vec3 expected = a[0] * columns[0] + a[1] * columns[1] + a[2] * columns[2] +
                          s.v[0] * cross(columns[0], wyz) + s.v[1] * cross(columns[1], wz);
    EXPECT_LT(norm(Vec3{c[0], c[1], c[2]} - expected), 1e-11 * (1 + norm(expected)));
    EXPECT_NEAR(c[3], a[3], 1e-11 * (1 + std::fabs(a[3])));
  }
}

// A free body follows Euler's equations, also far from the origin.
TEST(Joint, FreeIsARigidBodyByItself) {
  Random random(46);
  for (const double away : {0.0, 1e3, 1e9}) {
    ModelBuilder builder;
    const Inertia J = random_body(random);
    must_build(builder.add({"body", kWorld, FreeJoint{}, SE3(Vec3{away, -away, away}), J}));
    const Model model = must_build(builder.build());
    for (int round = 0; round < 20; ++round) {
      const State s = random_state(random, model);
      const Numbers a = forward(model, s, {.gravity = {}});
      const se3 V{{s.v[0], s.v[1], s.v[2]}, {s.v[3], s.v[4], s.v[5]}};
      const se3 A{{a[0], a[1], a[2]}, {a[3], a[4], a[5]}};
      const dse3 F = J * A - dad(V, J * V);
      const double damping = model.link(0).damping;
      const double off = norm(F.m + damping * V.w - Vec3{s.tau[0], s.tau[1], s.tau[2]}) +
                         norm(F.f + damping * V.v - Vec3{s.tau[3], s.tau[4], s.tau[5]});
      EXPECT_LT(off, 1e-13) << away;
    }
  }
}

// V is the rate of the pose: each link's velocity against the difference quotient of its pose along
// v.
TEST(Kinematics, VelocityIsTheSlopeOfThePose) {
  Random random(47);
  for (int round = 0; round < 20; ++round) {
    const Model model = random_tree(random, 12, 9);
    const State s = random_state(random, model);
    Data data(model);
    const auto poses_at = [&](double h) {
      Numbers q = s.q;
      for (int link = 0; link < model.links(); ++link) {
        const Joint& joint = model.link(link).joint;
        const auto c = static_cast<std::size_t>(model.first_coordinate(link));
        const auto v = static_cast<std::size_t>(model.first_velocity(link));
        if (std::holds_alternative<BallJoint>(joint) || std::holds_alternative<FreeJoint>(joint)) {
          const bool free = std::holds_alternative<FreeJoint>(joint);
          const std::size_t at = c + (free ? 3 : 0);
          const Mat3 R = from_quaternion(Quaternion{q[at], q[at + 1], q[at + 2], q[at + 3]});
          const se3 V{{s.v[v], s.v[v + 1], s.v[v + 2]},
                      free ? Vec3{s.v[v + 3], s.v[v + 4], s.v[v + 5]} : Vec3{}};
          const SE3 moved = SE3(R, free ? Vec3{q[c], q[c + 1], q[c + 2]} : Vec3{}) * Exp(h * V);
          const Quaternion turn = to_quaternion(moved.rotation());
          q[at] = turn.x, q[at + 1] = turn.y, q[at + 2] = turn.z, q[at + 3] = turn.w;
          for (std::size_t k = 0; free && k < 3; ++k) {
            q[c + k] = moved.position()[static_cast<int>(k)];
          }
          continue;
        }
        for (std::size_t k = 0; k < static_cast<std::size_t>(coordinates_of(joint)); ++k) {
          q[c + k] += h * s.v[v + k];
        }
      }
      forward_kinematics<double>(model, data, q, s.v);
      std::vector<SE3> poses;
      for (int link = 0; link < model.links(); ++link) {
        poses.push_back(T_world_link<double>(model, data, link));
      }
      return poses;
    };
    constexpr double kStep = 1e-4;
    const std::vector<SE3> before = poses_at(-kStep), after = poses_at(kStep), now = poses_at(0.0);
    for (int link = 0; link < model.links(); ++link) {
      const auto l = static_cast<std::size_t>(link);
      const se3 slope = (0.5 / kStep) * Log(Inv(before[l]) * after[l]);
      const se3 V = link_velocity<double>(model, data, link);
      ASSERT_LT(norm(slope.w - V.w) + norm(slope.v - V.v), 3e-6) << link;
    }
  }
}

template <class T, int N>
void lanes_agree(double bound) {
  using P = PackT<T, N>;
  Random random(48);
  const Model model = random_tree(random, 14);
  const ModelT<T> narrow(model);
  DataT<P> data(narrow);
  std::vector<State> states;
  std::vector<P> q(static_cast<std::size_t>(model.coordinates())),
      v(static_cast<std::size_t>(model.velocities())), tau(v.size()), a(v.size());
  for (int lane = 0; lane < N; ++lane) {
    states.push_back(random_state(random, model));
    const State& s = states.back();
    for (std::size_t i = 0; i < q.size(); ++i) q[i].set(lane, static_cast<T>(s.q[i]));
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i].set(lane, static_cast<T>(s.v[i]));
      tau[i].set(lane, static_cast<T>(s.tau[i]));
    }
  }
  ASSERT_TRUE(forward_dynamics<P>(narrow, data, q, v, tau, {}, a));
  std::vector<P> back(v.size());
  inverse_dynamics<P>(narrow, data, q, v, a, {}, back);
  for (int lane = 0; lane < N; ++lane) {
    const Numbers alone = forward(model, states[static_cast<std::size_t>(lane)]);
    for (std::size_t i = 0; i < v.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(a[i][lane]), alone[i], bound * (1 + largest_of(alone)));
      EXPECT_NEAR(static_cast<double>(back[i][lane]), static_cast<double>(tau[i][lane]),
                  bound * (1 + largest_of(alone)));
    }
  }
}

TEST(Batch, GivesInEachLaneWhatOneStateGives) {
  lanes_agree<double, 4>(1e-12);
#ifndef VP_FEW_SCALARS
  lanes_agree<double, 8>(1e-12);
  lanes_agree<float, 8>(2e-4);
  lanes_agree<float, 16>(2e-4);
#endif
}

// --- rejected arguments

std::string why(const LinkSpec& link) {
  ModelBuilder builder;
  const auto made = builder.add(link);
  return made ? "" : made.error().message;
}

TEST(Model, RefusesWhatNoLinkIs) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Inertia body(1.0, Vec3{1, 1, 1});
  EXPECT_NE(why({.name = "arm", .parent = 3, .inertia = body}).find("\"arm\""), std::string::npos);
  EXPECT_NE(why({.joint = RevoluteJoint{{0, 0, 0}}, .inertia = body}), "");
  EXPECT_NE(why({.joint = RevoluteJoint{{0, nan, 1}}, .inertia = body}), "");
  EXPECT_NE(why({.joint = HelicalJoint{{0, 0, 1}, nan}, .inertia = body}), "");
  EXPECT_NE(why({.joint = UniversalJoint{{1, 0, 0}, {-2, 0, 0}}, .inertia = body}), "");
  EXPECT_NE(why({.joint = std::shared_ptr<const UserJoint>{}, .inertia = body}), "");
  EXPECT_NE(why({.T_parent_joint = SE3(Vec3{nan, 0, 0}), .inertia = body}), "");
  EXPECT_NE(
      why({.T_parent_joint = SE3(Mat3{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}), .inertia = body}), "");
  EXPECT_NE(why({.inertia = Inertia(-1.0, Vec3{1, 1, 1})}), "");
  EXPECT_NE(why({.inertia = Inertia(1.0, Vec3{1, 1, 3})}), "");
  EXPECT_NE(why({.inertia = Inertia(1.0, Vec3{1, -1, 1})}), "");
  EXPECT_NE(why({.inertia = Inertia(1.0, Vec3{5, 0, 0}, Sym3{1, 1, 1, 0, 0, 0})}), "");
  EXPECT_NE(why({.inertia = body, .armature = -1.0}), "");
  EXPECT_NE(why({.inertia = body, .damping = nan}), "");
  EXPECT_EQ(why({.joint = RevoluteJoint{}, .inertia = body}), "");
  EXPECT_EQ(why({.inertia = Inertia(1.0, Vec3{1, 1, 2})}), "");  // a disc
  EXPECT_EQ(why({.inertia = Inertia(1.0, Vec3{0, 1, 1})}), "");  // a needle
}

TEST(Model, JudgesAnInertiaAlikeHoweverItsAxesLie) {
  Random random(49);
  for (int round = 0; round < 200; ++round) {
    const SE3 place = random.pose(0.5);
    const Inertia rod(2.0, Vec3{1.0, 0.98, 0.03}), no_body(2.0, Vec3{1.0, 0.9, 0.05});
    EXPECT_EQ(why({.inertia = rod.Xform(place)}), "");
    EXPECT_NE(why({.inertia = no_body.Xform(place)}), "");
  }
}

TEST(Model, RefusesAJointThatMovesNoMass) {
  ModelBuilder builder;
  must_build(builder.add({.name = "empty", .joint = RevoluteJoint{}}));
  const auto refused = builder.build();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("\"empty\""), std::string::npos);
  EXPECT_FALSE(ModelBuilder().build());
}

TEST(ForwardDynamics, SaysWhereAJointMovesNoInertiaHere) {
  // A needle that rotates about its own axis.
  ModelBuilder builder;
  must_build(builder.add({.joint = RevoluteJoint{}, .inertia = Inertia(1.0, Vec3{1, 1, 0})}));
  const Model model = must_build(builder.build());
  Data data(model);
  Numbers q(1), v(1), tau(1), a(1);
  const auto done = forward_dynamics<double>(model, data, q, v, tau, {}, a);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::singular);
}

// A rounding error is not an inertia: half of these trees have an Omega above zero only by
// rounding.
TEST(ForwardDynamics, TakesNoRoundingForAnInertia) {
  Random random(175);
  for (int round = 0; round < 100; ++round) {
    const Vec3 axis = random.direction(), place = random.in_cube(1.0);
    const Inertia point = Inertia(1.0, Vec3{}).Xform(SE3(random.uniform(0.1, 1.0) * axis));
    const auto add = [](ModelBuilder& builder, int parent, const Joint& joint, const SE3& T,
                        const Inertia& J) {
      must_build(
          builder.add({.parent = parent, .joint = joint, .T_parent_joint = T, .inertia = J}));
    };
    ModelBuilder on_its_axis, coaxial, floating;
    add(on_its_axis, kWorld, RevoluteJoint{random.direction()}, SE3(place), random_body(random));
    add(on_its_axis, 0, RevoluteJoint{axis}, SE3(place), point);
    add(coaxial, kWorld, RevoluteJoint{random.direction()}, SE3(place), random_body(random));
    add(coaxial, 0, RevoluteJoint{axis}, random.pose(0.5), {});
    add(coaxial, 1, RevoluteJoint{axis}, SE3(0.3 * axis), random_body(random));
    add(floating, kWorld, FreeJoint{}, SE3(place), point);
    for (ModelBuilder* builder : {&on_its_axis, &coaxial, &floating}) {
      const Model model = must_build(builder->build());
      const State s = random_state(random, model);
      for (const Arithmetic arithmetic : {Arithmetic::fastest, Arithmetic::reproducible}) {
        Data data(model, arithmetic);
        Numbers a(s.v.size());
        const auto done = forward_dynamics<double>(model, data, s.q, s.v, s.tau, {}, a);
        ASSERT_FALSE(done) << "round " << round << ", a up to " << largest_of(a);
        EXPECT_EQ(done.error().code, Errc::singular);
      }
    }
  }
}

TEST(Joints, ThinkNothingOfAnAxisLength) {
  Random random(176);
  const Vec3 axis = random.direction();
  const auto moved = [&](const Joint& joint) {
    ModelBuilder builder;
    must_build(builder.add({.joint = joint, .inertia = Inertia(1.0, Vec3{1, 2, 2})}));
    const Model model = must_build(builder.build());
    Data data(model);
    const Numbers q(static_cast<std::size_t>(model.coordinates()), 0.7);
    forward_kinematics<double>(model, data, q, {});
    return T_world_link(model, data, 0);
  };
  const auto expect_same = [&](const Joint& a, const Joint& b) {
    EXPECT_LT(norm(Log(Inv(moved(a)) * moved(b)).w), 1e-14);
    EXPECT_LT(norm(moved(a).position() - moved(b).position()), 1e-14);
  };
  expect_same(RevoluteJoint{axis}, RevoluteJoint{3.0 * axis});
  expect_same(PrismaticJoint{axis}, PrismaticJoint{3.0 * axis});
  expect_same(HelicalJoint{axis, 0.1}, HelicalJoint{3.0 * axis, 0.1});
  expect_same(CylindricalJoint{axis}, CylindricalJoint{3.0 * axis});
  const Vec3 second = random.direction();
  expect_same(UniversalJoint{axis, second}, UniversalJoint{3.0 * axis, 0.2 * second});
}

}  // namespace
}  // namespace vp::test
