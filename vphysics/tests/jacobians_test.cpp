// Jacobians against velocities and poses of links; their rates against difference quotients.
#include "vphysics/multibody/jacobians.h"

#include <gtest/gtest.h>

#include <cmath>

#include "screws_joint.h"

namespace vp::test {
namespace {

using Numbers = std::vector<double>;
constexpr Frame kFrames[] = {Frame::link, Frame::world_at_link, Frame::world};

double size(const se3& V) {
  return norm(V.w) + norm(V.v);
}
double size(const Vec3& u) {
  return norm(u);
}
template <class Column>
Column times(const std::vector<Column>& J, const Numbers& v) {
  Column sum{};
  for (std::size_t k = 0; k < J.size(); ++k) sum = sum + v[k] * J[k];
  return sum;
}
template <class Column>
double difference(const std::vector<Column>& A, const std::vector<Column>& B) {
  double worst = 0.0;
  for (std::size_t k = 0; k < A.size(); ++k) worst = std::max(worst, size(A[k] - B[k]));
  return worst;
}

// The calls under test, for a link.
struct OfLink {
  using Column = se3;
  int link;
  Frame frame;
  void jacobian(const Model& m, const Data& d, std::vector<se3>& J) const {
    link_jacobian<double>(m, d, link, frame, J);
  }
  Expected<void> rate(const Model& m, const Data& d, const Numbers& q, const Numbers& v,
                      std::vector<se3>& J) const {
    return link_jacobian_rate<double>(m, d, q, v, link, frame, J);
  }
  se3 drift(const Model& m, const Data& d, const Numbers& q, const Numbers& v) const {
    return link_drift<double>(m, d, q, v, link, frame);
  }
};
struct OfPoint {
  using Column = Vec3;
  int link;
  Frame frame;
  Vec3 point{0.3, -0.2, 0.5};
  void jacobian(const Model& m, const Data& d, std::vector<Vec3>& J) const {
    point_jacobian<double>(m, d, link, point, frame, J);
  }
  Expected<void> rate(const Model& m, const Data& d, const Numbers& q, const Numbers& v,
                      std::vector<Vec3>& J) const {
    return point_jacobian_rate<double>(m, d, q, v, link, point, frame, J);
  }
  Vec3 drift(const Model& m, const Data& d, const Numbers& q, const Numbers& v) const {
    return point_drift<double>(m, d, q, v, link, point, frame);
  }
};

// The velocity in a frame as the frame's definition gives it, from the link's pose and motion.
se3 expected(const SE3& T, const se3& V, Frame frame) {
  if (frame == Frame::link) return V;
  const se3 there{T.rotate(V.w), T.rotate(V.v)};
  if (frame == Frame::world_at_link) return there;
  return {there.w, there.v + cross(there.w, Vec3{} - T.position())};
}

// Measured: 3e-15 of the largest.
TEST(Jacobian, TimesTheVelocitiesIsTheLinksVelocity) {
  Random random(81);
  for (int round = 0; round < 100; ++round) {
    const Model model = tree_with_screws(random, 12);
    const State s = random_state(random, model);
    Data data(model);
    forward_kinematics<double>(model, data, s.q, s.v);
    std::vector<se3> J(s.v.size());
    std::vector<Vec3> P(s.v.size());
    for (int link = 0; link < model.links(); ++link) {
      const SE3 T = T_world_link<double>(model, data, link);
      const se3 V = link_velocity<double>(model, data, link);
      for (const Frame frame : kFrames) {
        const OfPoint of{link, frame};
        OfLink{link, frame}.jacobian(model, data, J);
        of.jacobian(model, data, P);
        const Vec3 u = V.v + cross(V.w, of.point);
        const double scale = 1e-13 * (1 + size(V) + norm(T.position()) * size(V));
        ASSERT_LT(size(times(J, s.v) - expected(T, V, frame)), scale);
        ASSERT_LT(size(times(P, s.v) - (frame == Frame::link ? u : T.rotate(u))), scale);
      }
    }
  }
}

// Each column against the pose itself: the error of the difference quotient falls with the square
// of the step.
TEST(Jacobian, ColumnsAreTheSlopesOfThePose) {
  Random random(82);
  for (int round = 0; round < 8; ++round) {
    const Model model = tree_with_screws(random, 8);
    const State s = random_state(random, model);
    Data data(model);
    const int link = model.links() - 1;
    const auto pose = [&](std::size_t k, double h) {
      Numbers delta(s.v.size());
      delta[k] = h;
      forward_kinematics<double>(model, data, stepped(model, s.q, delta), s.v);
      return T_world_link<double>(model, data, link);
    };
    forward_kinematics<double>(model, data, s.q, s.v);
    std::vector<se3> J(s.v.size());
    link_jacobian<double>(model, data, link, Frame::link, J);
    double errors[2] = {};
    for (std::size_t k = 0; k < J.size(); ++k) {
      for (int i = 0; i < 2; ++i) {
        const double h = i == 0 ? 2e-3 : 1e-3;
        const se3 slope = (0.5 / h) * Log(Inv(pose(k, -h)) * pose(k, h));
        errors[i] = std::max(errors[i], size(slope - J[k]));
      }
    }
    ASSERT_LT(errors[1], 1e-4);
    if (errors[1] > 1e-9) {
      ASSERT_NEAR(errors[0] / errors[1], 4.0, 0.1) << round;
    }
  }
}

template <class Of>
void check_rates(unsigned seed) {
  Random random(seed);
  double worst_drift = 0.0, worst_rate = 0.0;
  int checked = 0;
  for (int round = 0; round < 15; ++round) {
    const Model model = tree_with_screws(random, 8);
    const State s = random_state(random, model);
    const std::size_t n = s.v.size();
    Data data(model);
    const int link = model.links() - 1;
    for (const Frame frame : kFrames) {
      const Of of{link, frame};
      using Columns = std::vector<typename Of::Column>;
      const auto at = [&](double h) {
        forward_kinematics<double>(model, data, stepped(model, s.q, s.v, h), s.v);
        Columns J(n);
        of.jacobian(model, data, J);
        return J;
      };
      const auto slope = [&](double h) {
        Columns after = at(h), before = at(-h);
        for (std::size_t k = 0; k < n; ++k) after[k] = (0.5 / h) * (after[k] - before[k]);
        return after;
      };
      const Columns coarse = slope(2e-3), fine = slope(1e-3);
      forward_kinematics<double>(model, data, s.q, s.v);
      Columns rate(n);
      const auto done = of.rate(model, data, s.q, s.v, rate);
      ASSERT_TRUE(done) << done.error().message;
      const double error = difference(fine, rate), before = difference(coarse, rate);
      double scale = 1;
      for (const auto& column : rate) scale = std::max(scale, size(column));
      ASSERT_LT(error, 1e-3 * scale);
      if (error > 1e-8) {
        ASSERT_NEAR(before / error, 4.0, 0.1) << round;
        ++checked;
      }
      worst_rate = std::max(worst_rate, error / scale);
      worst_drift =
          std::max(worst_drift, size(of.drift(model, data, s.q, s.v) - times(rate, s.v)) / scale);
    }
  }
  std::printf("off the slope: %.1e, drift off J' v: %.1e\n", worst_rate, worst_drift);
  EXPECT_LT(worst_drift, 1e-13);
  EXPECT_GT(checked, 20);  // of 45; some last links have only two joints to the root
}

TEST(JacobianRate, IsTheSlopeOfTheJacobianOfALink) {
  check_rates<OfLink>(83);
}
TEST(JacobianRate, IsTheSlopeOfTheJacobianOfAPoint) {
  check_rates<OfPoint>(84);
}

Model with_joint(Random& random, std::shared_ptr<const UserJoint> joint) {
  ModelBuilder builder;
  must_build(builder.add({"base", kWorld, RevoluteJoint{}, random.pose(1), random_body(random)}));
  must_build(builder.add({"own", 0, std::move(joint), random.pose(1), random_body(random)}));
  must_build(builder.add({"fixed", kWorld, FixedJoint{}, random.pose(1), random_body(random)}));
  return must_build(builder.build());
}

TEST(JacobianRate, NeedsTheSlopesOnlyOfSeveralDegreesAndOnTheWay) {
  Random random(85);
  const Model one = with_joint(random, std::make_shared<ScrewsJoint<1>>(random, false));
  const Model two = with_joint(random, std::make_shared<ScrewsJoint<2>>(random, false));
  for (const Model* model : {&one, &two}) {
    const State s = random_state(random, *model);
    Data data(*model);
    forward_kinematics<double>(*model, data, s.q, s.v);
    std::vector<se3> rate(s.v.size());
    EXPECT_TRUE(link_jacobian_rate<double>(*model, data, s.q, s.v, 0, Frame::link, rate));
    const auto done = link_jacobian_rate<double>(*model, data, s.q, s.v, 1, Frame::link, rate);
    EXPECT_EQ(static_cast<bool>(done), model == &one);
    if (done) continue;
    EXPECT_EQ(done.error().code, Errc::unsupported);
    EXPECT_NE(done.error().message.find("UserJoint::subspace_derivatives"), std::string::npos);
    std::vector<Vec3> points(s.v.size());
    EXPECT_FALSE(point_jacobian_rate<double>(*model, data, s.q, s.v, 1, {}, Frame::world, points));
  }
}

TEST(Jacobian, OfALinkThatIsFixedToTheWorldIsZero) {
  Random random(86);
  const Model model = with_joint(random, std::make_shared<SliderOnACurve>());
  const State s = random_state(random, model);
  Data data(model);
  forward_kinematics<double>(model, data, s.q, s.v);
  std::vector<se3> J(s.v.size(), se3{{1, 1, 1}, {1, 1, 1}});
  link_jacobian<double>(model, data, 2, Frame::world, J);
  for (const se3& column : J) EXPECT_EQ(column, se3{});
  J.assign(s.v.size(), se3{{1, 1, 1}, {1, 1, 1}});
  ASSERT_TRUE(link_jacobian_rate<double>(model, data, s.q, s.v, 2, Frame::world, J));
  for (const se3& column : J) EXPECT_EQ(column, se3{});
  EXPECT_EQ(link_drift<double>(model, data, s.q, s.v, 2, Frame::world), se3{});
}

// Forces at a point, mapped to the joints by the transposed Jacobian, act as external loads do.
TEST(Jacobian, TransposedCarriesAForceToTheJoints) {
  Random random(87);
  for (int round = 0; round < 20; ++round) {
    const Model model = random_tree(random, 10);
    const State s = random_state(random, model);
    Data data(model);
    const int link = model.links() - 1;
    const Vec3 point = random.in_cube(1), force = random.in_cube(5);  // in the link's frame
    std::vector<dse3> external(static_cast<std::size_t>(model.links()));
    external[static_cast<std::size_t>(link)] = {cross(point, force), force};
    Numbers with(s.v.size()), without(s.v.size());
    inverse_dynamics<double>(model, data, s.q, s.v, s.a, {.external = external}, with);
    inverse_dynamics<double>(model, data, s.q, s.v, s.a, {}, without);
    forward_kinematics<double>(model, data, s.q, s.v);
    std::vector<Vec3> J(s.v.size());
    point_jacobian<double>(model, data, link, point, Frame::link, J);
    for (std::size_t k = 0; k < J.size(); ++k) {
      ASSERT_NEAR(without[k] - with[k], dot(J[k], force), 1e-12 * (1 + largest_of(without)));
    }
  }
}

TEST(Jacobian, OfFloatsAndOfLanesIsThatOfDoubles) {
  Random random(88);
  const Model model = random_tree(random, 12);
  const ModelT<float> narrow(model);
  using P = PackT<double, 4>;
  Data data(model);
  DataT<float> floats(narrow);
  DataT<P> lanes(model);
  const State s = random_state(random, model);
  const std::size_t n = s.v.size();
  const std::vector<float> qf(s.q.begin(), s.q.end()), vf(s.v.begin(), s.v.end());
  const std::vector<P> qp(s.q.begin(), s.q.end()), vp(s.v.begin(), s.v.end());
  forward_kinematics<double>(model, data, s.q, s.v);
  forward_kinematics<float>(narrow, floats, qf, vf);
  forward_kinematics<P>(model, lanes, qp, vp);
  std::vector<se3> J(n), rate(n);
  std::vector<se3T<float>> Jf(n), rate_f(n);
  std::vector<se3T<P>> Jp(n);
  for (int link = 0; link < model.links(); ++link) {
    for (const Frame frame : kFrames) {
      link_jacobian<double>(model, data, link, frame, J);
      link_jacobian<float>(narrow, floats, link, frame, Jf);
      link_jacobian<P>(model, lanes, link, frame, Jp);
      ASSERT_TRUE(link_jacobian_rate<double>(model, data, s.q, s.v, link, frame, rate));
      ASSERT_TRUE(link_jacobian_rate<float>(narrow, floats, qf, vf, link, frame, rate_f));
      for (std::size_t k = 0; k < n; ++k) {
        for (int i = 0; i < 3; ++i) {
          ASSERT_NEAR(static_cast<double>(Jf[k].v[i]), J[k].v[i], 1e-5);
          ASSERT_NEAR(static_cast<double>(rate_f[k].v[i]), rate[k].v[i], 1e-4);
          ASSERT_NEAR(Jp[k].v[i][2], J[k].v[i], 1e-13);
        }
      }
    }
  }
}

}  // namespace
}  // namespace vp::test
