// Bullet, single precision as its package has it: sequential impulses with 10 iterations, split
// impulses, a dynamic tree as broad phase; all its defaults. Bullet multiplies two surfaces'
// friction and so has the root of ours each.
#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "engine.h"

namespace rigid {
namespace {

btVector3 vector(const vp::Vec3& a) {
  return {static_cast<btScalar>(a.x), static_cast<btScalar>(a.y), static_cast<btScalar>(a.z)};
}
btTransform transform(const vp::SE3& T) {
  const vp::Mat3& R = T.rotation();
  const btMatrix3x3 basis(
      static_cast<btScalar>(R.cx.x), static_cast<btScalar>(R.cy.x), static_cast<btScalar>(R.cz.x),
      static_cast<btScalar>(R.cx.y), static_cast<btScalar>(R.cy.y), static_cast<btScalar>(R.cz.y),
      static_cast<btScalar>(R.cx.z), static_cast<btScalar>(R.cy.z), static_cast<btScalar>(R.cz.z));
  return btTransform(basis, vector(T.position()));
}
vp::SE3 pose_of(const btTransform& T) {
  const auto column = [&](int i) {
    const btVector3 c = T.getBasis().getColumn(i);
    return vp::Vec3{c.x(), c.y(), c.z()};
  };
  const btVector3& p = T.getOrigin();
  return {vp::Mat3{column(0), column(1), column(2)}, {p.x(), p.y(), p.z()}};
}

std::unique_ptr<btCollisionShape> shape_of(const scenes::Shape& shape) {
  if (const auto* s = std::get_if<scenes::Sphere>(&shape)) {
    return std::make_unique<btSphereShape>(static_cast<btScalar>(s->radius));
  }
  if (const auto* b = std::get_if<scenes::Box>(&shape)) {
    return std::make_unique<btBoxShape>(vector(b->half_extents));
  }
  if (const auto* c = std::get_if<scenes::Capsule>(&shape)) {
    return std::make_unique<btCapsuleShapeZ>(static_cast<btScalar>(c->radius),
                                             static_cast<btScalar>(2.0 * c->half_length));
  }
  return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
}

class Bullet final : public Engine {
 public:
  Bullet(const scenes::Scene& scene, double dt) : dt_(static_cast<btScalar>(dt)) {
    world_.setGravity(vector(scene.gravity));
    for (const scenes::Body& body : scene.bodies) add(body);
    for (const scenes::Joint& joint : scene.joints) add(joint);
  }
  ~Bullet() override {
    for (const auto& joint : joints_) world_.removeConstraint(joint.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  Bullet(const Bullet&) = delete;
  Bullet& operator=(const Bullet&) = delete;

  std::string settings() const override { return "float; 10 iterations; split impulses"; }
  bool step() override {
    world_.stepSimulation(dt_, 0);
    return true;
  }
  void launch(const scenes::Launch& launch) override {
    bodies_[launch.body]->setLinearVelocity(vector(launch.velocity));
    bodies_[launch.body]->setAngularVelocity(vector(launch.spin));
  }
  std::vector<vp::SE3> poses() const override {
    std::vector<vp::SE3> out;
    for (const auto& body : bodies_) out.push_back(pose_of(body->getWorldTransform()));
    return out;
  }

 private:
  void add(const scenes::Body& body) {
    const bool moves = body.motion == scenes::Motion::dynamic;
    const scenes::Mass mass = moves ? scenes::mass_of(body) : scenes::Mass{0.0, {}};
    shapes_.push_back(shape_of(body.parts[0].shape));
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass.mass), nullptr,
                                                  shapes_.back().get(), vector(mass.moments));
    info.m_startWorldTransform = transform(body.T_world_body);
    info.m_friction = static_cast<btScalar>(std::sqrt(body.parts[0].material.friction));
    info.m_restitution = static_cast<btScalar>(body.parts[0].material.restitution);
    auto& made = bodies_.emplace_back(std::make_unique<btRigidBody>(info));
    made->setLinearVelocity(vector(body.velocity));
    made->setAngularVelocity(vector(body.spin));
    made->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(made.get());
  }
  void add(const scenes::Joint& joint) {
    btRigidBody &a = *bodies_[joint.a], &b = *bodies_[joint.b];
    const btTransform in_a = transform(joint.T_a_joint), in_b = transform(joint.T_b_joint);
    if (joint.kind == scenes::Joint::Kind::ball) {
      joints_.push_back(
          std::make_unique<btPoint2PointConstraint>(a, b, in_a.getOrigin(), in_b.getOrigin()));
    } else {
      auto hinge = std::make_unique<btHingeConstraint>(a, b, in_a, in_b);
      if (std::isfinite(joint.lower)) {
        // Bullet measures a hinge's angle from its second body to its first.
        hinge->setLimit(static_cast<btScalar>(-joint.upper), static_cast<btScalar>(-joint.lower));
      }
      joints_.push_back(std::move(hinge));
    }
    world_.addConstraint(joints_.back().get(), true);
  }

  btScalar dt_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

}  // namespace

MadeEngine make_engine(const scenes::Scene& scene, double dt) {
  if (scenes::has_terrain(scene)) return tl::make_unexpected("this comparison gives it no terrain");
  for (const scenes::Body& body : scene.bodies) {
    if (body.parts.size() != 1 || body.motion == scenes::Motion::kinematic) {
      return tl::make_unexpected(
          "this comparison gives it bodies of one shape that it moves itself");
    }
  }
  return std::make_unique<Bullet>(scene, dt);
}

}  // namespace rigid
