// Inverse dynamics: the recursive Newton-Euler algorithm, in the tree's frame.
//
//   base to tip   X, S, V, A with the joint accelerations, each body's F_i (base_to_tip.h)
//   tip to base   F_parent += F_i
//                 tau_i = <S_i, F_i> + armature q''_i + damping q'_i
#pragma once

#include "multibody/base_to_tip.h"
#include "multibody/child_sum.h"

namespace vp::detail {

template <class T>
VP_FLATTEN void inverse_dynamics_kernel(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q,
                                        Span<T> v, Span<T> a, const Vec3T<T>& gravity,
                                        Span<dse3T<T>> external, std::span<T> tau) {
  work.A_world.v = -gravity;
  pass_base_to_tip<T, PassDepth::accelerations>(
      tree, work, q, v, a, BodyInTree<T>(),
      [&](int g, const auto& body, const auto& V, const auto& A) {
        work.group(g).set(kF, body_force(body, V, A));
      });
  subtract_external<T, false>(tree, work, external);
  LightChildSum<ChainSix<T>, PaddedSix<T>> child_sum(work.force_flow);
  const auto& groups = layout_of<T>(tree).groups;
  for (int g = static_cast<int>(groups.size()); g-- > 0;) {
    const int first = g * kSlots<T>, count = groups[static_cast<std::size_t>(g)].count;
    const auto fields = work.group(g);
    dse3T<Wide<T>> F = fields.wrench(kF);
    ChainSix<T> x[kSlots<T>];
    split<T>(F.m, F.f, x);
    for (int k = count; k-- > 0;) {
      const Slot& slot = tree.slots[static_cast<std::size_t>(first + k)];
      x[k] = child_sum.add(slot, x[k]);
      child_sum.give(slot, x[k]);
    }
    join<T>(x, F.m, F.f);
    const Wide<T> forces = fields.twist(kS) * F;
    for (int k = 0; k < count; ++k) {
      const Slot& slot = tree.slots[static_cast<std::size_t>(first + k)];
      const auto n = static_cast<std::size_t>(slot.v);
      const auto constants = constants_of<T>(tree, first + k);
      const T armature = constants.get(kArmature), damping = constants.get(kDamping);
      if (slot.kind == SlotKind::root) {
        const Mat3T<T> R = work.slot(first + k).mat(kX);
        const Six<T> own = [&] {
          alignas(64) T at[8];
          x[k].to(at);
          const dse3T<T> total = wrench_from(at);
          return Six<T>::of(transposed_times(R, total.m), transposed_times(R, total.f));
        }();
        for (std::size_t c = 0; c < 6; ++c) {
          tau[n + c] = own.x[c] + (armature * a[n + c] + damping * v[n + c]);
        }
        continue;
      }
      T force;
      if constexpr (kSlots<T> == 1) {
        force = forces;
      } else {
        force = forces[k];
      }
      tau[n] = force + (armature * a[n] + damping * v[n]);
    }
  }
}

}  // namespace vp::detail
