// Passes a world's geometry and state to a DebugDraw.
#include "vphysics/debug_draw.h"

#include <algorithm>
#include <array>

#include "solve/state_vector.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/lane_fields.h"
#include "world/validate.h"
#include "world/wires.h"

namespace vp {
namespace {

constexpr double kLargestSize = 1e6;  // [m]

DebugCategory category_of(const Body& body, const Collider& collider) {
  if (collider.sensor) return DebugCategory::sensor;
  if (body.motion == Motion::fixed) return DebugCategory::fixed_shape;
  return body.motion == Motion::kinematic ? DebugCategory::kinematic_shape
                                          : DebugCategory::dynamic_shape;
}

// The axes that a joint rotates about or slides along, in its frame.
struct JointAxes {
  std::array<Vec3, 2> axes{};
  int count = 0;

  void operator()(const RevoluteJoint& j) { add(j.axis); }
  void operator()(const PrismaticJoint& j) { add(j.axis); }
  void operator()(const HelicalJoint& j) { add(j.axis); }
  void operator()(const CylindricalJoint& j) { add(j.axis); }
  void operator()(const PlanarJoint&) { add({0, 0, 1}); }
  void operator()(const UniversalJoint& j) {
    add(j.first);
    add(j.second);
  }
  void operator()(const auto&) {}  // the others have no fixed axis

 private:
  void add(const Vec3& axis) {
    axes[static_cast<std::size_t>(count++)] = (1.0 / norm(axis)) * axis;
  }
};

}  // namespace

std::uint32_t default_colour(DebugCategory category) {
  constexpr std::array<std::uint32_t, kDebugCategories> kColours{
      0x8a8f98, 0x8e5bd0, 0x2f8fd8, 0x3fb6a8, 0x6d7787, 0xf5c518, 0xf08a24, 0xe0413a,
      0xd06fc0, 0xe23b3b, 0x36a852, 0x3f6fe0, 0x1a1a1a, 0xc8a165, 0xe8d9b0};
  return kColours[static_cast<std::size_t>(category)];
}

bool DebugDraw::shape(ColliderId, const Shape&, const SE3&, DebugCategory) {
  return false;
}

class World::Impl::Drawing {
 public:
  Drawing(const Impl& world, const DebugDrawOptions& options, DebugDraw& draw)
      : world_(world), options_(options), draw_(draw) {}

  void draw() const {
    if (options_.shapes || options_.bounds) draw_colliders();
    if (options_.frames || options_.centres) draw_bodies();
    if (options_.joints) {
      for (const Articulation& tree : world_.articulations) {
        if (tree.alive) draw_tree(tree);
      }
      for (const BodyJoint& joint : world_.joints) {
        if (joint.alive) draw_joint(joint);
      }
    }
    if (!(options_.contacts || options_.normals || options_.impulses)) return;
    for (const Contact& c : world_.contact_store.pool) {
      if (!c.alive || !c.touching || c.slot.points == 0) continue;
      if (c.slot.points == 1) {
        draw_contact(c, world_.contact_store.graph.block<1>(c.slot));
      } else {
        draw_contact(c, world_.contact_store.graph.block<4>(c.slot));
      }
    }
    for (const PairRecord& record : world_.pair_contacts.records()) draw_record(record);
  }

 private:
  void draw_colliders() const {
    for (std::uint32_t i = 0; i < world_.colliders.size(); ++i) {
      const Collider& c = world_.colliders[i];
      if (!c.alive) continue;
      const Body& body = world_.bodies[c.body];
      const SE3 T = body.T * c.T_body_shape;
      const DebugCategory category = category_of(body, c);
      if (options_.shapes && !draw_.shape(world_.colliders.id(i), c.shape, T, category))
        draw_wire(c.shape, T, options_.half_space_size, category, draw_);
      if (options_.bounds && !std::holds_alternative<HalfSpace>(c.shape)) {
        const collide::Bounds b = bounds_of(c.geometry, T);
        draw_box(SE3(0.5 * (b.lower + b.upper)), 0.5 * (b.upper - b.lower), DebugCategory::bounds,
                 draw_);
      }
    }
  }

  SE3 pose_of(const Body& body) const {
    return body.is_link ? world_.articulations[body.articulation].T_world_link(body.link) : body.T;
  }

  void draw_bodies() const {
    for (const Body& body : world_.bodies) {
      if (!body.alive) continue;
      const SE3 T = pose_of(body);
      const Vec3& at = T.position();
      if (options_.frames) {
        draw_.line(at, at + options_.frame_size * T.rotation().cx, DebugCategory::axis_x);
        draw_.line(at, at + options_.frame_size * T.rotation().cy, DebugCategory::axis_y);
        draw_.line(at, at + options_.frame_size * T.rotation().cz, DebugCategory::axis_z);
      }
      if (options_.centres && body.motion == Motion::dynamic && body.mass > 0.0)
        draw_.point(T * body.centre, DebugCategory::centre);
    }
  }

  void draw_axis(const Vec3& at, const Vec3& axis) const {
    draw_.line(at, at + options_.frame_size * axis, DebugCategory::joint_axis);
  }

  void draw_tree(const Articulation& tree) const {
    for (int l = 0; l < tree.model().links(); ++l) {
      const LinkSpec& link = tree.model().link(l);
      const SE3 T_world_parent = link.parent == kWorld ? SE3() : tree.T_world_link(link.parent);
      const SE3 T_world_joint = T_world_parent * link.T_parent_joint;
      const Vec3& at = T_world_joint.position();
      if (link.parent != kWorld) draw_.line(T_world_parent.position(), at, DebugCategory::joint);
      draw_.line(at, tree.T_world_link(l).position(), DebugCategory::joint);
      draw_.point(at, DebugCategory::joint);
      JointAxes joint;
      std::visit([&](const auto& j) { joint(j); }, link.joint);
      for (int k = 0; k < joint.count; ++k)
        draw_axis(at, T_world_joint.rotate(joint.axes[static_cast<std::size_t>(k)]));
    }
  }

  // Draws a line between the two frames: a spring, a rod, or a joint error.
  void draw_joint(const BodyJoint& joint) const {
    const Body &a = world_.bodies[joint.a], &b = world_.bodies[joint.b];
    const bool user = joint.spec.form == JointSpec::Form::user;  // has no frames
    const SE3 T_a = user ? a.T : a.T * joint.T_a_joint, T_b = user ? b.T : b.T * joint.T_b_joint;
    if (a.motion != Motion::fixed)
      draw_.line(reference_point(a), T_a.position(), DebugCategory::joint);
    draw_.line(T_a.position(), T_b.position(), DebugCategory::joint);
    if (b.motion != Motion::fixed)
      draw_.line(T_b.position(), reference_point(b), DebugCategory::joint);
    draw_.point(T_a.position(), DebugCategory::joint);
    draw_.point(T_b.position(), DebugCategory::joint);
    const bool gear = joint.spec.form == JointSpec::Form::gear;
    if (gear || (joint.spec.form == JointSpec::Form::axes && joint.main >= 0))
      draw_axis(T_a.position(), T_a.rotation().cz);
    if (gear) draw_axis(T_b.position(), T_b.rotation().cz);
  }

  void draw_point(const Vec3& at, const Vec3& normal, double load, const Vec3& friction) const {
    if (options_.contacts) draw_.point(at, DebugCategory::contact);
    if (options_.normals)
      draw_.line(at, at + options_.normal_length * normal, DebugCategory::normal);
    if (!options_.impulses) return;
    if (load > 0.0)
      draw_.line(at, at + options_.impulse_scale * load * normal, DebugCategory::impulse);
    if (friction != Vec3{})
      draw_.line(at, at + options_.impulse_scale * friction, DebugCategory::friction);
  }

  // The points are from some steps ago and are moved with the body that is not fixed. The impulses
  // of the last sub-step represent all sub-steps. Restitution impulses and friction are per contact
  // and are divided evenly.
  template <int P>
  void draw_contact(const Contact& c, const solve::ContactBlock<P>& block) const {
    const int lane = solve::ContactGraph::lane(c.slot);
    const std::uint32_t body_a = world_.colliders[c.a].body, body_b = world_.colliders[c.b].body;
    const bool with_b = world_.bodies[body_a].motion == Motion::fixed;
    const std::uint32_t body = with_b ? body_b : body_a;
    const Vec3 centre = reference_point(world_.bodies[body]);
    const Vec3 rotation = vector_of(world_.body_states[body + 1].displacement + 3) -
                          get(with_b ? block.rotated_b : block.rotated_a, lane);
    const Mat3 R = rotated(Mat3::identity(), rotation);
    Vec3 mean;
    for (int i = 0; i < c.count; ++i) mean += (1.0 / c.count) * c.position[i];
    Vec3 grip = get(block.grip, lane);
    if (with_b) grip += get(block.d, lane);

    const Vec3 n = get(block.normal, lane), t = get(block.tangent, lane);
    const auto value = [lane](const solve::Field& f) { return static_cast<double>(f.lane[lane]); };
    const double steps = world_.sub_steps_taken, fraction = 1.0 / c.count;
    const Vec3 friction =
        steps * fraction *
        (value(block.tangent_impulse[0]) * t + value(block.tangent_impulse[1]) * cross(n, t));
    const double bounces = steps > 0.0 ? fraction * value(block.impact) : 0.0;
    for (int i = 0; i < c.count; ++i) {
      const Vec3 at = centre + R * (grip + c.position[i] - mean);
      draw_point(at, n, steps * value(block.impulse[i]) + bounces, friction);
    }
  }

  // Of the impact stage, which does not store normals.
  void draw_record(const PairRecord& record) const {
    const Collider &a = world_.colliders[record.a], &b = world_.colliders[record.b];
    if (!record.touching || !a.alive || !b.alive || a.sensor || b.sensor) return;
    collide::Manifold m;
    const SE3 T_a = world_.bodies[a.body].T * a.T_body_shape;
    const SE3 T_b = world_.bodies[b.body].T * b.T_body_shape;
    find_manifold(a.geometry, T_a, b.geometry, T_b, 2.0 * world_.desc.contact_slop, m);
    if (m.count == 0) return;
    for (std::uint32_t i = 0; i < record.count; ++i) {
      const PairPoint& p = record.points[i];
      draw_point(p.position, m.normal, p.normal_impulse, p.friction);
    }
  }

  const Impl& world_;
  const DebugDrawOptions& options_;
  DebugDraw& draw_;
};

Expected<void> World::debug_draw(const DebugDrawOptions& options, DebugDraw& draw) const {
  for (const double size : {options.frame_size, options.normal_length, options.impulse_scale,
                            options.half_space_size}) {
    if (!(size > 0.0 && size <= kLargestSize))
      return invalid("debug_draw: every size and scale must be positive and at most 1e6");
  }
  impl_->update_all_remote();
  Impl::Drawing(*impl_, options, draw).draw();
  return {};
}

}  // namespace vp
