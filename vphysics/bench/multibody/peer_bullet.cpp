// Bullet's btMultiBody, in Debian's build in double precision. Its links' frames are at the centre
// of mass, along the principal axes. A free base's velocity is that of its centre of mass, in world
// axes. It has forward dynamics only (btInverseDynamics, a separate library, is not in Debian).
#include <BulletDynamics/Featherstone/btMultiBody.h>

#include "engine.h"

namespace vp::bench {
namespace {

static_assert(sizeof(btScalar) == sizeof(double), "compile with Bullet's double precision");

btVector3 bullet(const Vec3& a) {
  return {a.x, a.y, a.z};
}
btQuaternion bullet(const Mat3& R) {
  const Quaternion q = to_quaternion(R);
  return {q.x, q.y, q.z, q.w};
}
Vec3 vector(const btScalar* x) {
  return {x[0], x[1], x[2]};
}

class Bullet final : public Engine {
 public:
  Bullet(const BenchModel& model, const std::vector<State>& states)
      : free_(model.free_base), joints_(static_cast<int>(model.links.size()) - (free_ ? 1 : 0)) {
    for (const LinkSpec& link : model.links) bodies_.push_back(principal_inertia(link.inertia));
    const PrincipalInertia none{0, {}, Mat3::identity(), {}};
    const PrincipalInertia& base = free_ ? bodies_.front() : none;
    body_ = std::make_unique<btMultiBody>(joints_, base.mass, bullet(base.moments), !free_, false);
    body_->setBasePos({0, 0, 0});
    body_->setWorldToBaseRot({0, 0, 0, 1});
    for (int joint = 0; joint < joints_; ++joint) {
      const std::size_t number = static_cast<std::size_t>(joint) + (free_ ? 1 : 0);
      const LinkSpec& link = model.links[number];
      const PrincipalInertia& J = bodies_[number];
      const PrincipalInertia& before =
          link.parent == kWorld ? none : bodies_[static_cast<std::size_t>(link.parent)];
      const SE3& T = link.T_parent_joint;
      const Mat3 turn = transpose(J.axes) * (transpose(T.rotation()) * before.axes);
      body_->setupRevolute(joint, J.mass, bullet(J.moments), link.parent - (free_ ? 1 : 0),
                           bullet(turn), bullet(transposed_times(J.axes, axis_of(link))),
                           bullet(transposed_times(before.axes, T.position() - before.centre)),
                           bullet(transposed_times(J.axes, J.centre)));
    }
    body_->setLinearDamping(0);
    body_->setAngularDamping(0);
    body_->setUseGyroTerm(true);
    body_->finalizeMultiDof();
    for (const State& s : states) states_.push_back(converted(s));
  }

  std::string lacks(Metric metric) const override {
    return metric == Metric::forward ? "" : "btMultiBody has no such call";
  }

  double call(Metric, std::size_t state) override {
    const Numbers& s = states_[state];
    body_->clearForcesAndTorques();
    if (free_) {
      body_->setBasePos(s.position);
      body_->setWorldToBaseRot(s.world_to_base);
      body_->setBaseVel(s.linear);
      body_->setBaseOmega(s.angular);
      body_->addBaseForce(s.force);
      body_->addBaseTorque(s.torque);
    }
    for (int joint = 0; joint < joints_; ++joint) {
      const auto i = static_cast<std::size_t>(joint);
      body_->setJointPos(joint, s.q[i]);
      body_->setJointVel(joint, s.v[i]);
      body_->addJointTorque(joint, s.tau[i]);
      body_->addLinkForce(joint, body_->getLinkMass(joint) * bullet(kGravity));
    }
    // With a time step of zero it does not change its velocities. The accelerations are in its
    // scratch memory.
    body_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(0, numbers_, vectors_, matrices_,
                                                                false, false, false);
    return accelerations()[5 + joints_];
  }

  std::vector<double> result(Metric metric, std::size_t state) override {
    call(metric, state);
    const btScalar* x = accelerations();
    std::vector<double> a;
    if (free_) {
      const Numbers& s = states_[state];
      const Vec3 angular = transposed_times(s.R, vector(x));
      const Vec3 centre = transposed_times(s.R, vector(x + 3));
      const Vec3& c = bodies_.front().centre;
      const Vec3 linear = centre - cross(s.w, s.u) - cross(angular, c) - cross(s.w, cross(s.w, c));
      a = {angular.x, angular.y, angular.z, linear.x, linear.y, linear.z};
    }
    a.insert(a.end(), x + 6, x + 6 + joints_);
    return a;
  }

 private:
  struct Numbers {
    btVector3 position, linear, angular, force, torque;
    btQuaternion world_to_base;
    std::vector<double> q, v, tau;  // of the joints
    Mat3 R;
    Vec3 w, u;  // velocity of the base, in our convention
  };

  // Converts a state; a free base's numbers are at its centre of mass.
  Numbers converted(const State& s) const {
    Numbers n;
    const std::ptrdiff_t q = free_ ? 7 : 0, v = free_ ? 6 : 0;
    n.q.assign(s.q.begin() + q, s.q.end());
    n.v.assign(s.v.begin() + v, s.v.end());
    n.tau.assign(s.tau.begin() + v, s.tau.end());
    if (!free_) return n;
    const PrincipalInertia& J = bodies_.front();
    const SE3 T = base_pose(s);
    n.R = T.rotation();
    n.w = vector(&s.v[0]);
    n.u = vector(&s.v[3]);
    const Vec3 m = vector(&s.tau[0]), f = vector(&s.tau[3]);
    n.position = bullet(T * J.centre);
    n.world_to_base = bullet(transpose(n.R * J.axes));
    n.angular = bullet(n.R * n.w);
    n.linear = bullet(n.R * (n.u + cross(n.w, J.centre)));
    n.force = bullet(n.R * f + J.mass * kGravity);
    n.torque = bullet(n.R * (m - cross(J.centre, f)));
    return n;
  }

  // The accelerations of the base, angular and linear, in world axes, then those of the joints.
  // They follow as many other numbers as there are joints.
  const btScalar* accelerations() const { return &numbers_[body_->getNumDofs()]; }

  bool free_;
  int joints_;
  std::vector<PrincipalInertia> bodies_;
  std::unique_ptr<btMultiBody> body_;
  std::vector<Numbers> states_;
  btAlignedObjectArray<btScalar> numbers_;
  btAlignedObjectArray<btVector3> vectors_;
  btAlignedObjectArray<btMatrix3x3> matrices_;
};

}  // namespace

MadeEngine make_bullet(const BenchModel& model, const std::vector<State>& states) {
  return std::make_unique<Bullet>(model, states);
}

}  // namespace vp::bench
