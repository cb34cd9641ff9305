// Mass properties of bodies.
#include <algorithm>
#include <cmath>

#include "vphysics/assert.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/recorded_call.h"
#include "world/topology_hash.h"
#include "world/validate.h"

namespace vp {
namespace {

bool isotropic(const Sym3& I) {
  const double tolerance = 1e-12 * I.xx;
  const auto zero = [&](double x) { return std::fabs(x) <= tolerance; };
  return zero(I.xx - I.yy) && zero(I.xx - I.zz) && zero(I.xy) && zero(I.yz) && zero(I.zx);
}

}  // namespace

double bounding_radius_of(const Body& body) {
  const Vec3 centre = body.is_link || body.motion != Motion::dynamic ? Vec3{} : body.centre;
  const Vec3 lower = body.local.lower - centre, upper = body.local.upper - centre;
  return norm(Vec3{std::max(std::fabs(lower.x), std::fabs(upper.x)),
                   std::max(std::fabs(lower.y), std::fabs(upper.y)),
                   std::max(std::fabs(lower.z), std::fabs(upper.z))});
}

void set_mass(Body& body, const Inertia& inertia) {
  body.mass = inertia.mass();
  body.inverse_mass = 1.0 / body.mass;
  body.centre = inertia.centre_of_mass();
  body.central = inertia.central();
  body.inverse_central = inverse(body.central);
  body.isotropic = isotropic(body.central);
}

Expected<void> World::set_mass_from_colliders(BodyId id) {
  Body* body = impl_->find(id);
  if (!body) return unknown_id("set_mass_from_colliders", "the body");
  if (body->is_link) {
    return invalid("set_mass_from_colliders: a link has its model's mass");
  }
  if (body->motion != Motion::dynamic) {
    return invalid("set_mass_from_colliders: the body is not dynamic, so it needs no mass");
  }
  const Inertia sum = inertia_of_colliders(*body, impl_->colliders);
  if (sum.mass() == 0.0) {
    return invalid(
        "set_mass_from_colliders: the body has no collider with a volume but sensors; add "
        "one first");
  }
  if (auto problem = impl_->problem_with_mass(*body, velocity(id), sum)) {
    return invalid("set_mass_from_colliders: " + *problem);
  }
  impl_->change_mass(id.index - 1, sum);
  TopologyHash(impl_->topology_hash).add(0x700u + id.index, sum);
  if (impl_->recorder) impl_->log({calls::SetMassFromColliders{id}});
  return {};
}

Inertia World::inertia(BodyId id) const {
  const Body* body = impl_->find(id);
  VP_ASSERT(body && "inertia: the body does not exist (any more)");
  if (!body || body->motion != Motion::dynamic) return {};
  if (body->is_link) {
    return impl_->articulations[body->articulation].model().link(body->link).inertia;
  }
  return Inertia(body->mass, {}, body->central).about(-body->centre);
}

}  // namespace vp
