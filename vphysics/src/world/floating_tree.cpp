#include "world/floating_tree.h"

#include "multibody/kinematics.h"

namespace vp {

using detail::Node;
using detail::NodeKind;

bool floats(const Model& model, int node) {
  if (node == kWorld) return false;
  const Node<double>& root = model.tree().nodes[static_cast<std::size_t>(node)];
  return root.parent == kWorld && root.kind == NodeKind::free && root.armature == 0.0 &&
         root.damping == 0.0;
}

std::vector<FloatingTree> FloatingTree::of(const Model& model) {
  const auto& nodes = model.tree().nodes;
  std::vector<FloatingTree> found;
  std::vector<int> tree_of(nodes.size(), -1);  // index in found
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node<double>& node = nodes[i];
    if (node.parent != kWorld) {
      tree_of[i] = tree_of[static_cast<std::size_t>(node.parent)];
    } else if (floats(model, static_cast<int>(i))) {
      tree_of[i] = static_cast<int>(found.size());
      found.emplace_back().root_ = static_cast<int>(i);
    }
    if (tree_of[i] >= 0) {
      found[static_cast<std::size_t>(tree_of[i])].nodes_.push_back(static_cast<int>(i));
    }
  }
  return found;
}

CompositeBody FloatingTree::composite(const Data& data, const detail::ImpulseFactor& factor) const {
  const auto sum = factor.momentum_of(nodes_, data);
  return composite(data, sum.inertia, sum.momentum);
}

CompositeBody FloatingTree::composite_of_twists(const Data& data,
                                                const detail::ImpulseFactor& factor) const {
  const auto sum = factor.momentum_of_twists(nodes_, data);
  return composite(data, sum.inertia, sum.momentum);
}

CompositeBody FloatingTree::composite(const Data& data, const Inertia& J, const dse3& P) const {
  const Vec3 c = J.centre_of_mass();
  const Vec3 origin = detail::origin_of(data.work(), root_);
  return {J.mass(), c + origin,          J.central(),
          P.f,      P.m - cross(c, P.f), detail::pose_of(data.work(), root_).position() + origin};
}

void FloatingTree::set_momentum(const Model& model, const Data& data, const CompositeBody& now,
                                const CompositeBody& target, std::span<double> v) const {
  const Vec3 w = inverse(now.central) * (target.angular - now.angular);
  const Vec3 at_centre = (1.0 / now.mass) * (target.linear - now.linear);
  const SE3 T_tree_root = detail::pose_of(data.work(), root_);
  const Vec3 root = T_tree_root.position() + detail::origin_of(data.work(), root_);
  const Vec3 rotation = T_tree_root.unrotate(w);
  const Vec3 slide = T_tree_root.unrotate(at_centre + cross(w, root - now.centre));
  const auto first =
      static_cast<std::size_t>(model.tree().nodes[static_cast<std::size_t>(root_)].v);
  for (int k = 0; k < 3; ++k) {
    v[first + static_cast<std::size_t>(k)] += rotation[k];
    v[first + static_cast<std::size_t>(k) + 3] += slide[k];
  }
}

void FloatingTree::shift(const Model& model, const Vec3& by, std::span<double> q) const {
  const Node<double>& node = model.tree().nodes[static_cast<std::size_t>(root_)];
  const Vec3 moved = node.T_parent.unrotate(by);
  const auto first = static_cast<std::size_t>(node.q);
  for (int k = 0; k < 3; ++k) q[first + static_cast<std::size_t>(k)] += moved[k];
}

}  // namespace vp
