#include "solve/contact_slot.h"

#include <algorithm>
#include <cmath>

#include "solve/state_vector.h"
#include "vphysics/lie/inertia.h"

namespace vp::solve {
namespace {

// The solver state of the body on one side of a contact.
struct Side {
  double mass;
  Sym3 inertia;
  Vec3 displacement, rotation;

  explicit Side(const BodyState& state)
      : mass(static_cast<double>(state.velocity[kInverseMass])),
        inertia{at(state.inertia, 0), at(state.inertia, 1), at(state.inertia, 2),
                at(state.inertia, 3), at(state.inertia, 4), at(state.inertia, 5)},
        displacement(vector_of(state.displacement)),
        rotation(vector_of(state.displacement + 3)) {}

 private:
  static double at(const float* f, int i) { return static_cast<double>(f[i]); }
};

void put(Field& f, int lane, double x) {
  f.lane[lane] = static_cast<float>(x);
}
void put(Field3& f, int lane, const Vec3& v) {
  put(f.x, lane, v.x);
  put(f.y, lane, v.y);
  put(f.z, lane, v.z);
}

Vec3 any_tangent(const Vec3& n) {
  const Vec3 t = std::fabs(n.x) < 0.6 ? Vec3{0, n.z, -n.y} : Vec3{-n.z, 0, n.x};
  return (1.0 / norm(t)) * t;
}

// Absent points get no impulse: their effective mass is zero and their separation is far.
template <int P>
void write_normals(ContactBlock<P>& block, int lane, const NewContact& c, const Vec3& t,
                   const Side& a, const Side& b) {
  const Vec3& n = c.normal;
  const Vec3 d_n = cross(c.x_a - c.x_b, n);
  const double linear = dot(n, b.displacement - a.displacement) + dot(d_n, b.rotation);
  Vec3 arm_a[4], arm_b[4], answer_a[4], answer_b[4];
  for (int i = 0; i < P; ++i) {
    if (i >= c.count) {
      put(block.arm[i].t, lane, 0.0);
      put(block.arm[i].b, lane, 0.0);
      put(block.base[i], lane, static_cast<double>(kFarSeparated));
      for (Field* f : {&block.impulse[i], &block.inverse[i]}) put(*f, lane, 0.0);
      for (int j = 0; j < i; ++j) put(block.off_diagonal[pair_index(i, j)], lane, 0.0);
      continue;
    }
    arm_a[i] = cross(c.points[i].position - c.x_a, n);
    arm_b[i] = arm_a[i] + d_n;
    answer_a[i] = a.inertia * arm_a[i];
    answer_b[i] = b.inertia * arm_b[i];
    for (int j = 0; j <= i; ++j) {
      const double k = a.mass + b.mass + dot(arm_a[j], answer_a[i]) + dot(arm_b[j], answer_b[i]);
      if (j < i) {
        put(block.off_diagonal[pair_index(i, j)], lane, k);
      } else {
        put(block.inverse[i], lane, k > 0.0 ? 1.0 / k : 0.0);
      }
    }
    put(block.arm[i].t, lane, dot(arm_a[i], t));
    put(block.arm[i].b, lane, dot(arm_a[i], cross(n, t)));
    put(block.base[i], lane,
        c.points[i].separation - linear - dot(arm_a[i], b.rotation - a.rotation));
    block.impulse[i].lane[lane] = c.points[i].impulse;
  }
}

// The mean of the points.
Vec3 centre_of_points(const NewContact& c) {
  Vec3 sum{};
  for (int i = 0; i < c.count; ++i) sum += c.points[i].position - c.points[0].position;
  return c.points[0].position + (1.0 / c.count) * sum;
}

template <int P>
void write_friction(ContactBlock<P>& block, int lane, const NewContact& c, const Vec3& t1,
                    const Side& a, const Side& b) {
  const Vec3& n = c.normal;
  const Vec3 centre = centre_of_points(c), r_a = centre - c.x_a, r_b = centre - c.x_b;
  const Vec3 t2 = cross(n, t1);
  const Vec3 a1 = cross(r_a, t1), a2 = cross(r_a, t2), b1 = cross(r_b, t1), b2 = cross(r_b, t2);
  const double mass = a.mass + b.mass;
  const double xx = mass + dot(a1, a.inertia * a1) + dot(b1, b.inertia * b1);
  const double xy = dot(a1, a.inertia * a2) + dot(b1, b.inertia * b2);
  const double yy = mass + dot(a2, a.inertia * a2) + dot(b2, b.inertia * b2);
  const double determinant = xx * yy - xy * xy, trace = xx + yy;
  const bool regular = determinant > 1e-6 * trace * trace;
  const double one = trace > 0.0 ? 1.0 / trace : 0.0;
  put(block.stick[0], lane, regular ? yy / determinant : one);
  put(block.stick[1], lane, regular ? -xy / determinant : 0.0);
  put(block.stick[2], lane, regular ? xx / determinant : one);
  const double largest = 0.5 * (trace + std::sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy));
  put(block.slide, lane, largest > 0.0 ? 1.0 / largest : 0.0);
  put(block.friction, lane, c.friction);
  put(block.tangent, lane, t1);
  put(block.grip, lane, r_a);
  put(block.tangent_impulse[0], lane, dot(t1, c.old_friction));
  put(block.tangent_impulse[1], lane, dot(t2, c.old_friction));
  put(block.surface_speed[0], lane, dot(t1, c.surface_velocity));
  put(block.surface_speed[1], lane, dot(t2, c.surface_velocity));

  double extent = 0.0;
  for (int i = 0; i < c.count; ++i) extent += norm(c.points[i].position - centre);
  const Sym3 both = a.inertia + b.inertia;
  const double turns = dot(n, both * n);
  put(block.twist_mass, lane, turns > 0.0 ? 1.0 / turns : 0.0);
  put(block.twist_arm, lane, c.friction * extent / c.count + c.spinning);
  put(block.twist_impulse, lane, turns > 0.0 ? dot(n, c.old_moment) : 0.0);
  const double turns_over = dot(t1, both * t1) + dot(t2, both * t2);
  const bool rolls = c.rolling > 0.0 && turns_over > 0.0;
  put(block.roll_mass, lane, rolls ? 1.0 / turns_over : 0.0);
  put(block.roll_arm, lane, c.rolling);
  // Without rolling resistance the old impulse is dropped: no pass would ever remove it.
  put(block.roll_impulse[0], lane, rolls ? dot(t1, c.old_moment) : 0.0);
  put(block.roll_impulse[1], lane, rolls ? dot(t2, c.old_moment) : 0.0);
  put(block.slid, lane,
      b.displacement + cross(b.rotation, r_b) - a.displacement - cross(a.rotation, r_a));
}

}  // namespace

template <int P>
void write_slot(ContactBlock<P>& block, int lane, const NewContact& c, const BodyState& state_a,
                const BodyState& state_b) {
  const Side a(state_a), b(state_b);
  put(block.active, lane, 1.0);
  put(block.normal, lane, c.normal);
  put(block.d, lane, c.x_a - c.x_b);
  const Vec3 t = any_tangent(c.normal);
  write_normals(block, lane, c, t, a, b);
  write_friction(block, lane, c, t, a, b);
  put(block.restitution, lane, c.restitution);
  put(block.rotated_a, lane, a.rotation);
  put(block.rotated_b, lane, b.rotation);
  put(block.slid_limit, lane, c.slid_limit);
}

template void write_slot<1>(ContactBlock<1>&, int, const NewContact&, const BodyState&,
                            const BodyState&);
template void write_slot<4>(ContactBlock<4>&, int, const NewContact&, const BodyState&,
                            const BodyState&);

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
