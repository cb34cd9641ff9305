// Inverse dynamics: the recursive Newton-Euler algorithm, in the tree's frame.
//
//   outwards   X, S, V, A with the joints' accelerations, each body's F_i (outwards.h)
//   inwards    F_parent += F_i
//              tau_i = <S_i, F_i> + armature q''_i + damping q'_i
#pragma once

#include "multibody/inflow.h"
#include "multibody/outwards.h"

namespace vp::detail {

template <class T>
VP_FLATTEN void inverse_dynamics_kernel(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q,
                                        Span<T> v, Span<T> a, const Vec3T<T>& gravity,
                                        Span<dse3T<T>> external, std::span<T> tau) {
  work.set_world(-gravity);
  outwards<T, Reach::accelerations>(tree, work, q, v, a, [&](int g, const auto& k) {
    const auto fields = work.group(g);
    const auto body = body_in_tree(k, fields.pose(kX));
    fields.set(kF, body_force(body, fields.twist(kV), fields.twist(kA)));
  });
  subtract_external<T, false>(tree, work, external);
  LightInflow<dse3T<T>> inflow(work.force_flow);
  for (int i = tree.velocities; i-- > 0;) {
    const auto n = static_cast<std::size_t>(i);
    const Slot& slot = tree.slots[n];
    const auto fields = work.slot(i);
    const auto k = constants_of<T>(tree, i);
    const dse3T<T> F = inflow.add(slot, fields.wrench(kF));
    tau[n] = fields.twist(kS) * F + (k.get(kArmature) * a[n] + k.get(kDamping) * v[n]);
    inflow.give(slot, F);
  }
}

}  // namespace vp::detail
