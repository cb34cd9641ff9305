// The user's forces and torques on bodies and joints for the next step.
//
//   v' = s g + F / m,   w' = I^-1 M      s: the body's gravity_scale
//
// F and M, about the centre of mass, are constant in the world frame during the step. Like gravity
// they are distributed over its sub-steps, so that contacts and joints respond to them as a load.
// They are cleared at the end of the step. The load of a link is about its origin and acts on its
// articulation through the joints (articulation_forces.cpp).
#include <algorithm>
#include <string>

#include "world/impl.h"
#include "world/invalid.h"
#include "world/recorded_call.h"
#include "world/validate.h"

namespace vp {

Velocity BodyLoads::acceleration(const Body& body, const Vec3& gravity) const {
  Velocity a{{}, body.gravity_scale * gravity};
  if (body.load == kNone) return a;
  const BodyLoad& load = loads_[body.load];
  a.v += body.inverse_mass * load.force;
  if (is_torqued(body)) {
    a.w = rotated(body.T.rotation(), body.inverse_central) * load.torque;
  }
  return a;
}

bool load_in_range(const Body& body, const Mat3& R, const Vec3& force, const Vec3& torque) {
  const Vec3 w = rotated(R, body.inverse_central) * torque;
  return in_range((kLongestStep * body.inverse_mass) * force) && in_range(kLongestStep * w);
}

bool BodyLoads::load_in_range(const Body& body, const Inertia& inertia, const SE3& T) const {
  if (body.load == kNone) return true;
  const BodyLoad& load = loads_[body.load];
  Body changed = body;
  set_mass(changed, inertia);
  const Vec3 arm = T.rotate(body.centre - changed.centre);
  return vp::load_in_range(changed, T.rotation(), load.force, load.torque + cross(arm, load.force));
}

void BodyLoads::set(Bodies& bodies, std::uint32_t index, const Vec3& force, const Vec3& torque) {
  Body& body = bodies[index];
  if (body.load == kNone) {
    body.load = static_cast<std::uint32_t>(loads_.size());
    loads_.push_back({index, {}, {}});
  }
  loads_[body.load].force = force;
  loads_[body.load].torque = torque;
}

void BodyLoads::shift(const Body& body, const Vec3& arm) {
  if (body.load == kNone) return;
  BodyLoad& load = loads_[body.load];
  load.torque += cross(arm, load.force);
}

void BodyLoads::remove(Bodies& bodies, std::uint32_t index) {
  const std::uint32_t load = bodies[index].load;
  if (load == kNone) return;
  bodies[index].load = kNone;
  loads_[load] = loads_.back();
  loads_.pop_back();
  if (load < loads_.size()) bodies[loads_[load].body].load = load;
}

void BodyLoads::clear(Bodies& bodies) {
  for (const BodyLoad& load : loads_) bodies[load.body].load = kNone;
  loads_.clear();
}

void World::Impl::clear_loads() {
  loads.clear(bodies);
  for (Articulation& art : articulations) art.clear_loads();
}

// torque: about the centre of mass; for a link about its origin.
Expected<void> World::Impl::add_load(const char* call, BodyId id, const Vec3& force,
                                     const Vec3& torque) {
  Body& body = *find(id);
  const std::uint32_t index = id.index - 1;
  Vec3 F = force, M = torque;
  if (body.is_link) {
    Articulation& art = articulations[body.articulation];
    const dse3 before = art.load(body.link);
    F += before.f;
    M += before.m;
  } else if (const BodyLoad* before = loads.of(body)) {
    F += before->force;
    M += before->torque;
  }
  const bool good =
      body.is_link ? in_range(F) && in_range(M) : load_in_range(body, body.T.rotation(), F, M);
  if (!good) {
    return invalid(std::string(call) +
                   ": the body would become faster than 1e9 m/s or rad/s, or a link bear more than "
                   "1e9 N or N m; apply less");
  }
  if (body.is_link) {
    Articulation& art = articulations[body.articulation];
    update_if_remote(art);
    art.set_load(body.link, {M, F});
  } else {
    wake(index);
    loads.set(bodies, index, F, M);
  }
  return {};
}

Expected<void> World::apply_force(BodyId id, const Vec3& force, const Vec3& point) {
  const Body* body = impl_->find(id);
  if (!body) return unknown_id("apply_force", "the body");
  if (body->motion != Motion::dynamic) return invalid("apply_force: the body is not dynamic");
  if (!std::isfinite(dot(force, force)) || !in_range(point)) {
    return invalid("apply_force: force and point must be finite, the point within 1e9 m");
  }
  Vec3 from = reference_point(*body);
  if (body->is_link) {
    impl_->update_if_remote(impl_->articulations[body->articulation]);
    from = impl_->articulations[body->articulation].T_world_link(body->link).position();
  }
  const auto added = impl_->add_load("apply_force", id, force, cross(point - from, force));
  if (added && impl_->recorder) impl_->log({calls::ApplyForce{id, force, point}});
  return added;
}

Expected<void> World::apply_force(BodyId id, const Vec3& force) {
  const Body* body = impl_->find(id);
  if (!body) return unknown_id("apply_force", "the body");
  return apply_force(id, force, impl_->centre_of_mass(*body));
}

Expected<void> World::apply_torque(BodyId id, const Vec3& torque) {
  const Body* body = impl_->find(id);
  if (!body) return unknown_id("apply_torque", "the body");
  if (body->motion != Motion::dynamic) return invalid("apply_torque: the body is not dynamic");
  if (!std::isfinite(dot(torque, torque)))
    return invalid("apply_torque: the torque must be finite");
  const auto added = impl_->add_load("apply_torque", id, {}, torque);
  if (added && impl_->recorder) impl_->log({calls::ApplyTorque{id, torque}});
  return added;
}

Expected<void> World::apply_joint_force(ArticulationId id, int link, int dof, double force) {
  Articulation* art = impl_->find(id);
  const int i = art ? art->dof_index(link, dof) : -1;
  if (i < 0) {
    return invalid(
        "apply_joint_force: no such degree of freedom; check articulation, link and dof");
  }
  const double sum = art->joint_load(static_cast<std::size_t>(i)) + force;
  if (!in_range(sum)) {
    return invalid("apply_joint_force: the sum of the forces must be finite and at most 1e9");
  }
  impl_->update_if_remote(*art);
  art->set_joint_load(static_cast<std::size_t>(i), sum);
  if (impl_->recorder) {
    impl_->log({calls::ApplyJointForce{id, static_cast<std::uint32_t>(link),
                                       static_cast<std::uint32_t>(dof), force}});
  }
  return {};
}

}  // namespace vp
