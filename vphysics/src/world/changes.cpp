// Changes to the properties of existing objects.
//
// All of these are constants of the world and part of its topology hash (topology_hash.h), so that
// earlier snapshots are rejected afterwards. The island of a changed body wakes. Contacts whose
// constants changed are tested again in the next step; contacts that no longer exist end, with an
// event of the next step.
#include <algorithm>

#include "world/impl.h"
#include "world/invalid.h"
#include "world/recorded_call.h"
#include "world/topology_hash.h"
#include "world/validate.h"

namespace vp {
namespace {

// For a body that takes its mass from its colliders, while none has a mass.
const Inertia kUnitInertia(1.0, Vec3{1.0, 1.0, 1.0});

enum class Change : std::uint64_t {
  motion = 1,
  inertia,
  damping,
  gravity_scale,
  allow_sleep,
  material,
  filter,
  surface_velocity,
  removed_collider,
  destroyed_articulation,
};
std::uint64_t change_bits(Change change, std::uint32_t index) {
  return (static_cast<std::uint64_t>(change) << 32) | index;
}

// Whether the speed of the centre of mass is in range. V: the body's velocity.
bool is_slow_enough(const se3& V, const Vec3& centre) {
  return nearly_in_range(V.v + cross(V.w, centre));
}

std::optional<std::string> why_not(const Body& body, const Colliders& colliders, Motion motion) {
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
    const Shape& shape = colliders[c].shape;
    if (std::holds_alternative<HalfSpace>(shape) && motion != Motion::fixed) {
      return "it carries a half-space, which needs a fixed body; remove that collider first";
    }
    const bool surface =
        std::holds_alternative<TriangleMesh>(shape) || std::holds_alternative<HeightField>(shape);
    if (surface && motion == Motion::dynamic) {
      return "it carries a mesh or a height field, which nothing can push; remove that collider "
             "first";
    }
  }
  return std::nullopt;
}

}  // namespace

// Why a body with velocity V cannot have this inertia; nullopt if it can.
std::optional<std::string> World::Impl::problem_with_mass(const Body& body, const se3& V,
                                                          const Inertia& inertia) const {
  if (auto problem = problem_with(inertia)) return problem;
  if (!is_slow_enough(V, inertia.centre_of_mass())) {
    return "the centre of mass would move faster than 1e9 m/s";
  }
  if (!loads.load_in_range(body, inertia, body.T)) return kLoadOutOfRange;
  return std::nullopt;
}

// Keeps the velocity of the origin and the forces on the body.
void World::Impl::change_mass(std::uint32_t index, const Inertia& inertia) {
  Body& body = bodies[index];
  wake(index);
  const Vec3 before = reference_point(body);
  const Vec3 v = body.v + cross(body.w, body.T.position() - before);
  const se3 V{body.T.unrotate(body.w), body.T.unrotate(v)};
  set_mass(body, inertia);
  body.bounding_radius = bounding_radius_of(body);
  if (body.motion != Motion::dynamic) return;
  body.w = body.T.rotate(V.w);
  body.v = body.T.rotate(V.v + cross(V.w, body.centre));
  loads.shift(body, before - reference_point(body));
  contact_store.mark_contacts_dirty(bodies[index]);
}

// For a dynamic body that takes its mass from its colliders, after they have changed.
void World::Impl::update_mass(std::uint32_t index) {
  const Body& body = bodies[index];
  if (!body.mass_from_colliders || body.motion != Motion::dynamic) return;
  const Inertia sum = inertia_of_colliders(body, colliders);
  change_mass(index, sum.mass() > 0.0 ? sum : kUnitInertia);
}

void World::Impl::wake_all_about(std::uint32_t index) {
  wake(index);
  wake_neighbours(index);
}

Body* World::Impl::find_body_to_change(BodyId id) {
  Body* body = find(id);
  return body && !body->is_link ? body : nullptr;
}
tl::unexpected<Error> World::Impl::no_body_to_change(const char* call, BodyId id) const {
  if (!find(id)) return unknown_id(call, "the body");
  return invalid(std::string(call) + ": a link is as its articulation's model has it");
}

// --- bodies --------------------------------------------------------------------------------------

Expected<void> World::set_motion(BodyId id, Motion motion) {
  Body* body = impl_->find_body_to_change(id);
  if (!body) return impl_->no_body_to_change("set_motion", id);
  const std::uint32_t index = id.index - 1;
  if (motion > Motion::dynamic) return invalid("set_motion: fixed, kinematic or dynamic");
  if (motion == body->motion) return {};
  if (auto problem = why_not(*body, impl_->colliders, motion)) {
    return invalid(Errc::unsupported, "set_motion: " + *problem);
  }
  for (std::uint32_t e = body->first_joint; e != kNone; e = impl_->joints[e / 2].next[e % 2]) {
    const BodyJoint& joint = impl_->joints[e / 2];
    const Body& other = impl_->bodies[joint.a == index ? joint.b : joint.a];
    if (motion != Motion::dynamic && other.motion != Motion::dynamic) {
      return invalid("set_motion: a joint would be left without a dynamic body; destroy it first");
    }
    if (motion == Motion::dynamic && other.motion == Motion::dynamic &&
        !can_be_joined(body->requested_continuous, other)) {
      return invalid(Errc::unsupported, std::string("set_motion: it is joined, and ") + kNotJoined);
    }
  }
  std::optional<Inertia> inertia;  // nullopt: the current one
  Vec3 centre = body->centre;
  if (motion == Motion::dynamic && body->mass_from_colliders) {
    inertia = inertia_of_colliders(*body, impl_->colliders);
    if (inertia->mass() == 0.0) inertia = kUnitInertia;
    if (auto problem = problem_with(*inertia)) return invalid("set_motion: " + *problem);
    centre = inertia->centre_of_mass();
  }
  const se3 V = velocity(id);
  if (motion == Motion::dynamic && !is_slow_enough(V, centre)) {
    return invalid("set_motion: the centre of mass would move faster than 1e9 m/s");
  }
  if (motion == Motion::kinematic && !in_range(V)) {
    return invalid("set_motion: the body moves faster than 1e9 m/s or rad/s; slow it down first");
  }
  impl_->change_motion(index, motion, inertia, V);
  TopologyHash(impl_->topology_hash)
      .add(change_bits(Change::motion, id.index), static_cast<std::uint64_t>(motion));
  if (impl_->recorder) impl_->log({calls::SetMotion{id, motion}});
  return {};
}

// Its contacts end, and those that still touch begin again: their contact slots depend on the
// motion.
void World::Impl::change_motion(std::uint32_t index, Motion motion,
                                const std::optional<Inertia>& inertia, const se3& V) {
  Body& body = bodies[index];
  wake_all_about(index);
  loads.remove(bodies, index);
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
    drop_contacts(c);
    finder.remove(colliders[c].proxy);
  }
  forget_joints(bodies[index], joints);
  body.motion = motion;
  body.continuous = body.requested_continuous && motion == Motion::dynamic;
  body.supported = false;
  body.region = solve::kSharedRegion;
  body.w = body.v = {};
  body.prescribed = motion == Motion::kinematic ? V : se3{};
  body.last_acceleration = {};
  if (motion == Motion::dynamic) {
    if (inertia) set_mass(body, *inertia);
    body.w = body.T.rotate(V.w);
    body.v = body.T.rotate(V.v + cross(V.w, body.centre));
  }
  body.bounding_radius = bounding_radius_of(body);
  body.moved();
  if (index + 1 < body_states.size()) body_states[index + 1] = {};
  std::fill_n(body.bounded_at, 6, 1e9f);
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) add_proxy(c);
  lists.invalidate();
}

Expected<void> World::set_inertia(BodyId id, const Inertia& inertia) {
  Body* body = impl_->find_body_to_change(id);
  if (!body) return impl_->no_body_to_change("set_inertia", id);
  if (auto problem = impl_->problem_with_mass(*body, velocity(id), inertia)) {
    return invalid("set_inertia: " + *problem);
  }
  body->mass_from_colliders = false;
  impl_->change_mass(id.index - 1, inertia);
  TopologyHash(impl_->topology_hash).add(change_bits(Change::inertia, id.index), inertia);
  if (impl_->recorder) impl_->log({calls::SetInertia{id, inertia}});
  return {};
}

Expected<void> World::set_damping(BodyId id, double linear, double angular) {
  Body* body = impl_->find_body_to_change(id);
  if (!body) return impl_->no_body_to_change("set_damping", id);
  if (!in_range(linear) || !in_range(angular) || linear < 0.0 || angular < 0.0) {
    return invalid("set_damping: damping must be from 0 to 1e9 1/s");
  }
  impl_->wake(id.index - 1);
  body->linear_damping = linear;
  body->angular_damping = angular;
  TopologyHash(impl_->topology_hash).add(change_bits(Change::damping, id.index), linear, angular);
  if (impl_->recorder) impl_->log({calls::SetDamping{id, linear, angular}});
  return {};
}

Expected<void> World::set_gravity_scale(BodyId id, double scale) {
  Body* body = impl_->find_body_to_change(id);
  if (!body) return impl_->no_body_to_change("set_gravity_scale", id);
  if (!is_gravity_scale(scale)) {
    return invalid("set_gravity_scale: the scale must be finite and at most 1e6 either way");
  }
  impl_->wake(id.index - 1);
  body->gravity_scale = scale;
  TopologyHash(impl_->topology_hash).add(change_bits(Change::gravity_scale, id.index), scale);
  if (impl_->recorder) impl_->log({calls::SetGravityScale{id, scale}});
  return {};
}

Expected<void> World::set_allow_sleep(BodyId id, bool allow) {
  Body* body = impl_->find_body_to_change(id);
  if (!body) return impl_->no_body_to_change("set_allow_sleep", id);
  impl_->wake(id.index - 1);
  body->allow_sleep = allow;
  TopologyHash(impl_->topology_hash)
      .add(change_bits(Change::allow_sleep, id.index), static_cast<std::uint64_t>(allow));
  if (impl_->recorder) impl_->log({calls::SetAllowSleep{id, allow}});
  return {};
}

// --- colliders -----------------------------------------------------------------------------------

bool World::contains(ColliderId id) const {
  return impl_->find(id) != nullptr;
}
BodyId World::body_of(ColliderId id) const {
  const Collider* c = impl_->find(id);
  return c ? impl_->bodies.id(c->body) : BodyId{};
}

Expected<void> World::set_material(ColliderId id, const Material& material) {
  Collider* c = impl_->find(id);
  if (!c) return unknown_id("set_material", "the collider");
  if (auto problem = problem_with(material)) return invalid("set_material: " + *problem);
  c->material = material;
  impl_->sub_step.some_bounce |= material.restitution > 0.0;
  impl_->wake_all_about(c->body);
  impl_->contact_store.mark_contacts_dirty(impl_->bodies[c->body]);
  TopologyHash(impl_->topology_hash)
      .add(change_bits(Change::material, id.index), material.friction, material.restitution,
           material.rolling_friction, material.spinning_friction);
  if (impl_->recorder) impl_->log({calls::SetMaterial{id, material}});
  return {};
}

Expected<void> World::set_surface_velocity(ColliderId id, const Vec3& velocity) {
  Collider* c = impl_->find(id);
  if (!c) return unknown_id("set_surface_velocity", "the collider");
  if (!in_range(velocity)) {
    return invalid("set_surface_velocity: every entry must be finite and at most 1e9");
  }
  c->surface_velocity = velocity;
  impl_->wake_all_about(c->body);
  impl_->contact_store.mark_contacts_dirty(impl_->bodies[c->body]);
  TopologyHash(impl_->topology_hash).add(change_bits(Change::surface_velocity, id.index), velocity);
  if (impl_->recorder) impl_->log({calls::SetSurfaceVelocity{id, velocity}});
  return {};
}

Expected<void> World::set_filter(ColliderId id, const CollisionFilter& filter) {
  Collider* c = impl_->find(id);
  if (!c) return unknown_id("set_filter", "the collider");
  Body& body = impl_->bodies[c->body];
  c->filter = filter;
  impl_->wake_all_about(c->body);
  if (!body.continuous) impl_->finder.set_filter(c->proxy, filter.category, filter.mask);
  impl_->contact_store.mark_contacts_dirty(impl_->bodies[c->body]);  // some may end
  body.categories = body.masks = 0;
  for (std::uint32_t i = body.first_collider; i != kNone; i = impl_->colliders[i].next) {
    body.categories |= impl_->colliders[i].filter.category;
    body.masks |= impl_->colliders[i].filter.mask;
  }
  impl_->ready_for_queries = false;
  impl_->lists.invalidate();
  TopologyHash(impl_->topology_hash)
      .add(change_bits(Change::filter, id.index),
           std::uint64_t{filter.category} << 32 | filter.mask);
  if (impl_->recorder) impl_->log({calls::SetFilter{id, filter}});
  return {};
}

Expected<void> World::remove_collider(ColliderId id) {
  const Collider* c = impl_->find(id);
  if (!c) return unknown_id("remove_collider", "the collider");
  const std::uint32_t body = c->body;
  if (impl_->bodies[body].mass_from_colliders && impl_->bodies[body].motion == Motion::dynamic) {
    const Inertia sum = inertia_of_colliders(impl_->bodies[body], impl_->colliders, id.index - 1);
    const se3 V = velocity(impl_->bodies.id(body));
    const Inertia left = sum.mass() > 0.0 ? sum : kUnitInertia;
    if (auto problem = impl_->problem_with_mass(impl_->bodies[body], V, left)) {
      return invalid("remove_collider: of what is left, " + *problem);
    }
  }
  impl_->take_collider_off(id.index - 1);
  TopologyHash(impl_->topology_hash).add(change_bits(Change::removed_collider, id.index));
  if (impl_->recorder) impl_->log({calls::RemoveCollider{id}});
  return {};
}

void World::Impl::take_collider_off(std::uint32_t index) {
  const std::uint32_t owner = colliders[index].body;
  Body& body = bodies[owner];
  if (body.is_link) update_if_remote(articulations[body.articulation]);
  release_collider(index);
  std::uint32_t previous = kNone;
  for (std::uint32_t c = body.first_collider; c != index; c = colliders[c].next) previous = c;
  (previous == kNone ? body.first_collider : colliders[previous].next) = colliders[index].next;
  if (body.last_collider == index) body.last_collider = previous;
  summarize_colliders(owner);
  update_mass(owner);
  contact_store.mark_contacts_dirty(bodies[owner]);
  body.moved();
  lists.invalidate();
}

// Recomputes the body's summary of its colliders.
void World::Impl::summarize_colliders(std::uint32_t index) {
  Body& body = bodies[index];
  const Body none;
  body.categories = body.masks = 0;
  body.has_sensor = body.unbounded = false;
  body.local = none.local;
  body.around_line = none.around_line;
  body.min_size = none.min_size;
  body.bounding_radius = none.bounding_radius;
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) note_collider(c);
}

// --- articulations -------------------------------------------------------------------------------

bool World::contains(ArticulationId id) const {
  return impl_->find(id) != nullptr;
}

Expected<void> World::destroy_articulation(ArticulationId id) {
  Articulation* art = impl_->find(id);
  if (!art) return invalid("destroy_articulation: no such articulation");
  impl_->update_if_remote(*art);
  for (const std::uint32_t b : art->bodies) {
    Body& body = impl_->bodies[b];
    for (std::uint32_t c = body.first_collider; c != kNone; c = impl_->colliders[c].next) {
      impl_->release_collider(c);
    }
    while (body.first_joint != kNone) impl_->remove_joint(body.first_joint / 2);
    body.w = body.v = {};
    body.first_collider = kNone;
    impl_->bodies.release(b);
  }
  art->destroy();
  impl_->free_articulations.push_back(id.index - 1);
  impl_->lists.invalidate();
  TopologyHash(impl_->topology_hash).add(change_bits(Change::destroyed_articulation, id.index));
  if (impl_->recorder) impl_->log({calls::DestroyArticulation{id}});
  return {};
}

}  // namespace vp
