// Construction of a world's bodies; access to their state.
#include "vphysics/world.h"

#include <algorithm>
#include <utility>

#include "vphysics/assert.h"
#include "vphysics/recording.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/recorded_call.h"
#include "world/topology_hash.h"
#include "world/validate.h"

namespace vp {
World::World(const WorldDesc& desc) : impl_(std::make_unique<Impl>()) {
  VP_ASSERT(!problem_with(desc));
  impl_->given_desc = desc;
  impl_->desc = desc;
  impl_->desc.contact_slop *= desc.length_unit;
  impl_->speed_unit = std::sqrt(desc.length_unit);
  impl_->desc.restitution_threshold *= impl_->speed_unit;
  impl_->desc.sleep_speed *= impl_->speed_unit;
  impl_->body_states.resize(1);
  TopologyHash(impl_->topology_hash).add(desc);
}
Expected<World> World::create(const WorldDesc& desc) {
  if (auto problem = problem_with(desc)) return invalid("World: " + *problem);
  return World(desc);
}
World::~World() {
  if (impl_) (void)record(nullptr);
}
World::World(World&&) noexcept = default;
World& World::operator=(World&& other) noexcept {
  World gone(std::move(*this));
  impl_ = std::move(other.impl_);
  return *this;
}

Vec3 World::Impl::centre_of_mass(const Body& body) {
  if (!body.is_link) return reference_point(body);
  Articulation& art = articulations[body.articulation];
  update_if_remote(art);
  const Inertia& inertia = art.model().link(body.link).inertia;
  const SE3 T = art.T_world_link(body.link);
  return inertia.mass() > 0.0 ? T * inertia.centre_of_mass() : T.position();
}

Expected<BodyId> World::create_body(const BodyDesc& desc) {
  if (auto problem = problem_with(desc)) return invalid("create_body: " + *problem);
  const std::uint32_t index = impl_->bodies.take();
  Body& body = impl_->bodies[index];
  body.motion = desc.motion;
  body.requested_continuous = desc.continuous;
  body.continuous = desc.continuous && desc.motion == Motion::dynamic;
  body.user_data = desc.user_data;
  body.T = SE3(orthonormalized(desc.T_world_body.rotation()), desc.T_world_body.position());
  body.linear_damping = desc.linear_damping;
  body.angular_damping = desc.angular_damping;
  body.gravity_scale = desc.gravity_scale;
  body.allow_sleep = desc.allow_sleep;
  body.mass_from_colliders = has_no_inertia(desc) || problem_with(desc.inertia).has_value();
  if (!body.mass_from_colliders) set_mass(body, desc.inertia);
  impl_->update_mass(index);
  if (index + 1 < impl_->body_states.size()) impl_->body_states[index + 1] = {};
  TopologyHash(impl_->topology_hash).add(0x100u + index, desc);
  const BodyId id = impl_->bodies.id(index);
  impl_->lists.invalidate();
  if (desc.motion != Motion::fixed) impl_->set_body_velocity(index, desc.velocity);
  if (impl_->recorder) impl_->log({calls::CreateBody{desc}});
  return id;
}

// Ends all contacts of a collider. The next step reports their end events.
void World::Impl::drop_contacts(std::uint32_t index) {
  pair_contacts.forget(index);
  const Collider& collider = colliders[index];
  wake(collider.body);
  wake_neighbours(collider.body);
  contact_store.for_each_of(bodies[collider.body], [&](std::uint32_t contact, Contact& c) {
    if (c.is_part() || (c.a != index && c.b != index))
      return;  // parts precede their aggregate in the list
    if (c.touching) {
      events.destroyed.push_back({colliders.id(c.a), colliders.id(c.b), c.sensor});
      c.touching = false;
    }
    contact_search.drop(contact);
  });
  ready_for_queries = false;
}

void World::Impl::release_collider(std::uint32_t index) {
  drop_contacts(index);
  Collider& collider = colliders[index];
  finder.remove(collider.proxy);
  collider.shape = HalfSpace{};
  colliders.release(index);
}

Expected<void> World::destroy_body(BodyId id) {
  Body* body = impl_->find(id);
  if (!body) return unknown_id("destroy_body", "the body");
  if (body->is_link) return invalid("destroy_body: a link lives as long as its articulation");
  for (std::uint32_t c = body->first_collider; c != kNone; c = impl_->colliders[c].next) {
    impl_->release_collider(c);
  }
  while (body->first_joint != kNone) impl_->remove_joint(body->first_joint / 2);
  impl_->loads.remove(impl_->bodies, id.index - 1);
  body->w = body->v = {};
  body->prescribed = {};
  body->last_acceleration = {};
  if (id.index < impl_->body_states.size()) impl_->body_states[id.index] = {};
  body->first_collider = kNone;
  impl_->lists.invalidate();
  impl_->bodies.release(id.index - 1);
  TopologyHash(impl_->topology_hash).add(0x200u + id.index);
  if (impl_->recorder) impl_->log({calls::DestroyBody{id}});
  return {};
}

void World::Impl::note_collider(std::uint32_t index) {
  Body& body = bodies[colliders[index].body];
  vp::note_collider(body, colliders[index],
                    body.is_link ? articulations[body.articulation].line_of(body.link) : Vec3{});
}

Expected<ColliderId> World::add_collider(BodyId body_handle, const ColliderDesc& desc) {
  Body* body = impl_->find(body_handle);
  if (!body) return unknown_id("add_collider", "the body");
  if (auto problem = problem_with(desc)) return invalid("add_collider: " + *problem);
  const bool surface = std::holds_alternative<TriangleMesh>(desc.shape) ||
                       std::holds_alternative<HeightField>(desc.shape);
  if (surface && body->motion == Motion::dynamic) {
    return invalid(Errc::unsupported,
                   "add_collider: meshes and height fields cannot belong to a dynamic body; "
                   "give a dynamic body or a link a compound of convex hulls");
  }
  const bool half_space = std::holds_alternative<HalfSpace>(desc.shape);
  if (half_space && (body->motion != Motion::fixed)) {
    return invalid("add_collider: a half-space needs a fixed body");
  }
  const bool adds_mass = body->mass_from_colliders && body->motion == Motion::dynamic;
  if (adds_mass && !desc.sensor) {
    const Inertia sum = inertia_of_colliders(*body, impl_->colliders) +
                        solid_inertia(desc.shape, desc.density).InvXform(desc.T_body_shape);
    if (auto problem = impl_->problem_with_mass(*body, velocity(body_handle), sum)) {
      return invalid("add_collider: with it, " + *problem);
    }
  }
  const std::uint32_t index = impl_->colliders.take();
  Collider& c = impl_->colliders[index];
  c.body = body_handle.index - 1;
  c.sensor = desc.sensor;
  c.serial = impl_->next_serial++;
  c.shape = desc.shape;
  c.geometry = collide::make_geometry(c.shape);
  c.T_body_shape = SE3(orthonormalized(desc.T_body_shape.rotation()), desc.T_body_shape.position());
  c.material = desc.material;
  impl_->sub_step.some_bounce |= c.material.restitution > 0.0;
  c.density = desc.density;
  c.surface_velocity = desc.surface_velocity;
  c.filter = desc.filter;
  c.user_data = desc.user_data;
  (body->last_collider == kNone ? body->first_collider
                                : impl_->colliders[body->last_collider].next) = index;
  body->last_collider = index;
  body->moved();
  if (body->is_link) impl_->follow(impl_->articulations[body->articulation]);
  impl_->note_collider(index);
  if (adds_mass) impl_->update_mass(c.body);
  impl_->lists.invalidate();
  impl_->wake(c.body);
  impl_->add_proxy(index);
  TopologyHash(impl_->topology_hash).add(0x300u + index, body_handle.index, desc);
  if (impl_->recorder) impl_->log({calls::AddCollider{body_handle, desc}});
  return impl_->colliders.id(index);
}

bool World::contains(BodyId id) const {
  return impl_->find(id) != nullptr;
}

SE3 World::pose(BodyId id) const {
  const Body* body = impl_->find(id);
  VP_ASSERT(body && "pose: the body does not exist (any more)");
  if (!body) return {};
  if (body->is_link) impl_->update_if_remote(impl_->articulations[body->articulation]);
  return body->is_link ? impl_->articulations[body->articulation].T_world_link(body->link)
                       : body->T;
}

se3 World::velocity(BodyId id) const {
  const Body* body = impl_->find(id);
  VP_ASSERT(body && "velocity: the body does not exist (any more)");
  if (!body) return {};
  if (body->motion == Motion::kinematic) return body->prescribed;
  if (body->is_link) {
    Articulation& art = impl_->articulations[body->articulation];
    impl_->update_if_remote(art);
    const SE3 T = art.T_world_link(body->link);
    const se3 V = art.link_velocity(body->link, T.position());
    return {T.unrotate(V.w), T.unrotate(V.v)};
  }
  const Vec3 v = body->v + cross(body->w, body->T.position() - reference_point(*body));
  return {body->T.unrotate(body->w), body->T.unrotate(v)};
}

VelocityWorld World::velocity_world(BodyId id) const {
  const Body* body = impl_->find(id);
  VP_ASSERT(body && "velocity_world: the body does not exist (any more)");
  if (!body) return {};
  return {velocity_at(id, impl_->centre_of_mass(*body)), pose(id).rotate(velocity(id).w)};
}

Vec3 World::velocity_at(BodyId id, const Vec3& point) const {
  VP_ASSERT(impl_->find(id) && "velocity_at: the body does not exist (any more)");
  const SE3 T = pose(id);
  const se3 V = velocity(id);
  return T.rotate(V.v) + cross(T.rotate(V.w), point - T.position());
}

Expected<void> World::set_velocity_world(BodyId id, const VelocityWorld& velocity) {
  const Body* body = impl_->find(id);
  if (!body) return unknown_id("set_velocity_world", "the body");
  if (!in_range(velocity.linear) || !in_range(velocity.angular)) {
    return invalid("set_velocity_world: every entry must be finite and at most 1e9");
  }
  const SE3& T = body->T;
  const Vec3 from = T.position() - reference_point(*body);
  return set_velocity(id, {T.unrotate(velocity.angular),
                           T.unrotate(velocity.linear + cross(velocity.angular, from))});
}

Expected<void> World::set_pose(BodyId id, const SE3& T) {
  Body* body = impl_->find(id);
  if (!body) return unknown_id("set_pose", "the body");
  if (body->is_link) return invalid("set_pose: a link is placed by its joint; use set_joint_state");
  if (!is_pose(T)) return invalid("set_pose: the pose must be a finite rotation and position");
  if (!impl_->loads.load_in_range(*body, inertia(id), T)) {
    return invalid(std::string("set_pose: ") + kLoadOutOfRange);
  }
  body->T = SE3(orthonormalized(T.rotation()), T.position());
  body->moved();
  impl_->jumped(id.index - 1);
  if (impl_->recorder) impl_->log({calls::SetPose{id, T}});
  return {};
}

Expected<void> World::set_velocity(BodyId id, const se3& V) {
  Body* body = impl_->find(id);
  if (!body) return unknown_id("set_velocity", "the body");
  if (body->is_link)
    return invalid("set_velocity: a link is moved by its joint; use set_joint_state");
  if (body->motion == Motion::fixed) return invalid("set_velocity: the body is fixed");
  if (!in_range(V)) return invalid("set_velocity: every entry must be finite and at most 1e9");
  if (!nearly_in_range(V.v + cross(V.w, body->centre))) {
    return invalid("set_velocity: the centre of mass would move faster than 1e9 m/s");
  }
  impl_->set_body_velocity(id.index - 1, V);
  if (impl_->recorder) impl_->log({calls::SetVelocity{id, V}});
  return {};
}

void World::Impl::set_body_velocity(std::uint32_t index, const se3& V) {
  Body& body = bodies[index];
  if (body.motion == Motion::kinematic) {
    body.prescribed = V;
    if (!(V == se3{})) wake_neighbours(index);
    return;
  }
  wake(index);
  body.w = body.T.rotate(V.w);
  body.v = body.T.rotate(V.v + cross(V.w, body.centre));
}

Expected<void> World::apply_impulse(BodyId id, const Vec3& impulse, const Vec3& point) {
  Body* body = impl_->find(id);
  if (!body) return unknown_id("apply_impulse", "the body");
  if (body->motion != Motion::dynamic) return invalid("apply_impulse: the body is not dynamic");
  const double bears = body->is_link ? 1.0 : std::max(1.0, body->mass);  // for 1e9 m/s
  if (!in_range((1.0 / bears) * impulse) || !in_range(point)) {
    return invalid("apply_impulse: impulse and point must be finite and at most 1e9");
  }
  constexpr const char* kTooMuch =
      "apply_impulse: the body would move faster than 1e9 m/s or rad/s; apply less";
  if (body->is_link) {
    Articulation& art = impl_->articulations[body->articulation];
    if (!art.apply_impulse(body->link, impulse, point)) return invalid(kTooMuch);
    impl_->follow(art);
  } else {
    const Vec3 moment = cross(point - reference_point(*body), impulse);
    const Vec3 v = body->v + (1.0 / body->mass) * impulse;
    const Vec3 w = body->w + rotated(body->T.rotation(), body->inverse_central) * moment;
    if (!nearly_in_range(v) || !nearly_in_range(w)) return invalid(kTooMuch);
    impl_->wake(id.index - 1);
    body->v = v;
    body->w = w;
  }
  if (impl_->recorder) impl_->log({calls::ApplyImpulse{id, impulse, point}});
  return {};
}

void World::set_task_scheduler(std::shared_ptr<TaskScheduler> scheduler) {
  impl_->workers.scheduler = std::move(scheduler);
}

void World::observe_stages(std::shared_ptr<StageObserver> observer) {
  impl_->observer = std::move(observer);
}

std::span<const ContactEvent> World::contact_events() const {
  return impl_->events.all();
}
const StepCounters& World::counters() const {
  return impl_->counters;
}

}  // namespace vp
