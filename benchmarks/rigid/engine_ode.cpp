// ODE in double precision, as its package is built: QuickStep with 20 iterations, sweep and prune,
// at most 4 contacts per pair, the friction pyramid that its manual recommends, and a contact layer
// of 1 mm against jitter.
#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "engine.h"

namespace rigid {
namespace {

constexpr int kContacts = 4;

void set_rotation(const vp::Mat3& R, dMatrix3 out) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out[4 * row + column] = R(row, column);
    out[4 * row + 3] = 0;
  }
}

class Ode final : public Engine {
 public:
  Ode(const scenes::Scene& scene, double dt) : dt_(dt) {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world_ = dWorldCreate();
    space_ = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
    contacts_ = dJointGroupCreate(0);
    dWorldSetGravity(world_, scene.gravity.x, scene.gravity.y, scene.gravity.z);
    dWorldSetContactSurfaceLayer(world_, 0.001);
    dWorldSetAutoDisableFlag(world_, 0);
    for (const scenes::Body& body : scene.bodies) add(body);
    for (const scenes::Joint& joint : scene.joints) add(joint);
    std::sort(joined_.begin(), joined_.end());
  }
  ~Ode() override {
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
    dCloseODE();
  }
  Ode(const Ode&) = delete;
  Ode& operator=(const Ode&) = delete;

  std::string settings() const override {
    return "double; QuickStep, 20 iterations; 4 contacts a pair; contact layer 1 mm";
  }
  bool step() override {
    dSpaceCollide(space_, this, &Ode::near);
    dWorldQuickStep(world_, dt_);
    dJointGroupEmpty(contacts_);
    return true;
  }
  void launch(const scenes::Launch& launch) override {
    set_velocity(bodies_[launch.body].body, launch.velocity, launch.spin);
  }
  std::vector<vp::SE3> poses() const override {
    std::vector<vp::SE3> out;
    for (const Placed& placed : bodies_) {
      if (!placed.body) {
        out.push_back(placed.start);
        continue;
      }
      const dReal* R = dBodyGetRotation(placed.body);
      const dReal* p = dBodyGetPosition(placed.body);
      out.emplace_back(vp::Mat3{{R[0], R[4], R[8]}, {R[1], R[5], R[9]}, {R[2], R[6], R[10]}},
                       vp::Vec3{p[0], p[1], p[2]});
    }
    return out;
  }

 private:
  struct Placed {
    dBodyID body;  // null: static
    vp::SE3 start;
    double friction;
  };

  static void set_velocity(dBodyID body, const vp::Vec3& v, const vp::Vec3& w) {
    dBodySetLinearVel(body, v.x, v.y, v.z);
    dBodySetAngularVel(body, w.x, w.y, w.z);
  }

  dGeomID geometry(const scenes::Shape& shape, const vp::SE3& pose) {
    if (const auto* s = std::get_if<scenes::Sphere>(&shape))
      return dCreateSphere(space_, s->radius);
    if (const auto* b = std::get_if<scenes::Box>(&shape)) {
      const vp::Vec3 size = 2.0 * b->half_extents;
      return dCreateBox(space_, size.x, size.y, size.z);
    }
    if (const auto* c = std::get_if<scenes::Capsule>(&shape)) {
      return dCreateCapsule(space_, c->radius, 2.0 * c->half_length);
    }
    const vp::Vec3& n = pose.rotation().cz;
    return dCreatePlane(space_, n.x, n.y, n.z, dot(n, pose.position()));
  }

  void add(const scenes::Body& body) {
    const vp::SE3& T = body.T_world_body;
    dGeomID geom = geometry(body.parts[0].shape, T);
    // The user pointer of a geometry is the index of its body.
    dGeomSetData(geom, reinterpret_cast<void*>(bodies_.size()));
    dMatrix3 R;
    set_rotation(T.rotation(), R);
    Placed placed{nullptr, T, body.parts[0].material.friction};
    if (body.motion == scenes::Motion::dynamic) {
      const scenes::Mass own = scenes::mass_of(body);
      dMass mass;
      dMassSetParameters(&mass, own.mass, 0, 0, 0, own.moments.x, own.moments.y, own.moments.z, 0,
                         0, 0);
      placed.body = dBodyCreate(world_);
      dBodySetMass(placed.body, &mass);
      dBodySetPosition(placed.body, T.position().x, T.position().y, T.position().z);
      dBodySetRotation(placed.body, R);
      set_velocity(placed.body, body.velocity, body.spin);
      dGeomSetBody(geom, placed.body);
    } else if (!std::holds_alternative<scenes::Ground>(body.parts[0].shape)) {
      dGeomSetPosition(geom, T.position().x, T.position().y, T.position().z);
      dGeomSetRotation(geom, R);
    }
    bodies_.push_back(placed);
  }

  void add(const scenes::Joint& joint) {
    const vp::SE3 frame = bodies_[joint.a].start * joint.T_a_joint;
    const vp::Vec3& p = frame.position();
    const vp::Vec3& axis = frame.rotation().cz;
    // ODE measures a hinge's angle from its second body to its first.
    dBodyID a = bodies_[joint.b].body, b = bodies_[joint.a].body;
    if (joint.kind == scenes::Joint::Kind::ball) {
      dJointID ball = dJointCreateBall(world_, nullptr);
      dJointAttach(ball, a, b);
      dJointSetBallAnchor(ball, p.x, p.y, p.z);
    } else {
      dJointID hinge = dJointCreateHinge(world_, nullptr);
      dJointAttach(hinge, a, b);
      dJointSetHingeAnchor(hinge, p.x, p.y, p.z);
      dJointSetHingeAxis(hinge, axis.x, axis.y, axis.z);
      dJointSetHingeParam(hinge, dParamLoStop,
                          std::isfinite(joint.lower) ? joint.lower : -dInfinity);
      dJointSetHingeParam(hinge, dParamHiStop,
                          std::isfinite(joint.upper) ? joint.upper : dInfinity);
    }
    joined_.push_back(pair(joint.a, joint.b));
  }

  static std::uint64_t pair(std::uint64_t a, std::uint64_t b) {
    return std::min(a, b) << 32 | std::max(a, b);
  }

  static void near(void* data, dGeomID a, dGeomID b) { static_cast<Ode*>(data)->meet(a, b); }
  void meet(dGeomID a, dGeomID b) {
    dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (!body_a && !body_b) return;
    const auto i = reinterpret_cast<std::uintptr_t>(dGeomGetData(a));
    const auto j = reinterpret_cast<std::uintptr_t>(dGeomGetData(b));
    if (!joined_.empty() && std::binary_search(joined_.begin(), joined_.end(), pair(i, j))) return;
    std::array<dContact, kContacts> points;
    const int count = dCollide(a, b, kContacts, &points[0].geom, sizeof(dContact));
    for (int k = 0; k < count; ++k) {
      points[k].surface.mode = dContactApprox1;
      points[k].surface.mu = std::sqrt(bodies_[i].friction * bodies_[j].friction);
      dJointAttach(dJointCreateContact(world_, contacts_, &points[k]), body_a, body_b);
    }
  }

  double dt_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  std::vector<Placed> bodies_;
  std::vector<std::uint64_t> joined_;
};

}  // namespace

MadeEngine make_engine(const scenes::Scene& scene, double dt) {
  if (const std::string why = beyond_simple(scene); !why.empty()) return tl::make_unexpected(why);
  for (const scenes::Body& body : scene.bodies) {
    if (body.parts.size() != 1)
      return tl::make_unexpected("this comparison gives it bodies of one shape");
  }
  return std::make_unique<Ode>(scene, dt);
}

}  // namespace rigid
