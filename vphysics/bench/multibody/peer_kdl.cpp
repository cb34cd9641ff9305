// KDL: a Chain with its recursive Newton-Euler and composite body solvers, and for forward dynamics
// Vereshchagin's hybrid solver, which without constraints is the articulated body algorithm (the
// other one, ChainFdSolver_RNE, is O(n^3)). It has no free joint.
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainhdsolver_vereshchagin.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

#include "engine.h"

namespace vp::bench {
namespace {

KDL::Vector kdl(const Vec3& a) {
  return {a.x, a.y, a.z};
}
KDL::Frame kdl(const SE3& T) {
  const Mat3& R = T.rotation();
  return {KDL::Rotation(kdl(R.cx), kdl(R.cy), kdl(R.cz)), kdl(T.position())};
}
KDL::JntArray kdl(const std::vector<double>& x) {
  KDL::JntArray out(static_cast<unsigned>(x.size()));
  out.data = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  return out;
}

// A joint's position and axis are in its parent's frame.
KDL::Chain build(const BenchModel& model) {
  KDL::Chain chain;
  for (const LinkSpec& link : model.links) {
    const Sym3 I = link.inertia.central();
    const KDL::RigidBodyInertia J(link.inertia.mass(), kdl(link.inertia.centre_of_mass()),
                                  KDL::RotationalInertia(I.xx, I.yy, I.zz, I.xy, I.zx, I.yz));
    const KDL::Joint joint(kdl(link.T_parent_joint.position()),
                           kdl(link.T_parent_joint.rotate(axis_of(link))), KDL::Joint::RotAxis);
    chain.addSegment(KDL::Segment(joint, kdl(link.T_parent_joint), J));
  }
  return chain;
}

class Kdl final : public Engine {
 public:
  Kdl(const BenchModel& model, const std::vector<State>& states)
      : chain_(build(model)),
        forward_(chain_, KDL::Twist(kdl(-kGravity), KDL::Vector::Zero()), 1),
        inverse_(chain_, kdl(kGravity)),
        parameters_(chain_, kdl(kGravity)),
        no_loads_(model.links.size()),
        no_constraint_(1),
        no_setpoint_(1),
        out_(chain_.getNrOfJoints()),
        constraint_torques_(chain_.getNrOfJoints()),
        M_(chain_.getNrOfJoints()) {
    for (const State& s : states) states_.push_back({kdl(s.q), kdl(s.v), kdl(s.tau), kdl(s.a)});
  }

  double call(Metric metric, std::size_t state) override {
    const Numbers& s = states_[state];
    int failed = 0;
    switch (metric) {
      case Metric::forward:
        failed = forward_.CartToJnt(s.q, s.v, out_, no_constraint_, no_setpoint_, no_loads_, s.tau,
                                    constraint_torques_);
        break;
      case Metric::inverse:
        failed = inverse_.CartToJnt(s.q, s.v, s.a, no_loads_, out_);
        break;
      case Metric::mass:
        failed = parameters_.JntToMass(s.q, M_);
        return failed < 0 ? kNaN : M_(0, 0);
    }
    return failed < 0 ? kNaN : out_(0);
  }

  std::vector<double> result(Metric metric, std::size_t state) override {
    call(metric, state);
    if (metric == Metric::mass) return {M_.data.data(), M_.data.data() + M_.data.size()};
    return {out_.data.data(), out_.data.data() + out_.data.size()};
  }

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  struct Numbers {
    KDL::JntArray q, v, tau, a;
  };
  KDL::Chain chain_;
  KDL::ChainHdSolver_Vereshchagin forward_;
  KDL::ChainIdSolver_RNE inverse_;
  KDL::ChainDynParam parameters_;
  std::vector<Numbers> states_;
  KDL::Wrenches no_loads_;
  KDL::Jacobian no_constraint_;
  KDL::JntArray no_setpoint_, out_, constraint_torques_;
  KDL::JntSpaceInertiaMatrix M_;
};

}  // namespace

MadeEngine make_kdl(const BenchModel& model, const std::vector<State>& states) {
  if (model.free_base) return tl::make_unexpected("it has no free joint");
  return std::make_unique<Kdl>(model, states);
}

}  // namespace vp::bench
