// DART's world. It supports only semi-implicit Euler: its RK4Integrator is abstract, a remnant of
// versions in which the integrator could be selected.
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/simulation/World.hpp>

#include "system.h"

namespace vp::bench {
namespace {

namespace dd = dart::dynamics;

Eigen::Vector3d eigen(const Vec3& a) {
  return {a.x, a.y, a.z};
}

dd::SkeletonPtr build(const System& system) {
  const dd::SkeletonPtr skeleton = dd::Skeleton::create(system.name);
  dd::BodyNode* last = nullptr;  // both systems are chains
  for (int i = 0; i < system.model.links(); ++i) {
    const LinkSpec& link = system.model.link(i);
    const Sym3 I = link.inertia.central();
    dd::BodyNode::Properties body;
    body.mName = link.name;
    body.mInertia.setMass(link.inertia.mass());
    body.mInertia.setLocalCOM(eigen(link.inertia.centre_of_mass()));
    body.mInertia.setMoment(I.xx, I.yy, I.zz, I.xy, I.zx, I.yz);
    if (const auto* hinge = std::get_if<RevoluteJoint>(&link.joint)) {
      dd::RevoluteJoint::Properties joint;
      joint.mName = "joint of " + link.name;
      joint.mAxis = eigen(hinge->axis);
      joint.mT_ParentBodyToJoint.translation() = eigen(link.T_parent_joint.position());
      last = skeleton->createJointAndBodyNodePair<dd::RevoluteJoint>(last, joint, body).second;
    } else {
      last = skeleton->createJointAndBodyNodePair<dd::FreeJoint>(last, {}, body).second;
    }
  }
  // At zero coordinates. A free joint's velocities are (angular, linear) in the link's frame, as in
  // our convention.
  for (std::size_t i = 0; i < system.start.v.size(); ++i) {
    skeleton->setVelocity(i, system.start.v[i]);
  }
  skeleton->setGravity(eigen(system.gravity));
  return skeleton;
}

class Dart final : public Mover {
 public:
  explicit Dart(const System& system)
      : skeleton_(build(system)),
        world_(dart::simulation::World::create()),
        free_(system.model.coordinates() != system.model.velocities()) {
    name = "DART: semi-implicit Euler";
    world_->setTimeStep(kStep);
    world_->setGravity(eigen(system.gravity));
    world_->addSkeleton(skeleton_);
  }

  void advance(int steps) override {
    for (int i = 0; i < steps; ++i) world_->step();
  }
  State state() const override {
    const Eigen::VectorXd q = skeleton_->getPositions(), v = skeleton_->getVelocities();
    State s{{q.data(), q.data() + q.size()}, {v.data(), v.data() + v.size()}};
    if (!free_) return s;
    const Eigen::Isometry3d& T = skeleton_->getBodyNode(0)->getWorldTransform();
    const Eigen::Quaterniond turn(T.linear());
    const Eigen::Vector3d& p = T.translation();
    s.q = {p.x(), p.y(), p.z(), turn.x(), turn.y(), turn.z(), turn.w()};
    return s;
  }

 private:
  dd::SkeletonPtr skeleton_;
  dart::simulation::WorldPtr world_;
  bool free_;
};

}  // namespace

std::vector<std::unique_ptr<Mover>> dart_movers(const System& system) {
  std::vector<std::unique_ptr<Mover>> awake_bodies;
  awake_bodies.push_back(std::make_unique<Dart>(system));
  return awake_bodies;
}

}  // namespace vp::bench
