// Writes new contacts into the slots of a block, N lanes at a time, in double precision. The
// friction impulses of the last manifold remain, along the new tangents.
#pragma once

#include "solve/contact_block.h"
#include "solve/lanes.h"
#include "solve/new_contacts.h"

namespace vp::solve {

// Friction acts at the centre of the points that are near: whose separation exceeds the smallest by
// at most this many times slid_limit. The weight of others fades over so many times more.
inline constexpr double kNearPoints = 2.0, kFadingPoints = 8.0;

// N lanes from index `at` on. Only those in new_contacts.lanes are written.
template <int N, int P>
class RenewLanes {
 public:
  using D = PackT<double, N>;
  using V = Vec3T<D>;

  RenewLanes(ContactBlock<P>& block, const NewContacts& contacts, int at)
      : block_(block), new_(contacts), at_(at) {
    for (int i = 0; i < N; ++i) written_.lanes[i] = (contacts.lanes >> (at + i) & 1u) != 0 ? -1 : 0;
  }

  void renew() const {
    const V n = get(new_.normal);
    // Of the last manifold.
    const V n0 = old(block_.normal), t0 = old(block_.tangent), b0 = cross(n0, t0);
    const V friction = old(block_.tangent_impulse[0]) * t0 + old(block_.tangent_impulse[1]) * b0;
    const V moment = old(block_.twist_impulse) * n0 + old(block_.roll_impulse[0]) * t0 +
                     old(block_.roll_impulse[1]) * b0;
    const V t = any_tangent(n);
    put(block_.active, D(1.0));
    put(block_.normal, n);
    put(block_.tangent, t);
    put(block_.d, get(new_.a.x) - get(new_.b.x));
    put_normals(n, t);
    put_friction(n, t, friction, moment);
    put(block_.friction, get(new_.friction));
    put(block_.restitution, get(new_.restitution));
    put(block_.rotated_a, get(new_.a.rotation));
    put(block_.rotated_b, get(new_.b.rotation));
    put(block_.slid_limit, get(new_.slid_limit));
  }

 private:
  using F = PackT<float, N>;

  D get(const DoubleField& f) const {
    D d;
    __builtin_memcpy(&d.lanes, __builtin_assume_aligned(f.lane + at_, sizeof d.lanes),
                     sizeof d.lanes);
    return d;
  }
  V get(const DoubleField3& f) const { return {get(f.x), get(f.y), get(f.z)}; }
  Sym3T<D> get(const DoubleField (&f)[6]) const {
    return {get(f[0]), get(f[1]), get(f[2]), get(f[3]), get(f[4]), get(f[5])};
  }
  F float_of(const Field& f) const {
    F x;
    __builtin_memcpy(&x.lanes, __builtin_assume_aligned(f.lane + at_, sizeof x.lanes),
                     sizeof x.lanes);
    return x;
  }
  D old(const Field& f) const {
    return D(__builtin_convertvector(float_of(f).lanes, typename D::Lanes));
  }
  V old(const Field3& f) const { return {old(f.x), old(f.y), old(f.z)}; }
  void put(Field& f, const D& x) const {
    const F narrow(__builtin_convertvector(x.lanes, typename F::Lanes));
    const F result = select(written_, narrow, float_of(f));
    __builtin_memcpy(__builtin_assume_aligned(f.lane + at_, sizeof result.lanes), &result.lanes,
                     sizeof result.lanes);
  }
  void put(Field3& f, const V& x) const {
    put(f.x, x.x);
    put(f.y, x.y);
    put(f.z, x.z);
  }

  static V any_tangent(const V& n) {
    const D zero(0.0);
    const auto across = both(n.x < D(0.6), -n.x < D(0.6));
    const V t{select(across, zero, -n.z), select(across, n.z, zero), select(across, -n.y, n.x)};
    return (D(1.0) / norm(t)) * t;
  }

  // Absent points get no impulse: their effective mass is zero and their separation is far.
  void put_normals(const V& n, const V& t) const {
    const D zero(0.0), one(1.0);
    const Sym3T<D> inertia_a = get(new_.a.inertia), inertia_b = get(new_.b.inertia);
    const D mass = get(new_.a.inverse_mass) + get(new_.b.inverse_mass);
    const V x_a = get(new_.a.x), rotation_b = get(new_.b.rotation),
            rotation = rotation_b - get(new_.a.rotation);
    const V d_n = cross(x_a - get(new_.b.x), n), b = cross(n, t);
    const D linear =
        dot(n, get(new_.b.displacement) - get(new_.a.displacement)) + dot(d_n, rotation_b);
    const D count = get(new_.count);
    V arm_a[P], arm_b[P];
    for (int i = 0; i < P; ++i) {
      const auto there = count > D(static_cast<double>(i));
      arm_a[i] = cross(get(new_.position[i]) - x_a, n);
      arm_b[i] = arm_a[i] + d_n;
      const V response_a = inertia_a * arm_a[i], response_b = inertia_b * arm_b[i];
      for (int j = 0; j <= i; ++j) {
        const D k = mass + dot(arm_a[j], response_a) + dot(arm_b[j], response_b);
        if (j < i) {
          put(block_.off_diagonal[pair_index(i, j)], select(there, k, zero));
        } else {
          put(block_.inverse[i], select(both(there, k > zero), one / k, zero));
        }
      }
      put(block_.arm[i].t, select(there, dot(arm_a[i], t), zero));
      put(block_.arm[i].b, select(there, dot(arm_a[i], b), zero));
      put(block_.base[i], select(there, get(new_.separation[i]) - linear - dot(arm_a[i], rotation),
                                 D(static_cast<double>(kFarSeparated))));
      put(block_.impulse[i], select(there, get(new_.impulse[i]), zero));
    }
  }

  // friction, moment: the last impulses [N s], [N m s].
  void put_friction(const V& n, const V& t1, const V& friction, const V& moment) const {
    const D zero(0.0), one(1.0), count = get(new_.count);
    const Sym3T<D> inertia_a = get(new_.a.inertia), inertia_b = get(new_.b.inertia);
    const V first = get(new_.position[0]);
    D nearest(static_cast<double>(kFarSeparated));
    for (int i = 0; i < P; ++i) {
      const auto there = count > D(static_cast<double>(i));
      const D separation = get(new_.separation[i]);
      nearest = select(both(there, separation < nearest), separation, nearest);
    }
    const D fades = D(kFadingPoints) * get(new_.slid_limit);
    D weights(0.0), weight[P];
    V sum{zero, zero, zero};
    for (int i = 0; i < P; ++i) {
      const auto there = count > D(static_cast<double>(i));
      const D farther = get(new_.separation[i]) - nearest - D(kNearPoints) * get(new_.slid_limit);
      const D left = select(zero < farther, one - farther / select(zero < fades, fades, one), one);
      weight[i] = select(both(there, zero < left), left, zero);
      const V x = weight[i] * (get(new_.position[i]) - first);
      sum += V{select(there, x.x, zero), select(there, x.y, zero), select(there, x.z, zero)};
      weights += weight[i];
    }
    const V centre = first + (one / weights) * sum;  // the weighted mean of the points
    const V r_a = centre - get(new_.a.x), r_b = centre - get(new_.b.x), t2 = cross(n, t1);
    const V a1 = cross(r_a, t1), a2 = cross(r_a, t2), b1 = cross(r_b, t1), b2 = cross(r_b, t2);
    const D mass = get(new_.a.inverse_mass) + get(new_.b.inverse_mass);
    const D xx = mass + dot(a1, inertia_a * a1) + dot(b1, inertia_b * b1);
    const D xy = dot(a1, inertia_a * a2) + dot(b1, inertia_b * b2);
    const D yy = mass + dot(a2, inertia_a * a2) + dot(b2, inertia_b * b2);
    const D determinant = xx * yy - xy * xy, trace = xx + yy;
    const auto regular = determinant > D(1e-6) * trace * trace;
    const D single = select(trace > zero, one / trace, zero);
    put(block_.stick[0], select(regular, yy / determinant, single));
    put(block_.stick[1], select(regular, -xy / determinant, zero));
    put(block_.stick[2], select(regular, xx / determinant, single));
    const D largest = D(0.5) * (trace + sqrt((xx - yy) * (xx - yy) + D(4.0) * xy * xy));
    put(block_.slide, select(largest > zero, one / largest, zero));
    put(block_.grip, r_a);
    put(block_.tangent_impulse[0], dot(t1, friction));
    put(block_.tangent_impulse[1], dot(t2, friction));
    const V surface_velocity = get(new_.surface_velocity);
    put(block_.surface_speed[0], dot(t1, surface_velocity));
    put(block_.surface_speed[1], dot(t2, surface_velocity));

    D extent(0.0);
    for (int i = 0; i < P; ++i) {
      const auto there = count > D(static_cast<double>(i));
      extent += select(there, weight[i] * norm(get(new_.position[i]) - centre), zero);
    }
    const Sym3T<D> inertia = inertia_a + inertia_b;
    const D about_n = dot(n, inertia * n);
    const auto twists = about_n > zero;
    put(block_.twist_mass, select(twists, one / about_n, zero));
    put(block_.twist_arm, get(new_.friction) * extent / weights + get(new_.spinning));
    put(block_.twist_impulse, select(twists, dot(n, moment), zero));
    const D about_tangents = dot(t1, inertia * t1) + dot(t2, inertia * t2);
    const D rolling = get(new_.rolling);
    const auto rolls = both(rolling > zero, about_tangents > zero);
    put(block_.roll_mass, select(rolls, one / about_tangents, zero));
    put(block_.roll_arm, rolling);
    // Without rolling resistance the old impulse is dropped: no pass would ever remove it.
    put(block_.roll_impulse[0], select(rolls, dot(t1, moment), zero));
    put(block_.roll_impulse[1], select(rolls, dot(t2, moment), zero));
    const V rotation_a = get(new_.a.rotation), rotation_b = get(new_.b.rotation);
    put(block_.slid, get(new_.b.displacement) + cross(rotation_b, r_b) - get(new_.a.displacement) -
                         cross(rotation_a, r_a));
  }

  ContactBlock<P>& block_;
  const NewContacts& new_;
  int at_;
  PackMaskT<float, N> written_;
};

}  // namespace vp::solve
