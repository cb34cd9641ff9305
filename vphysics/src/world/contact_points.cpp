// The contacts of a body in the last step.
//
// A contact slot stores the sum of the contact's normal impulses over the sub-steps, and the normal
// impulse of each point in the last sub-step. The sum is divided among the points in these
// proportions. Friction is that of the last sub-step, scaled by the same ratio.
#include "vphysics/assert.h"
#include "world/impl.h"
#include "world/lane_fields.h"

namespace vp {

namespace {

template <int P>
void add_points_of(const Contact& c, const solve::ContactBlock<P>& block, bool of_a,
                   const Colliders& colliders, std::vector<ContactPoint>& points) {
  const int lane = solve::ContactGraph::lane(c.slot);
  const double sign = of_a ? -1.0 : 1.0, all = get(block.given, lane);
  double last = 0.0;
  for (int i = 0; i < c.count; ++i) last += get(block.impulse[i], lane);
  const Vec3 n = get(block.normal, lane), t = get(block.tangent, lane);
  const Vec3 friction =
      get(block.tangent_impulse[0], lane) * t + get(block.tangent_impulse[1], lane) * cross(n, t);
  const double scale = last > 0.0 ? all / last : 0.0;
  for (int i = 0; i < c.count; ++i) {
    const double fraction = last > 0.0 ? get(block.impulse[i], lane) / last : 1.0 / c.count;
    ContactPoint& p = points.emplace_back();
    p.collider = colliders.id(of_a ? c.a : c.b);
    p.other = colliders.id(of_a ? c.b : c.a);
    p.point = c.position[i];
    p.normal = sign * n;
    p.normal_impulse = fraction * all;
    p.friction_impulse = (sign * fraction * scale) * friction;
  }
}

}  // namespace

void World::contacts_of(BodyId id, std::vector<ContactPoint>& points) const {
  const Body* body = impl_->find(id);
  VP_ASSERT(body && "contacts_of: the body does not exist (any more)");
  if (!body) return;
  const Impl& world = *impl_;
  const bool stepped = world.sub_steps_taken > 0;
  impl_->contact_store.for_each_of(*body, [&](std::uint32_t, const Contact& c) {
    if (!stepped || !c.touching || c.sensor || c.slot.points == 0) return;
    const bool of_a = world.colliders[c.a].body == id.index - 1;
    if (c.slot.points == 1) {
      add_points_of(c, world.contact_store.graph.block<1>(c.slot), of_a, world.colliders, points);
    } else {
      add_points_of(c, world.contact_store.graph.block<4>(c.slot), of_a, world.colliders, points);
    }
  });
  for (const StepContact& c : world.step_contacts) {
    const Collider *a = world.find(c.a), *b = world.find(c.b);
    if (!a || !b) continue;
    const bool of_a = a->body == id.index - 1;
    if (!of_a && b->body != id.index - 1) continue;
    const double sign = of_a ? -1.0 : 1.0;
    points.push_back({of_a ? c.a : c.b, of_a ? c.b : c.a, c.point, sign * c.normal, c.impulse,
                      sign * c.friction});
  }
}

}  // namespace vp
