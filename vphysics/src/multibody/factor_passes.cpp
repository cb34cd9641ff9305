// The passes for one instruction set; compiled once for each, with VP_FACTOR_PASSES the table's
// name (CMakeLists.txt).
#include "multibody/factor_passes.h"

#include <cmath>
#include <cstring>

#include "multibody/base_to_tip.h"
#include "multibody/factor_column.h"

namespace vp::detail {
namespace {

using vphysics_factor::kArticulated;
using vphysics_factor::kInertia;
using W = Wide<double>;
using Fours = PackT<double, 4>;

// An Omega below this fraction of its upper bound, largest_omega(), is rounding error, as for a
// joint that rotates about a point mass.
constexpr double kNoInertia = 1e-14;

const Tree<double>& tree_at(const void* tree) {
  return *static_cast<const Tree<double>*>(tree);
}

// The inertia of a slot's body, or the inertias of a group's bodies.
template <class N>
InertiaT<N> inertia_at(const double* at) {
  const Constants<double, N> k(at);
  return {k.get(0), k.vec(1), {k.get(4), k.get(5), k.get(6), k.get(7), k.get(8), k.get(9)}};
}

VP_FLATTEN void inertias(const void* tree, const void* work, const double* bodies, double* out) {
  const std::size_t groups = layout_of<double>(tree_at(tree)).groups.size();
  const auto& data = *static_cast<const Work<double>*>(work);
  constexpr int kSize = kInertia * kSlots<double>;
  for (std::size_t g = 0; g < groups; ++g, bodies += kSize, out += kSize) {
    const InertiaT<W> J = inertia_at<W>(bodies).InvXform(data.group(static_cast<int>(g)).pose(kX));
    const Fields<double, W> to(out);
    to.set(0, J.mass());
    to.set(1, J.first_moment());
    to.set(4, J.rotational());
  }
}

// Like SlotMotion::place_root().
void place_origin(const Tree<double>& tree, const Slot& slot, const double* q, Work<double>& work) {
  const auto& node = tree.nodes[static_cast<std::size_t>(slot.node)];
  const auto root = static_cast<std::size_t>(node.root);
  const double* const x = q + node.q;
  work.origins[root] = tree.roots[root] + node.T_parent.rotation() * Vec3{x[0], x[1], x[2]};
}

VP_FLATTEN void velocities(const void* tree, void* work, const double* q, const double* v) {
  const Tree<double>& model = tree_at(tree);
  const Span<double> coordinates(q, static_cast<std::size_t>(model.coordinates));
  const Span<double> rates(v, static_cast<std::size_t>(model.velocities));
  auto& data = *static_cast<Work<double>*>(work);
  SlotMotion<double> motion(model, data, coordinates, rates, {});
  const auto& groups = motion.layout().groups;
  for (int g = 0; g < static_cast<int>(groups.size()); ++g) {
    const auto& group = groups[static_cast<std::size_t>(g)];
    se3T<W> own = motion.rates(g, group) * motion.fields(g).twist(kS);
    for (int k = 0; !group.simple && k < group.count; ++k) {
      const int i = g * kSlots<double> + k;
      motion.take_root_velocity(i, k, own);
      if (motion.slot(i).kind == SlotKind::root) place_origin(model, motion.slot(i), q, data);
    }
    motion.summed(g, group, own, kV);
  }
}

// A 6-vector: its first four numbers and its last two.
struct SixLanes {
  Fours a;
  PackT<double, 2> b;
};
// The six numbers of a twist or a wrench.
template <class V>
double* numbers(V& x) {
  return reinterpret_cast<double*>(&x);
}
template <class V>
const double* numbers(const V& x) {
  return reinterpret_cast<const double*>(&x);
}
SixLanes six(const double* from) {
  SixLanes x;
  std::memcpy(static_cast<void*>(&x.a), from, sizeof x.a);
  std::memcpy(static_cast<void*>(&x.b), from + 4, sizeof x.b);
  return x;
}
void put(double* to, const SixLanes& x) {
  std::memcpy(to, static_cast<const void*>(&x.a), sizeof x.a);
  std::memcpy(to + 4, static_cast<const void*>(&x.b), sizeof x.b);
}
SixLanes operator+(const SixLanes& x, const SixLanes& y) {
  return {x.a + y.a, x.b + y.b};
}
SixLanes operator-(const SixLanes& x, const SixLanes& y) {
  return {x.a - y.a, x.b - y.b};
}
SixLanes operator*(double s, const SixLanes& x) {
  return {Fours(s) * x.a, PackT<double, 2>(s) * x.b};
}

// Writes AInertia(J) by columns of (angular 3, linear 3, unused 2).
void write_columns(const double* inertia, double* J) {
  const Inertia own = inertia_at<double>(inertia);
  const double m = own.mass();
  const Sym3& I = own.rotational();
  const Mat3 H = skew(own.first_moment());
  const double columns[kArticulated] = {I.xx,   I.xy,   I.zx,   H.cx.x, H.cy.x, H.cz.x, 0, 0,  //
                                        I.xy,   I.yy,   I.yz,   H.cx.y, H.cy.y, H.cz.y, 0, 0,  //
                                        I.zx,   I.yz,   I.zz,   H.cx.z, H.cy.z, H.cz.z, 0, 0,  //
                                        H.cx.x, H.cx.y, H.cx.z, m,      0,      0,      0, 0,  //
                                        H.cy.x, H.cy.y, H.cy.z, 0,      m,      0,      0, 0,  //
                                        H.cz.x, H.cz.y, H.cz.z, 0,      0,      m,      0, 0};
  std::memcpy(J, columns, sizeof columns);
}

double largest_omega(const double* J, const se3& S) {
  return (J[0] + J[9] + J[18]) * dot(S.w, S.w) + (J[27] + J[36] + J[45]) * dot(S.v, S.v);
}

// J S, like AInertia.
SixLanes times(const double* J, const double* S) {
  return ((S[0] * six(J) + S[1] * six(J + 8)) + S[2] * six(J + 16)) +
         ((S[3] * six(J + 24) + S[4] * six(J + 32)) + S[5] * six(J + 40));
}

VP_FLATTEN bool factor(const void* of_tree, const void* of_work, double damping_time,
                       const double* gains, const double* inertias, void* of_columns, double* all) {
  const Tree<double>& tree = tree_at(of_tree);
  const auto& work = *static_cast<const Work<double>*>(of_work);
  auto* const columns = static_cast<FactorColumn*>(of_columns);
  const std::size_t nodes = tree.nodes.size();
  constexpr std::size_t kGroup = kSlots<double>;
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto slot = static_cast<std::size_t>(work.body_slot[i]);
    write_columns(inertias + slot / kGroup * kGroup * kInertia + slot % kGroup,
                  all + i * kArticulated);
  }
  bool fine = true;
  for (std::size_t i = nodes; i-- > 0;) {
    const auto& node = tree.nodes[i];
    double* const J = all + i * kArticulated;
    const double added = node.armature + damping_time * node.damping;
    for (int k = 0; k < node.dofs; ++k) {
      FactorColumn& c = columns[static_cast<std::size_t>(node.v + k)];
      c.S = column_of(tree, work, static_cast<int>(i), k);
      const SixLanes U = times(J, numbers(c.S));
      dse3 wrench{};
      put(numbers(wrench), U);
      const double gain = gains ? gains[node.v + k] : 0.0;
      const double omega = c.S * wrench + (added + gain);
      fine = fine && omega > kNoInertia * largest_omega(J, c.S);
      c.g = 1.0 / std::sqrt(omega);
      put(numbers(c.s), c.g * six(numbers(c.S)));
      const SixLanes G = c.g * U;
      put(numbers(c.G), G);
      const double* const own = numbers(c.G);
      for (int n = 0; n < 6; ++n) put(J + 8 * n, six(J + 8 * n) - own[n] * G);
    }
    if (node.parent == kWorld) continue;
    double* const parent = all + static_cast<std::size_t>(node.parent) * kArticulated;
    for (int n = 0; n < kArticulated; n += 8) put(parent + n, six(parent + n) + six(J + n));
  }
  return fine;
}

// A 6-vector for each slot of a group, in memory.
struct GroupSix {
  alignas(64) double x[6 * kSlots<double>]{};

  Fields<double, double> slot(std::size_t k) { return Fields<double, double>(x + k); }
  Fields<double, W> all() { return Fields<double, W>(x); }
};

VP_FLATTEN void body_forces(const vphysics_factor::Bodies& b, const double* gravity) {
  const auto* const V = static_cast<const se3*>(b.V);
  auto* const A = static_cast<se3*>(b.A);
  auto* const F = static_cast<dse3*>(b.F);
  constexpr std::size_t kSize = kInertia * kSlots<double>;
  const se3 at_rest{{}, {-gravity[0], -gravity[1], -gravity[2]}};
  for (std::size_t begin = 0, end = 0; begin < b.nodes; begin = end) {
    const std::size_t group = b.inertia_at[begin] / kSize;
    GroupSix own, parent, rate, force;
    for (; end < b.nodes && b.inertia_at[end] / kSize == group; ++end) {
      const std::size_t k = b.inertia_at[end] % kSize;
      own.slot(k).set(0, V[b.body[end]]);
      if (b.parent[end] != vphysics_factor::kNone) parent.slot(k).set(0, V[b.parent[end]]);
    }
    const se3T<W> twist = own.all().twist(0);
    rate.all().set(0, ad(parent.all().twist(0), twist));
    for (std::size_t i = begin; i < end; ++i) {
      const auto slot = rate.slot(b.inertia_at[i] % kSize);
      const bool root = b.parent[i] == vphysics_factor::kNone;
      const se3 a = root ? at_rest : A[b.parent[i]] + slot.twist(0);
      A[b.body[i]] = a;
      slot.set(0, a);
    }
    const InertiaT<W> J = inertia_at<W>(b.inertias + group * kSize);
    force.all().set(0, J * rate.all().twist(0) - dad(twist, J * twist));
    for (std::size_t i = begin; i < end; ++i) {
      F[b.body[i]] = force.slot(b.inertia_at[i] % kSize).wrench(0);
    }
  }
}

VP_FLATTEN void twists(const void* of_columns, const std::uint32_t* tip_to_base,
                       const std::uint32_t* next, std::size_t dofs, const double* v, void* of_all) {
  const auto* const columns = static_cast<const FactorColumn*>(of_columns);
  auto* const V = static_cast<se3*>(of_all);
  for (std::size_t i = dofs; i-- > 0;) {
    const std::uint32_t d = tip_to_base[i];
    const SixLanes own = v[d] * six(numbers(columns[d].S));
    const bool root = next[d] == vphysics_factor::kNone;
    put(numbers(V[d]), root ? own : six(numbers(V[next[d]])) + own);
  }
}

VP_FLATTEN void momenta(const vphysics_factor::Bodies& b, const int* nodes, std::size_t count,
                        const void* work, void* inertia, void* momentum) {
  const auto* const V = static_cast<const se3*>(b.V);
  Inertia sum = *static_cast<const Inertia*>(inertia);
  dse3 P = *static_cast<const dse3*>(momentum);
  constexpr std::size_t kSize = kInertia * kSlots<double>;
  for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
    const auto at = [&](std::size_t i) { return b.inertia_at[static_cast<std::size_t>(nodes[i])]; };
    const std::size_t group = at(begin) / kSize;
    GroupSix twist, of_body;
    for (; end < count && at(end) / kSize == group; ++end) {
      if (!V) continue;
      const auto node = static_cast<std::size_t>(nodes[end]);
      twist.slot(at(end) % kSize).set(0, V[b.body[node]]);
    }
    const se3T<W> all =
        V ? twist.all().twist(0)
          : static_cast<const Work<double>*>(work)->group(static_cast<int>(group)).twist(kV);
    of_body.all().set(0, inertia_at<W>(b.inertias + group * kSize) * all);
    for (std::size_t i = begin; i < end; ++i) {
      sum = sum + inertia_at<double>(b.inertias + at(i));
      P = P + of_body.slot(at(i) % kSize).wrench(0);
    }
  }
  *static_cast<Inertia*>(inertia) = sum;
  *static_cast<dse3*>(momentum) = P;
}

VP_FLATTEN void rows(const void* of_columns, const std::uint32_t* next, std::uint32_t dof,
                     const void* wrenches, std::size_t depth, double* y) {
  const auto* const columns = static_cast<const FactorColumn*>(of_columns);
  const auto* const of = static_cast<const dse3*>(wrenches);
  const auto of_all = [&](const auto& number) {
    const typename Fours::Lanes lanes = {number(of[0]), number(of[1]), number(of[2]), 0.0};
    return Fours(lanes);
  };
  Fours mx = of_all([](const dse3& F) { return F.m.x; });
  Fours my = of_all([](const dse3& F) { return F.m.y; });
  Fours mz = of_all([](const dse3& F) { return F.m.z; });
  Fours fx = of_all([](const dse3& F) { return F.f.x; });
  Fours fy = of_all([](const dse3& F) { return F.f.y; });
  Fours fz = of_all([](const dse3& F) { return F.f.z; });
  std::uint32_t d = dof;
  for (std::size_t k = 0; k < depth; ++k, d = next[d]) {
    const FactorColumn& c = columns[d];
    const Fours x = ((Fours(c.s.w.x) * mx + Fours(c.s.w.y) * my) + Fours(c.s.w.z) * mz) +
                    ((Fours(c.s.v.x) * fx + Fours(c.s.v.y) * fy) + Fours(c.s.v.z) * fz);
    mx -= x * Fours(c.G.m.x);
    my -= x * Fours(c.G.m.y);
    mz -= x * Fours(c.G.m.z);
    fx -= x * Fours(c.G.f.x);
    fy -= x * Fours(c.G.f.y);
    fz -= x * Fours(c.G.f.z);
    y[k] = x[0];
    y[k + depth] = x[1];
    y[k + 2 * depth] = x[2];
  }
}

}  // namespace
}  // namespace vp::detail

const vphysics_factor::Passes vphysics_factor::VP_FACTOR_PASSES = {
    vp::detail::inertias,    vp::detail::velocities, vp::detail::factor, vp::detail::rows,
    vp::detail::body_forces, vp::detail::twists,     vp::detail::momenta};
