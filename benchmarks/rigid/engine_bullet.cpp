// Bullet in single precision, as its package is built, with its defaults: sequential impulses with
// 10 iterations, split impulses, a dynamic tree as broad phase. Bullet multiplies the friction
// coefficients of two surfaces, so each gets the square root of ours. A kinematic body gets its
// pose at the end of the step before each step; Bullet computes its velocity from that.
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <map>

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

// Bullet's shapes. Shapes that share data in the scene share it here.
class Shapes {
 public:
  btCollisionShape* of(const scenes::Body& body) {
    if (body.parts.size() == 1 && is_identity(body.parts[0].T_body_shape))
      return of(body.parts[0].shape);
    auto compound = std::make_unique<btCompoundShape>();
    for (const scenes::Part& part : body.parts)
      compound->addChildShape(transform(part.T_body_shape), of(part.shape));
    return keep(std::move(compound));
  }

 private:
  static bool is_identity(const vp::SE3& T) {
    return T.rotation() == vp::Mat3::identity() && T.position() == vp::Vec3{};
  }
  btCollisionShape* keep(std::unique_ptr<btCollisionShape> shape) {
    return kept_.emplace_back(std::move(shape)).get();
  }
  btCollisionShape* of(const scenes::Shape& shape) {
    if (const auto* s = std::get_if<scenes::Sphere>(&shape))
      return keep(std::make_unique<btSphereShape>(static_cast<btScalar>(s->radius)));
    if (const auto* b = std::get_if<scenes::Box>(&shape))
      return keep(std::make_unique<btBoxShape>(vector(b->half_extents)));
    if (const auto* c = std::get_if<scenes::Capsule>(&shape)) {
      return keep(std::make_unique<btCapsuleShapeZ>(static_cast<btScalar>(c->radius),
                                                    static_cast<btScalar>(2.0 * c->half_length)));
    }
    if (const auto* hull = std::get_if<scenes::Hull>(&shape)) {
      btCollisionShape*& made = shared_[hull->data.get()];
      if (!made) made = keep(hull_of(*hull->data));
      return made;
    }
    if (const auto* mesh = std::get_if<scenes::Mesh>(&shape)) {
      btCollisionShape*& made = shared_[mesh->data.get()];
      if (!made) made = keep(mesh_of(*mesh->data));
      return made;
    }
    return keep(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)));
  }
  static std::unique_ptr<btCollisionShape> hull_of(const scenes::Polyhedron& hull) {
    auto made = std::make_unique<btConvexHullShape>();
    for (const vp::Vec3& p : hull.points) made->addPoint(vector(p), false);
    made->recalcLocalAabb();
    return made;
  }
  std::unique_ptr<btCollisionShape> mesh_of(const scenes::Triangles& mesh) {
    auto triangles = std::make_unique<btTriangleMesh>();
    triangles->preallocateVertices(static_cast<int>(mesh.vertices.size()));
    triangles->preallocateIndices(static_cast<int>(3 * mesh.corners.size()));
    for (const vp::Vec3& p : mesh.vertices) triangles->findOrAddVertex(vector(p), false);
    for (const auto& [a, b, c] : mesh.corners) {
      triangles->addTriangleIndices(static_cast<int>(a), static_cast<int>(b), static_cast<int>(c));
    }
    auto made = std::make_unique<btBvhTriangleMeshShape>(triangles.get(), true);
    meshes_.push_back(std::move(triangles));
    return made;
  }

  std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
  std::vector<std::unique_ptr<btCollisionShape>> kept_;
  std::map<const void*, btCollisionShape*> shared_;
};

// The pose of a kinematic body at the end of the step.
class Path final : public btMotionState {
 public:
  explicit Path(const scenes::Body& body)
      : pose_(body.T_world_body), velocity_(body.velocity), spin_(body.spin) {}
  void set_velocity(const vp::Vec3& velocity, const vp::Vec3& spin) {
    velocity_ = velocity;
    spin_ = spin;
  }
  void advance(double dt) {
    pose_ =
        vp::SE3(vp::Exp(dt * spin_).matrix() * pose_.rotation(), pose_.position() + dt * velocity_);
  }
  const vp::SE3& pose() const { return pose_; }
  void getWorldTransform(btTransform& T) const override { T = transform(pose_); }
  void setWorldTransform(const btTransform&) override {}

 private:
  vp::SE3 pose_;
  vp::Vec3 velocity_, spin_;
};

class Bullet final : public Engine {
 public:
  Bullet(const scenes::Scene& scene, double dt)
      : scene_(scene),
        dt_(dt),
        bodies_(scene.bodies.size()),
        paths_(scene.bodies.size()),
        joints_(scene.joints.size()) {
    world_.setGravity(vector(scene.gravity));
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      if (exists(scene.bodies[i], 0.0)) add_body(static_cast<int>(i));
    }
    for (std::size_t i = 0; i < scene.joints.size(); ++i) {
      if (exists(scene, scene.joints[i], 0.0)) add_joint(static_cast<int>(i));
    }
  }
  ~Bullet() override {
    for (const auto& joint : joints_) {
      if (joint) world_.removeConstraint(joint.get());
    }
    for (const auto& body : bodies_) {
      if (body) world_.removeRigidBody(body.get());
    }
  }
  Bullet(const Bullet&) = delete;
  Bullet& operator=(const Bullet&) = delete;

  std::string settings() const override { return "float; 10 iterations; split impulses"; }
  bool step() override {
    for (const int i : kinematic_) paths_[i]->advance(dt_);
    world_.stepSimulation(static_cast<btScalar>(dt_), 0);
    return true;
  }
  void launch(const scenes::Launch& launch) override {
    if (paths_[launch.body]) return paths_[launch.body]->set_velocity(launch.velocity, launch.spin);
    if (!bodies_[launch.body]) return;
    bodies_[launch.body]->setLinearVelocity(vector(launch.velocity));
    bodies_[launch.body]->setAngularVelocity(vector(launch.spin));
  }
  void remove_body(int index) override {
    world_.removeRigidBody(bodies_[index].get());
    bodies_[index].reset();
  }
  void remove_joint(int index) override {
    world_.removeConstraint(joints_[index].get());
    joints_[index].reset();
  }
  std::vector<vp::SE3> poses() const override {
    std::vector<vp::SE3> out;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      out.push_back(paths_[i]    ? paths_[i]->pose()
                    : bodies_[i] ? pose_of(bodies_[i]->getWorldTransform())
                                 : scene_.bodies[i].T_world_body);
    }
    return out;
  }
  void add_body(int index) override {
    const scenes::Body& body = scene_.bodies[index];
    const bool moves = body.motion == scenes::Motion::dynamic;
    const scenes::Mass mass = moves ? scenes::mass_of(body) : scenes::Mass{0.0, {}};
    const scenes::Material& material = body.parts[0].material;
    if (body.motion == scenes::Motion::kinematic) {
      paths_[index] = std::make_unique<Path>(body);
      kinematic_.push_back(index);
    }
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass.mass),
                                                  paths_[index].get(), shapes_.of(body),
                                                  vector(mass.moments));
    info.m_startWorldTransform = transform(body.T_world_body);
    info.m_friction = static_cast<btScalar>(std::sqrt(material.friction));
    info.m_restitution = static_cast<btScalar>(material.restitution);
    // Bullet multiplies a body's rolling friction by the other's friction, and adds both products.
    if (moves && material.rolling_friction > 0.0) {
      info.m_rollingFriction =
          static_cast<btScalar>(material.rolling_friction / std::sqrt(material.friction));
    }
    auto& made = bodies_[index] = std::make_unique<btRigidBody>(info);
    made->setLinearVelocity(vector(body.velocity));
    made->setAngularVelocity(vector(body.spin));
    made->setActivationState(DISABLE_DEACTIVATION);
    if (paths_[index])
      made->setCollisionFlags(made->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    world_.addRigidBody(made.get());
  }
  void add_joint(int index) override {
    const scenes::Joint& joint = scene_.joints[index];
    btRigidBody &a = *bodies_[joint.a], &b = *bodies_[joint.b];
    const btTransform in_a = transform(joint.T_a_joint), in_b = transform(joint.T_b_joint);
    if (joint.kind == scenes::Joint::Kind::ball) {
      joints_[index] =
          std::make_unique<btPoint2PointConstraint>(a, b, in_a.getOrigin(), in_b.getOrigin());
    } else {
      auto hinge = std::make_unique<btHingeConstraint>(a, b, in_a, in_b);
      if (std::isfinite(joint.lower)) {
        // Bullet measures a hinge's angle from its second body to its first.
        hinge->setLimit(static_cast<btScalar>(-joint.upper), static_cast<btScalar>(-joint.lower));
      }
      joints_[index] = std::move(hinge);
    }
    world_.addConstraint(joints_[index].get(), true);
  }

 private:
  const scenes::Scene& scene_;
  double dt_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  Shapes shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;  // null: does not exist now
  std::vector<std::unique_ptr<Path>> paths_;          // of kinematic bodies
  std::vector<int> kinematic_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

}  // namespace

MadeEngine make_engine(const scenes::Scene& scene, double dt) {
  if (scenes::has_terrain(scene)) return tl::make_unexpected("this comparison gives it no terrain");
  return std::make_unique<Bullet>(scene, dt);
}

}  // namespace rigid
