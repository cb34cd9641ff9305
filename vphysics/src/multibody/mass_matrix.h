// The mass matrix: the composite body algorithm, in the tree's frame.
//
//   outwards  X, S, each body's inertia (outwards.h)
//   inwards   C_i = J_i + sum of the children's C: nine numbers, added; the masses are known
//   F_i = C_i S_i,  M_ij = <S_j, F_i> for j = i and every j between i and the root
#pragma once

#include <algorithm>

#include "multibody/forward_dynamics.h"
#include "multibody/inflow.h"

namespace vp::detail {

// Row and column i of M, n x n: where they cross slots [begin, end) of one group.
template <class T>
void fill_row(const Work<T>& work, int i, int begin, int end, std::size_t n, std::span<T> M) {
  constexpr int kWidth = kSlots<T>;
  const auto wide = work.group(begin / kWidth);
  const auto fields = work.slot(i);
  const Wide<T> m =
      wide.twist(kS) *
      dse3T<Wide<T>>{
          {Wide<T>(fields.get(kF)), Wide<T>(fields.get(kF + 1)), Wide<T>(fields.get(kF + 2))},
          {Wide<T>(fields.get(kF + 3)), Wide<T>(fields.get(kF + 4)), Wide<T>(fields.get(kF + 5))}};
  const auto row = static_cast<std::size_t>(i);
  if constexpr (kWidth == 1) {
    const auto j = static_cast<std::size_t>(begin);
    M[row * n + j] = M[j * n + row] = m;
  } else {
    for (int j = begin; j < end; ++j) {
      const auto column = static_cast<std::size_t>(j);
      M[row * n + column] = M[column * n + row] = m[j % kWidth];
    }
  }
}

template <class T>
VP_FLATTEN void mass_matrix_kernel(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q,
                                   std::span<T> M) {
  outwards<T, Reach::poses>(tree, work, q, {}, {}, [&](int g, const auto& k) {
    set_inertia(work, g, body_in_tree(k, work.group(g).pose(kX)));
  });
  LightInflow<Moments<T>> inflow(work.moment_flow);
  for (int i = tree.velocities; i-- > 0;) {
    const Slot& slot = tree.slots[static_cast<std::size_t>(i)];
    const auto fields = work.slot(i);
    const Moments<T> C = inflow.add(slot, {fields.vec(kH), fields.sym(kI)});
    fields.set(kH, C.h);
    fields.set(kI, C.I);
    inflow.give(slot, C);
  }
  const auto& groups = layout_of<T>(tree).groups;
  for (int g = 0; g < static_cast<int>(groups.size()); ++g) {
    const auto fields = work.group(g);
    const Wide<T> mass = group_constants<T>(tree, g).get(kComposite);
    fields.set(kF, InertiaT<Wide<T>>(mass, fields.vec(kH), fields.sym(kI)) * fields.twist(kS));
  }
  if (!tree.all_related) std::fill(M.begin(), M.end(), T(0));
  const auto n = static_cast<std::size_t>(tree.velocities);
  for (std::size_t i = 0; i < n; ++i) {
    for (int r = tree.first_run[i]; r < tree.first_run[i + 1]; ++r) {
      const SlotRun run = tree.runs[static_cast<std::size_t>(r)];
      for (int j = run.begin; j < run.end;) {
        const int end = std::min(run.end, (j / kSlots<T> + 1) * kSlots<T>);
        fill_row(work, static_cast<int>(i), j, end, n, M);
        j = end;
      }
    }
    M[i * n + i] = M[i * n + i] + constants_of<T>(tree, static_cast<int>(i)).get(kArmature);
  }
}

}  // namespace vp::detail
