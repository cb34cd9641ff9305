#include "solve/contact_slot.h"

#include <algorithm>

namespace vp::solve {
namespace {

void put(DoubleField3& f, int lane, const Vec3& v) {
  f.x.lane[lane] = v.x;
  f.y.lane[lane] = v.y;
  f.z.lane[lane] = v.z;
}

void put(DoubleField3& f, int lane, const float* v) {
  f.x.lane[lane] = static_cast<double>(v[0]);
  f.y.lane[lane] = static_cast<double>(v[1]);
  f.z.lane[lane] = static_cast<double>(v[2]);
}

void put(NewContactSide& side, int lane, const Vec3& x, const BodyState& state) {
  put(side.x, lane, x);
  side.inverse_mass.lane[lane] = static_cast<double>(state.velocity[kInverseMass]);
  for (int i = 0; i < 6; ++i) side.inertia[i].lane[lane] = static_cast<double>(state.inertia[i]);
  put(side.displacement, lane, state.displacement);
  put(side.rotation, lane, state.displacement + 3);
}

}  // namespace

void put(NewContacts& to, int lane, const NewContact& c, const BodyState& a, const BodyState& b) {
  to.lanes |= 1u << lane;
  put(to.normal, lane, c.normal);
  put(to.a, lane, c.x_a, a);
  put(to.b, lane, c.x_b, b);
  to.count.lane[lane] = c.count;
  for (int i = 0; i < 4; ++i) {
    // A number is needed for absent points too.
    const NewPoint& p = c.points[std::min(i, std::max(c.count - 1, 0))];
    put(to.position[i], lane, p.position);
    to.separation[i].lane[lane] = p.separation;
    to.impulse[i].lane[lane] = static_cast<double>(p.impulse);
  }
  to.friction.lane[lane] = c.friction;
  to.restitution.lane[lane] = c.restitution;
  to.rolling.lane[lane] = c.rolling;
  to.spinning.lane[lane] = c.spinning;
  put(to.surface_velocity, lane, c.surface_velocity);
  to.slid_limit.lane[lane] = c.slid_limit;
}

template <int P>
void rescale_impulses(ContactBlock<P>& block, float factor) {
  const auto rescale = [factor](Field& field) {
    for (float& p : field.lane) p *= factor;
  };
  for (Field& p : block.impulse) rescale(p);
  for (Field& p : block.tangent_impulse) rescale(p);
  for (Field& p : block.roll_impulse) rescale(p);
  rescale(block.twist_impulse);
  for (float& active : block.active.lane) active = 1.0f;  // its load may have become zero
}

template void rescale_impulses<1>(ContactBlock<1>&, float);
template void rescale_impulses<4>(ContactBlock<4>&, float);

}  // namespace vp::solve
