// The topology hash: a digest of all constants of a world, bit for bit. State that calls may change
// later (poses, velocities, joint states, drives) is in the snapshot instead. user_data belongs to
// the user, may be an address, and affects no motion, so it is in neither.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <memory>
#include <span>

#include "vphysics/world.h"
#include "world/digest.h"

namespace vp {

class TopologyHash {
 public:
  explicit TopologyHash(std::uint64_t& digest) : digest_(digest) {}

  template <std::unsigned_integral T>
  void add(T value) {
    digest_ = mixed(digest_, value);
  }
  // In this order.
  template <class A, class B, class... MORE>
  void add(const A& a, const B& b, const MORE&... more) {
    add(a);
    add(b);
    (add(more), ...);
  }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const Vec3& a) {
    for (const double x : {a.x, a.y, a.z}) add(x);
  }
  void add(const SE3& T) {
    const Mat3& R = T.rotation();
    for (const Vec3* v : {&R.cx, &R.cy, &R.cz, &T.position()}) add(*v);
  }
  void add(const Inertia& J) {
    const Sym3& I = J.rotational();
    add(J.mass(), J.first_moment());
    for (const double x : {I.xx, I.yy, I.zz, I.xy, I.yz, I.zx}) add(x);
  }
  void add(const WorldDesc& desc) {
    add(desc.gravity, desc.restitution_threshold, desc.contact_slop,
        static_cast<std::uint64_t>(desc.velocity_iterations),
        static_cast<std::uint64_t>(desc.sub_steps),
        static_cast<std::uint64_t>(desc.max_impacts_per_step));
    const WorldDesc usual;
    add_unless(usual.sleep_after, 'a', desc.sleep_after);
    add_unless(usual.sleep_speed, 'z', desc.sleep_speed);
    add_unless(static_cast<std::uint64_t>(usual.region_bodies), 'g',
               static_cast<std::uint64_t>(desc.region_bodies));
    add_unless(usual.length_unit, 'l', desc.length_unit);
  }
  void add(const BodyDesc& desc) {
    add(static_cast<std::uint64_t>(desc.motion), static_cast<std::uint64_t>(desc.continuous),
        desc.inertia, desc.linear_damping, desc.angular_damping);
    const BodyDesc usual;
    add_unless(usual.gravity_scale, 'w', desc.gravity_scale);
    add_unless(std::uint64_t{1}, 'p', static_cast<std::uint64_t>(desc.allow_sleep));
  }
  void add(const ColliderDesc& desc) {
    add(desc.shape, desc.T_body_shape);
    for (const double x :
         {desc.material.friction, desc.material.restitution, desc.material.rolling_friction}) {
      add(x);
    }
    add(desc.filter.category, desc.filter.mask, static_cast<std::uint64_t>(desc.sensor));
    // Later fields count only if they are used, so that worlds without them keep their hash.
    const ColliderDesc usual;
    add_unless(usual.material.spinning_friction, 'n', desc.material.spinning_friction);
    add_unless(usual.surface_velocity, 's', desc.surface_velocity);
    add_unless(usual.density, 'd', desc.density);
  }
  void add(const Shape& shape) {
    add(static_cast<std::uint64_t>(shape.index()));
    std::visit([this](const auto& s) { add_shape(s); }, shape);
  }
  void add(const TriangleMesh& mesh) {
    add(static_cast<std::uint64_t>(mesh.two_sided()), mesh.scale(),
        static_cast<std::uint64_t>(mesh.vertices().size()));
    for (const Vec3& v : mesh.vertices()) add(v);
    add(static_cast<std::uint64_t>(mesh.triangles().size()));
    for (const TriangleMesh::Triangle& t : mesh.triangles()) {
      for (const std::uint32_t v : t) add(v);
    }
  }
  void add(const HeightField& field) {
    add(std::uint64_t{field.columns()} << 32 | field.rows());
    for (std::uint32_t j = 0; j < field.rows(); ++j) {
      for (std::uint32_t i = 0; i < field.columns(); ++i) {
        add(field.sample(i, j), static_cast<std::uint64_t>(field.is_hole(i, j)));
      }
    }
  }
  // Includes the faces: they depend on the options that the hull was built with.
  void add(const ConvexHull& hull) {
    add(static_cast<std::uint64_t>(hull.vertices().size()));
    for (const Vec3& v : hull.vertices()) add(v);
    for (const ConvexHull::Face& face : hull.faces()) {
      add(static_cast<std::uint64_t>(face.vertices.size()));
      for (const std::uint16_t i : face.vertices) add(i);
    }
  }
  void add(const JointDesc& desc) {
    add(static_cast<std::uint64_t>(desc.kind.index()));
    std::visit([this](const auto& kind) { add_kind(kind); }, desc.kind);
    add(desc.T_a_joint, desc.T_b_joint, static_cast<std::uint64_t>(desc.collide), desc.frequency,
        desc.damping_ratio);
  }
  void add(const ArticulationDesc& desc) {
    const Model& model = desc.model;
    add(static_cast<std::uint64_t>(model.links()));
    for (int l = 0; l < model.links(); ++l) {
      const LinkSpec& link = model.link(l);
      const int parent = link.parent + 1;  // the world: 0
      add(static_cast<std::uint64_t>(parent), static_cast<std::uint64_t>(link.joint.index()));
      std::visit([this](const auto& joint) { add_joint(joint); }, link.joint);
      add(link.T_parent_joint, link.inertia, link.armature, link.damping);
      for (const JointForces& f : link.forces) {
        for (const double x : {f.lower, f.upper, f.limit_stiffness, f.limit_damping, f.stiffness,
                               f.rest, f.friction, f.motor_limit}) {
          add(x);
        }
      }
    }
    add_unless(std::uint64_t{0}, 'c', static_cast<std::uint64_t>(desc.links_collide));
  }

 private:
  template <class T>
  void add_unless(const T& usual, char name, const T& value) {
    if (value == usual) return;
    add(static_cast<std::uint64_t>(name), value);
  }
  void add_shape(const HalfSpace&) {}
  void add_shape(const Sphere& s) { add(s.radius); }
  void add_shape(const Box& s) { add(s.half_extents); }
  void add_shape(const Capsule& s) { add(s.radius, s.half_length); }
  void add_shape(const Cylinder& s) { add(s.radius, s.half_length); }
  void add_shape(const Cone& s) { add(s.radius, s.half_height); }
  void add_shape(const Compound& s) {
    add(static_cast<std::uint64_t>(s.parts().size()));
    for (const CompoundPart& part : s.parts()) add(part.shape, part.T_compound_part);
  }
  void add_shape(const auto& built) { add(built); }
  void add_kind(const auto&) {}  // the others have no constants
  void add_kind(const Hinge& j) { add_limits(j.lower, j.upper); }
  void add_kind(const Slider& j) { add_limits(j.lower, j.upper); }
  void add_kind(const Distance& j) { add_limits(j.min, j.max); }
  void add_kind(const Spring& j) {
    for (const double x : {j.length, j.stiffness, j.damping}) add(x);
  }
  void add_kind(const ConeTwist& j) {
    add_limits(j.swing_x, j.swing_y);
    add_limits(j.lower, j.upper);
  }
  void add_kind(const SixDof& j) {
    for (const AxisDesc& axis : j.axes) {
      add(static_cast<std::uint64_t>(axis.motion));
      add_limits(axis.lower, axis.upper);
    }
  }
  void add_kind(const Gear& j) {
    add(j.ratio, static_cast<std::uint64_t>(j.slides_a), static_cast<std::uint64_t>(j.slides_b));
  }
  void add_kind(const UserConstraint& j) {
    const int rows = j.constraint->rows();
    add(static_cast<std::uint64_t>(rows));
    for (int i = 0; i < rows; ++i) {
      const ConstraintRowDesc spec = j.constraint->row_desc(i);
      for (const double x : {spec.frequency, spec.damping_ratio, spec.min_force, spec.max_force}) {
        add(x);
      }
    }
    for (const double x : j.constraint->constants()) add(x);
  }
  void add_limits(double lower, double upper) { add(lower, upper); }
  void add_joint(const RevoluteJoint& j) { add(j.axis); }
  void add_joint(const PrismaticJoint& j) { add(j.axis); }
  void add_joint(const HelicalJoint& j) { add(j.axis, j.pitch); }
  void add_joint(const CylindricalJoint& j) { add(j.axis); }
  void add_joint(const UniversalJoint& j) { add(j.first, j.second); }
  // The constants of a user's joint are unknown here. Two of its poses and motion subspaces
  // identify most joints.
  void add_joint(const std::shared_ptr<const UserJoint>& j) {
    const auto n = static_cast<std::size_t>(j->degrees_of_freedom());
    for (const double at : {0.0, 0.25}) {
      std::array<double, 6> q{}, v{};
      std::array<se3, 6> S{};
      q.fill(at);
      v.fill(1.0);
      SE3 T;
      se3 rate;
      j->evaluate(std::span(q).first(n), std::span(v).first(n), T, std::span(S).first(n), rate);
      add(T);
      for (std::size_t k = 0; k < n; ++k) add(S[k]);
      add(rate);
    }
  }
  void add_joint(const auto&) {}  // the others have no constants
  void add(const se3& V) { add(V.w, V.v); }

  std::uint64_t& digest_;
};

}  // namespace vp
