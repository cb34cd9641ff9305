// The mass matrix: the composite body algorithm, in the tree's frame.
//
//   inwards   C_i = J_i + sum of the children's C: ten numbers, added
//             M_ij = <S_j, C_i S_i> for j = i and every j on the way from i to the root
#include <algorithm>

#include "multibody/instantiate.h"
#include "multibody/kinematics.h"
#include "vphysics/multibody/dynamics.h"

namespace vp {
namespace detail {
namespace {

template <class T>
const se3T<T>& column(const Tree<base_t<T>>& tree, const Work<T>& work, std::size_t i,
                      std::size_t k) {
  const int block = tree.nodes[i].block;
  return block < 0 ? work.nodes[i].S : work.blocks[static_cast<std::size_t>(block)].S[k];
}

template <class T>
void fill_row(const Tree<base_t<T>>& tree, const Work<T>& work, std::size_t i, std::span<T> M) {
  const auto n = static_cast<std::size_t>(tree.velocities);
  for (std::size_t k = 0; k < static_cast<std::size_t>(tree.nodes[i].dofs); ++k) {
    const std::size_t row = static_cast<std::size_t>(tree.nodes[i].v) + k;
    const dse3T<T> F = work.composites[i] * column(tree, work, i, k);
    for (int j = static_cast<int>(i); j != kWorld;
         j = tree.nodes[static_cast<std::size_t>(j)].parent) {
      const auto& other = tree.nodes[static_cast<std::size_t>(j)];
      for (std::size_t c = 0; c < static_cast<std::size_t>(other.dofs); ++c) {
        const std::size_t col = static_cast<std::size_t>(other.v) + c;
        const T m = column(tree, work, static_cast<std::size_t>(j), c) * F;
        M[row * n + col] = M[col * n + row] = m;
      }
    }
    M[row * n + row] = M[row * n + row] + T(tree.nodes[i].armature);
  }
}

}  // namespace
}  // namespace detail

template <class T>
void mass_matrix(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                 std::span<T> M) {
  const auto& tree = model.tree();
  detail::Work<T>& work = data.work();
  detail::kinematics<T>(tree, work, q, {}, {});
  std::fill(M.begin(), M.end(), T(0));
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    work.composites[i] = detail::inertia_in_tree<T>(tree.nodes[i], work.nodes[i]);
  }
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    detail::fill_row<T>(tree, work, i, M);
    const int parent = tree.nodes[i].parent;
    if (parent == kWorld) continue;
    InertiaT<T>& C = work.composites[static_cast<std::size_t>(parent)];
    C = C + work.composites[i];
  }
}

#define VP_MASS_MATRIX(T) \
  template void mass_matrix(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>, std::span<T>);
VP_FOR_EACH_SCALAR(VP_MASS_MATRIX)

}  // namespace vp
