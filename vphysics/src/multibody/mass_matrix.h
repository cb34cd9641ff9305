// The mass matrix: the composite rigid body algorithm, in the tree's frame.
//
//   base to tip   X, S, each body's inertia (base_to_tip.h)
//   tip to base   C_i = J_i + sum of the children's C: nine numbers; the masses are constants
//   F_i = C_i S_i,  M_ij = <S_j, F_i> for j = i and every j between i and the root
#pragma once

#include <algorithm>

#include "multibody/child_sum.h"
#include "multibody/forward_dynamics.h"

namespace vp::detail {

// Fills row and column v of M, n x n, for the columns S of slots [begin, end) of one group. F is
// the composite inertia times slot i's column.
template <class T>
void fill_row(const Tree<base_t<T>>& tree, const Work<T>& work, const dse3T<Wide<T>>& F,
              std::size_t row, int begin, int end, std::size_t n, std::span<T> M) {
  const Wide<T> m = work.group(begin / kSlots<T>).twist(kS) * F;
  const auto column = static_cast<std::size_t>(tree.slots[static_cast<std::size_t>(begin)].v);
  for (int j = begin; j < end; ++j) {
    const std::size_t c = column + static_cast<std::size_t>(j - begin);
    T x;
    if constexpr (kSlots<T> == 1) {
      x = m;
    } else {
      x = m[j % kSlots<T>];
    }
    M[row * n + c] = M[c * n + row] = x;
  }
}

// The products of a free root's columns with a force, in the root's own axes.
template <class T>
void fill_root(const Mat3T<T>& R, const dse3T<T>& F, std::size_t row, std::size_t first,
               std::size_t n, std::span<T> M) {
  const Six<T> m = Six<T>::of(transposed_times(R, F.m), transposed_times(R, F.f));
  for (std::size_t k = 0; k < 6; ++k) {
    M[row * n + first + k] = M[(first + k) * n + row] = m.x[k];
  }
}

template <class T>
VP_FLATTEN void mass_matrix_kernel(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q,
                                   std::span<T> M) {
  pass_base_to_tip<T, PassDepth::poses>(
      tree, work, q, {}, {}, BodyInTree<T>(),
      [&](int g, const auto& body, const auto&, const auto&) { set_inertia(work, g, body); });
  LightChildSum<Moments<T>, MomentsRow<T>> child_sum(work.moment_flow);
  for (int i = static_cast<int>(tree.slots.size()); i-- > 0;) {
    const Slot& slot = tree.slots[static_cast<std::size_t>(i)];
    const auto fields = work.slot(i);
    const Moments<T> C = child_sum.add(slot, {fields.vec(kH), fields.sym(kI)});
    fields.set(kH, C.h);
    fields.set(kI, C.I);
    child_sum.give(slot, C);
  }
  const auto& groups = layout_of<T>(tree).groups;
  for (int g = 0; g < static_cast<int>(groups.size()); ++g) {
    const auto fields = work.group(g);
    const Wide<T> mass = group_constants<T>(tree, g).get(kSubtreeMass);
    fields.set(kF, InertiaT<Wide<T>>(mass, fields.vec(kH), fields.sym(kI)) * fields.twist(kS));
  }
  if (!tree.all_related) std::fill(M.begin(), M.end(), T(0));
  const auto n = static_cast<std::size_t>(tree.velocities);
  for (std::size_t i = 0; i < tree.slots.size(); ++i) {
    const Slot& slot = tree.slots[i];
    const auto row = static_cast<std::size_t>(slot.v);
    const auto k = constants_of<T>(tree, static_cast<int>(i));
    const auto fields = work.slot(static_cast<int>(i));
    if (slot.kind == SlotKind::root) {
      const Mat3T<T> R = fields.mat(kX);
      const InertiaT<T> C(k.get(kSubtreeMass), fields.vec(kH), fields.sym(kI));
      for (std::size_t c = 0; c < 6; ++c) {
        fill_root(R, C * column_of<T>(tree, work, slot.node, static_cast<int>(c)), row + c, row, n,
                  M);
        M[(row + c) * n + row + c] = M[(row + c) * n + row + c] + k.get(kArmature);
      }
      continue;
    }
    const dse3T<T> F = fields.wrench(kF);
    const dse3T<Wide<T>> wide{{Wide<T>(F.m.x), Wide<T>(F.m.y), Wide<T>(F.m.z)},
                              {Wide<T>(F.f.x), Wide<T>(F.f.y), Wide<T>(F.f.z)}};
    for (int r = tree.first_run[i]; r < tree.first_run[i + 1]; ++r) {
      const SlotRun run = tree.runs[static_cast<std::size_t>(r)];
      for (int j = run.begin; j < run.end;) {
        const int end = std::min(run.end, (j / kSlots<T> + 1) * kSlots<T>);
        fill_row<T>(tree, work, wide, row, j, end, n, M);
        j = end;
      }
    }
    if (slot.root != kWorld) {
      const auto first = tree.slots[static_cast<std::size_t>(slot.root)].v;
      fill_root(work.slot(slot.root).mat(kX), F, row, static_cast<std::size_t>(first), n, M);
    }
    M[row * n + row] = M[row * n + row] + k.get(kArmature);
  }
}

}  // namespace vp::detail
