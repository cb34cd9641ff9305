// Shared by all passes over blocks: gathers body states into SIMD lanes and scatters them back.
#pragma once

#include "solve/body_state.h"
#include "solve/field.h"
#include "solve/lanes.h"

namespace vp::solve {

// W slots of a block from index `at` on, with the velocities of their bodies. A block stores the
// indices of its bodies' states, a and b, and copies of their inverse inertias, inertia_a and
// inertia_b.
template <int W, class BLOCK>
class BlockLanes {
 public:
  using F = Lanes<W>;
  using V = Vec3T<F>;
  using S = Sym3T<F>;
  using Block = BLOCK;

  BlockLanes(Block& block, int at, BodyState* states) : block_(block), at_(at), states_(states) {}

  F get(const Field& f) const { return F(lanes::load<W>(f.lane + at_)); }
  V get(const Field3& f) const { return {get(f.x), get(f.y), get(f.z)}; }
  S get(const FieldSym3& f) const {
    return {get(f.xx), get(f.yy), get(f.zz), get(f.xy), get(f.yz), get(f.zx)};
  }
  void put(Field& f, const F& x) const { lanes::store<W>(f.lane + at_, x.lanes); }
  void put(Field3& f, const V& x) const {
    put(f.x, x.x);
    put(f.y, x.y);
    put(f.z, x.z);
  }
  Block& block() const { return block_; }

  void load_inertias() const {
    load_inertias([this](int i) { return state_a(i).inertia; }, block_.inertia_a);
    load_inertias([this](int i) { return state_b(i).inertia; }, block_.inertia_b);
  }
  void gather_velocities() {
    F r[8];
    lanes::gather8<W>([this](int i) { return state_a(i).velocity; }, r);
    take_velocity(r, v_a, w_a, mass_a_, falls_a);
    lanes::gather8<W>([this](int i) { return state_b(i).velocity; }, r);
    take_velocity(r, v_b, w_b, mass_b_, falls_b);
  }
  void gather_velocities_and_displacements() {
    F r[16];
    lanes::gather16<W>([this](int i) { return first_line(state_a(i)); }, r);
    take_velocity(r, v_a, w_a, mass_a_, falls_a);
    read_displacement(r + 8, x_a, rotation_a, supported_a_, fraction_minus_one_a_);
    lanes::gather16<W>([this](int i) { return first_line(state_b(i)); }, r);
    take_velocity(r, v_b, w_b, mass_b_, falls_b);
    read_displacement(r + 8, x_b, rotation_b, supported_b_, fraction_minus_one_b_);
  }
  void scatter_velocities() const { scatter_velocities(F(0.0f) < F(1.0f)); }
  // Writes only the lanes in `of`.
  void scatter_velocities(const LaneMask<W>& of) const {
    const F a[8] = {v_a.x, v_a.y, v_a.z, w_a.x, w_a.y, w_a.z, mass_a_, falls_a};
    const F b[8] = {v_b.x, v_b.y, v_b.z, w_b.x, w_b.y, w_b.z, mass_b_, falls_b};
    scatter([this](int i) { return state_a(i).velocity; }, a, both(is_movable_a(), of));
    scatter([this](int i) { return state_b(i).velocity; }, b, both(is_movable_b(), of));
  }
  void scatter_displacements() const {
    const F a[8] = {x_a.x,        x_a.y,        x_a.z,        rotation_a.x,
                    rotation_a.y, rotation_a.z, supported_a_, fraction_minus_one_a_};
    const F b[8] = {x_b.x,        x_b.y,        x_b.z,        rotation_b.x,
                    rotation_b.y, rotation_b.z, supported_b_, fraction_minus_one_b_};
    scatter([this](int i) { return state_a(i).displacement; }, a, is_movable_a());
    scatter([this](int i) { return state_b(i).displacement; }, b, is_movable_b());
  }
  // Moves both bodies, and adds that to the shifts.
  void shift(const V& by_a, const V& rotation_by_a, const V& by_b, const V& rotation_by_b,
             BounceShift* shifts) {
    x_a += by_a;
    rotation_a += rotation_by_a;
    x_b += by_b;
    rotation_b += rotation_by_b;
    scatter_displacements();
    const auto add = [shifts](std::uint32_t state, const V& x, const V& rotation, int i) {
      const F* const by[6] = {&x.x, &x.y, &x.z, &rotation.x, &rotation.y, &rotation.z};
      for (int k = 0; k < 6; ++k) shifts[state].displacement[k] += by[k]->lanes[i];
    };
    const unsigned a = lanes::bits_of(is_movable_a()), b = lanes::bits_of(is_movable_b());
    for (int i = 0; i < W; ++i) {
      if ((a >> i & 1u) != 0) add(block_.a.lane[at_ + i], by_a, rotation_by_a, i);
      if ((b >> i & 1u) != 0) add(block_.b.lane[at_ + i], by_b, rotation_by_b, i);
    }
  }
  // Linear accelerations by forces. Only the restitution pass reads them.
  void gather_accelerations(V& a, V& b) const {
    F r[8];
    lanes::gather8<W>([this](int i) { return state_a(i).rate; }, r);
    a = {r[0], r[1], r[2]};
    lanes::gather8<W>([this](int i) { return state_b(i).rate; }, r);
    b = {r[0], r[1], r[2]};
  }

  // Applies linear impulses and angular impulses about the centres of mass to both bodies.
  void apply_impulse(const V& linear_a, const V& angular_a, const V& linear_b, const V& angular_b) {
    v_a += mass_a_ * linear_a;
    v_b += mass_b_ * linear_b;
    w_a += get(block_.inertia_a) * angular_a;
    w_b += get(block_.inertia_b) * angular_b;
  }
  void apply_linear(const V& p) {
    v_a -= mass_a_ * p;
    v_b += mass_b_ * p;
  }
  void apply_angular(const V& on_a, const V& on_b) {
    w_a -= get(block_.inertia_a) * on_a;
    w_b += get(block_.inertia_b) * on_b;
  }

  const F& inverse_mass_a() const { return mass_a_; }
  const F& inverse_mass_b() const { return mass_b_; }
  // The fraction of the maximum bias velocity: the smaller of the two bodies' values. Precondition:
  // the displacements were gathered.
  F fraction() const { return F(1.0f) + smaller(fraction_minus_one_a_, fraction_minus_one_b_); }
  // Divides a displacement of b relative to a between the two, by inverse mass: the fraction of
  // each.
  void split(F& by_a, F& by_b) const {
    const F both = mass_a_ + mass_b_;
    const F inverse = F(1.0f) / select(both > F(0.0f), both, F(1.0f));
    by_a = mass_a_ * inverse;
    by_b = mass_b_ * inverse;
  }
  // Lanes in which an impulse moves a, or b.
  LaneMask<W> is_movable_a() const { return mass_a_ > F(0.0f); }
  LaneMask<W> is_movable_b() const { return mass_b_ > F(0.0f); }

  // Marks both bodies as supported. Skips bodies that no impulse moves: several slots may share
  // their state.
  void mark_supported(int i) const {
    for (BodyState* state : {&state_a(i), &state_b(i)}) {
      if (state->velocity[kInverseMass] > 0.0f) state->displacement[kSupported] = 1.0f;
    }
  }

  V v_a, w_a, v_b, w_b, x_a, rotation_a, x_b, rotation_b;
  F falls_a, falls_b;

 private:
  BodyState& state_a(int i) const { return states_[block_.a.lane[at_ + i]]; }
  BodyState& state_b(int i) const { return states_[block_.b.lane[at_ + i]]; }
  template <class ContactSlot>
  void load_inertias(const ContactSlot& slot, FieldSym3& inertia) const {
    F r[8];
    lanes::gather8<W>(slot, r);
    Field* const to[6] = {&inertia.xx, &inertia.yy, &inertia.zz,
                          &inertia.xy, &inertia.yz, &inertia.zx};
    for (int f = 0; f < 6; ++f) put(*to[f], r[f]);
  }
  // Does not write states that no impulse moves: several slots, and workers, may read them. Empty
  // slots refer to kWorldState.
  template <class ContactSlot>
  static void scatter(const ContactSlot& slot, const F* values, const LaneMask<W>& pushed) {
    const unsigned bits = lanes::bits_of(pushed);
    if (bits == lanes::kAllBits<W>) {
      lanes::scatter8<W>(slot, values, [](int) { return true; });
    } else {
      lanes::scatter8<W>(slot, values, [bits](int i) { return (bits >> i & 1u) != 0; });
    }
  }
  static const float* first_line(const BodyState& state) {
    return reinterpret_cast<const float*>(&state);
  }
  static void take_velocity(const F* r, V& v, V& w, F& mass, F& falls) {
    v = {r[0], r[1], r[2]};
    w = {r[3], r[4], r[5]};
    mass = r[kInverseMass];
    falls = r[kFalls];
  }
  static void read_displacement(const F* r, V& x, V& rotation, F& supported,
                                F& fraction_minus_one) {
    x = {r[0], r[1], r[2]};
    rotation = {r[3], r[4], r[5]};
    supported = r[kSupported];
    fraction_minus_one = r[kFractionMinusOne];
  }

  Block& block_;
  int at_;
  BodyState* states_;
  F mass_a_, mass_b_, supported_a_, supported_b_, fraction_minus_one_a_, fraction_minus_one_b_;
};

}  // namespace vp::solve
