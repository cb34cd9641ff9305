// DART: a Skeleton. Its free joint has a rotation vector and a position; velocities as in our
// convention.
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>

#include "engine.h"

namespace vp::bench {
namespace {

namespace dd = dart::dynamics;

Eigen::Vector3d eigen(const Vec3& a) {
  return {a.x, a.y, a.z};
}
Eigen::Isometry3d eigen(const SE3& T) {
  const Mat3& R = T.rotation();
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() << R.cx.x, R.cy.x, R.cz.x, R.cx.y, R.cy.y, R.cz.y, R.cx.z, R.cy.z, R.cz.z;
  out.translation() = eigen(T.position());
  return out;
}
Eigen::VectorXd eigen(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

dd::BodyNode::Properties body_of(const LinkSpec& link, std::size_t number) {
  const Sym3 I = link.inertia.central();
  dd::BodyNode::Properties body;
  body.mName = "link " + std::to_string(number);
  body.mInertia.setMass(link.inertia.mass());
  body.mInertia.setLocalCOM(eigen(link.inertia.centre_of_mass()));
  body.mInertia.setMoment(I.xx, I.yy, I.zz, I.xy, I.zx, I.yz);
  return body;
}

dd::SkeletonPtr build(const BenchModel& model) {
  const dd::SkeletonPtr skeleton = dd::Skeleton::create(model.name);
  skeleton->setGravity(eigen(kGravity));
  std::vector<dd::BodyNode*> bodies;
  for (const LinkSpec& link : model.links) {
    dd::BodyNode* parent =
        link.parent == kWorld ? nullptr : bodies[static_cast<std::size_t>(link.parent)];
    const auto body = body_of(link, bodies.size());
    const std::string name = "joint " + std::to_string(bodies.size());
    if (std::holds_alternative<FreeJoint>(link.joint)) {
      dd::FreeJoint::Properties joint;
      joint.mName = name;
      bodies.push_back(
          skeleton->createJointAndBodyNodePair<dd::FreeJoint>(parent, joint, body).second);
      continue;
    }
    dd::RevoluteJoint::Properties joint;
    joint.mName = name;
    joint.mAxis = eigen(axis_of(link));
    joint.mT_ParentBodyToJoint = eigen(link.T_parent_joint);
    bodies.push_back(
        skeleton->createJointAndBodyNodePair<dd::RevoluteJoint>(parent, joint, body).second);
  }
  return skeleton;
}

class Dart final : public Engine {
 public:
  Dart(const BenchModel& model, const std::vector<State>& states) : skeleton_(build(model)) {
    for (const State& s : states) {
      Numbers n{eigen(s.q), eigen(s.v), eigen(s.tau), eigen(s.a)};
      if (model.free_base) {
        n.q = Eigen::VectorXd(s.q.size() - 1);
        n.q.head<6>() = dd::FreeJoint::convertToPositions(eigen(base_pose(s)));
        n.q.tail(n.q.size() - 6) = eigen(s.q).tail(n.q.size() - 6);
      }
      states_.push_back(std::move(n));
    }
  }

  double call(Metric metric, std::size_t state) override {
    const Numbers& s = states_[state];
    skeleton_->setPositions(s.q);
    if (metric == Metric::mass) return skeleton_->getMassMatrix()(0, 0);
    skeleton_->setVelocities(s.v);
    if (metric == Metric::inverse) {
      skeleton_->setAccelerations(s.a);
      skeleton_->computeInverseDynamics();
      out_ = skeleton_->getForces();
    } else {
      skeleton_->setForces(s.tau);
      skeleton_->computeForwardDynamics();
      out_ = skeleton_->getAccelerations();
    }
    return out_[0];
  }

  std::vector<double> result(Metric metric, std::size_t state) override {
    call(metric, state);
    if (metric != Metric::mass) return {out_.data(), out_.data() + out_.size()};
    const Eigen::MatrixXd& M = skeleton_->getMassMatrix();
    return {M.data(), M.data() + M.size()};
  }

 private:
  struct Numbers {
    Eigen::VectorXd q, v, tau, a;
  };
  dd::SkeletonPtr skeleton_;
  std::vector<Numbers> states_;
  Eigen::VectorXd out_;
};

}  // namespace

MadeEngine make_dart(const BenchModel& model, const std::vector<State>& states) {
  return std::make_unique<Dart>(model, states);
}

}  // namespace vp::bench
