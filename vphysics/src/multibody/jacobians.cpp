// Jacobians in the tree's frame (work.h), whose origin is the point at rest where the root is now.
//
//   J_k  = S_k for the joints on the path from the root to the link, else 0
//   S'_k = ad_(V_k) S_k + Ad_X of the derivative of the joint's own subspace, which is zero except
//          for user joints: other subspaces are fixed in their link
//   A    = sum over the path of ad_(V_parent) (V - V_parent) + Ad_X (dS/dt) v = J' v
//
// They are then transformed to the requested frame, which moves with the link or is at rest.
#include "vphysics/multibody/jacobians.h"

#include <algorithm>
#include <string>

#include "multibody/instantiate.h"
#include "multibody/kinematics.h"
#include "multibody/user_derivatives.h"
#include "vphysics/assert.h"

namespace vp {
namespace detail {
namespace {

// A link's node and pose, in the tree's frame.
template <class T>
struct LinkPose {
  int node;
  SE3T<T> X;
  Vec3T<T> origin;  // of the tree's frame in the world
};
template <class T>
LinkPose<T> link_pose(const Tree<base_t<T>>& tree, const Work<T>& work, int link) {
  const auto& frame = tree.frames[static_cast<std::size_t>(link)];
  return {frame.node, pose_of(work, frame.node) * wide<T>(frame.T_node_link),
          origin_of(work, frame.node)};
}

// Transforms a twist in the tree's frame to the link's velocity in the requested frame; V is the
// link's twist.
template <class T>
struct LinkView {
  using Column = se3T<T>;
  LinkPose<T> at;
  Frame frame;

  Column operator()(const se3T<T>& S) const {
    if (frame == Frame::link) return InvAd(at.X, S);
    if (frame == Frame::world) return {S.w, S.v + cross(at.origin, S.w)};
    return {S.w, S.v + cross(S.w, at.X.position())};
  }
  Column rate(const se3T<T>& S, const se3T<T>& S_rate, const se3T<T>& V) const {
    if (frame == Frame::link) return (*this)(S_rate - ad(V, S));
    Column out = (*this)(S_rate);
    if (frame == Frame::world_at_link) out.v += cross(S.w, V.v + cross(V.w, at.X.position()));
    return out;
  }
};

// The same for the velocity of a point x on the link.
template <class T>
struct PointView {
  using Column = Vec3T<T>;
  LinkPose<T> at;
  Frame frame;
  Vec3T<T> x;

  Column rotated_back(const Vec3T<T>& u) const {
    return frame == Frame::link ? at.X.unrotate(u) : u;
  }
  Column operator()(const se3T<T>& S) const { return rotated_back(S.v + cross(S.w, x)); }
  Column rate(const se3T<T>& S, const se3T<T>& S_rate, const se3T<T>& V) const {
    const Vec3T<T> x_rate = V.v + cross(V.w, x);
    const Vec3T<T> u_rate = S_rate.v + cross(S_rate.w, x) + cross(S.w, x_rate);
    if (frame != Frame::link) return u_rate;
    return rotated_back(u_rate - cross(V.w, S.v + cross(S.w, x)));
  }
};

template <class T>
LinkView<T> view_of(const Tree<base_t<T>>& tree, const Work<T>& work, int link, Frame frame) {
  return {link_pose(tree, work, link), frame};
}
template <class T>
PointView<T> view_of(const Tree<base_t<T>>& tree, const Work<T>& work, int link, Frame frame,
                     const Vec3T<T>& point) {
  const LinkPose<T> at = link_pose(tree, work, link);
  return {at, frame, at.X * point};
}

template <class B>
bool moves(const Tree<B>& tree, int link) {
  return tree.frames[static_cast<std::size_t>(link)].node != kWorld;
}

template <class T, class View>
void fill_jacobian(const Tree<base_t<T>>& tree, const Work<T>& work, const View& view,
                   std::span<typename View::Column> J) {
  for (int i = view.at.node; i != kWorld; i = tree.nodes[static_cast<std::size_t>(i)].parent) {
    const auto& node = tree.nodes[static_cast<std::size_t>(i)];
    for (int k = 0; k < node.dofs; ++k) {
      J[static_cast<std::size_t>(node.v + k)] = view(column_of(tree, work, i, k));
    }
  }
}

[[maybe_unused]] Expected<void> no_derivatives(const char* call) {  // not of packs
  return tl::make_unexpected(
      Error{Errc::unsupported,
            std::string(call) +
                ": a user-defined joint of several degrees has no derivatives of its subspace; "
                "override UserJoint::subspace_derivatives in it"});
}

template <class T, class View>
Expected<void> fill_rate(const char* call, const Tree<base_t<T>>& tree, const Work<T>& work,
                         Span<T> q, Span<T> v, const View& view,
                         std::span<typename View::Column> J_rate) {
  const se3T<T> V = velocity_of(work, view.at.node);
  for (int i = view.at.node; i != kWorld; i = tree.nodes[static_cast<std::size_t>(i)].parent) {
    const auto& node = tree.nodes[static_cast<std::size_t>(i)];
    std::array<se3T<T>, 6> own{};
    if (node.kind == NodeKind::user) {
      if (!user_column_rates<T>(node, UserState(node, q, v), own)) return no_derivatives(call);
      for (auto& S_rate : own) S_rate = Ad(pose_of(work, i), S_rate);
    }
    const se3T<T> V_node = velocity_of(work, i);
    for (int k = 0; k < node.dofs; ++k) {
      const se3T<T> S = column_of(tree, work, i, k);
      J_rate[static_cast<std::size_t>(node.v + k)] =
          view.rate(S, ad(V_node, S) + own[static_cast<std::size_t>(k)], V);
    }
  }
  return {};
}

template <class T, class View>
typename View::Column drift(const Tree<base_t<T>>& tree, const Work<T>& work, Span<T> q, Span<T> v,
                            const View& view) {
  se3T<T> A{};
  for (int i = view.at.node; i != kWorld; i = tree.nodes[static_cast<std::size_t>(i)].parent) {
    const auto& node = tree.nodes[static_cast<std::size_t>(i)];
    if (node.parent != kWorld) A = A + ad(velocity_of(work, node.parent), velocity_of(work, i));
    if (node.kind == NodeKind::user) {
      A = A + Ad(pose_of(work, i), user_rate<T>(node, UserState(node, q, v)));
    }
  }
  const se3T<T> V = velocity_of(work, view.at.node);
  return view.rate(V, A, V);
}

template <class B, class Column>
bool fits(const Tree<B>& tree, int link, std::span<Column> J) {
  return link >= 0 && static_cast<std::size_t>(link) < tree.frames.size() &&
         J.size() == static_cast<std::size_t>(tree.velocities);
}
template <class B, class T>
bool fits(const Tree<B>& tree, Span<T> q, Span<T> v) {
  return q.size() == static_cast<std::size_t>(tree.coordinates) &&
         v.size() == static_cast<std::size_t>(tree.velocities);
}

template <class T, class Column, class... Point>
void jacobian(const ModelT<base_t<T>>& model, const DataT<T>& data, int link, Frame frame,
              std::span<Column> J, const Point&... point) {
  const auto& tree = model.tree();
  VP_ASSERT(fits(tree, link, J));
  std::fill(J.begin(), J.end(), Column{});
  if (!moves(tree, link)) return;
  fill_jacobian<T>(tree, data.work(), view_of<T>(tree, data.work(), link, frame, point...), J);
}
template <class T, class Column, class... Point>
Expected<void> jacobian_rate(const char* call, const ModelT<base_t<T>>& model, const DataT<T>& data,
                             Span<T> q, Span<T> v, int link, Frame frame, std::span<Column> J_rate,
                             const Point&... point) {
  const auto& tree = model.tree();
  VP_ASSERT(fits(tree, link, J_rate) && fits(tree, q, v));
  std::fill(J_rate.begin(), J_rate.end(), Column{});
  if (!moves(tree, link)) return {};
  return fill_rate<T>(call, tree, data.work(), q, v,
                      view_of<T>(tree, data.work(), link, frame, point...), J_rate);
}

}  // namespace
}  // namespace detail

template <class T>
void link_jacobian(const ModelT<base_t<T>>& model, const DataT<T>& data, int link, Frame frame,
                   std::span<se3T<T>> J) {
  detail::jacobian<T>(model, data, link, frame, J);
}
template <class T>
void point_jacobian(const ModelT<base_t<T>>& model, const DataT<T>& data, int link,
                    const Vec3T<T>& point, Frame frame, std::span<Vec3T<T>> J) {
  detail::jacobian<T>(model, data, link, frame, J, point);
}
template <class T>
Expected<void> link_jacobian_rate(const ModelT<base_t<T>>& model, const DataT<T>& data,
                                  std::span<const T> q, std::span<const T> v, int link, Frame frame,
                                  std::span<se3T<T>> J_rate) {
  return detail::jacobian_rate<T>("link_jacobian_rate", model, data, q, v, link, frame, J_rate);
}
template <class T>
Expected<void> point_jacobian_rate(const ModelT<base_t<T>>& model, const DataT<T>& data,
                                   std::span<const T> q, std::span<const T> v, int link,
                                   const Vec3T<T>& point, Frame frame, std::span<Vec3T<T>> J_rate) {
  return detail::jacobian_rate<T>("point_jacobian_rate", model, data, q, v, link, frame, J_rate,
                                  point);
}
template <class T>
se3T<T> link_drift(const ModelT<base_t<T>>& model, const DataT<T>& data, std::span<const T> q,
                   std::span<const T> v, int link, Frame frame) {
  const auto& tree = model.tree();
  VP_ASSERT(detail::fits(tree, q, v) && link >= 0 && link < model.links());
  if (!detail::moves(tree, link)) return {};
  return detail::drift<T>(tree, data.work(), q, v,
                          detail::view_of<T>(tree, data.work(), link, frame));
}
template <class T>
Vec3T<T> point_drift(const ModelT<base_t<T>>& model, const DataT<T>& data, std::span<const T> q,
                     std::span<const T> v, int link, const Vec3T<T>& point, Frame frame) {
  const auto& tree = model.tree();
  VP_ASSERT(detail::fits(tree, q, v) && link >= 0 && link < model.links());
  if (!detail::moves(tree, link)) return {};
  return detail::drift<T>(tree, data.work(), q, v,
                          detail::view_of<T>(tree, data.work(), link, frame, point));
}

#define VP_JACOBIANS(T)                                                                         \
  template void link_jacobian(const ModelT<base_t<T>>&, const DataT<T>&, int, Frame,            \
                              std::span<se3T<T>>);                                              \
  template void point_jacobian(const ModelT<base_t<T>>&, const DataT<T>&, int, const Vec3T<T>&, \
                               Frame, std::span<Vec3T<T>>);
VP_FOR_EACH_SCALAR(VP_JACOBIANS)

#define VP_JACOBIAN_RATES(T)                                                                     \
  template Expected<void> link_jacobian_rate(const ModelT<T>&, const DataT<T>&,                  \
                                             std::span<const T>, std::span<const T>, int, Frame, \
                                             std::span<se3T<T>>);                                \
  template Expected<void> point_jacobian_rate(const ModelT<T>&, const DataT<T>&,                 \
                                              std::span<const T>, std::span<const T>, int,       \
                                              const Vec3T<T>&, Frame, std::span<Vec3T<T>>);      \
  template se3T<T> link_drift(const ModelT<T>&, const DataT<T>&, std::span<const T>,             \
                              std::span<const T>, int, Frame);                                   \
  template Vec3T<T> point_drift(const ModelT<T>&, const DataT<T>&, std::span<const T>,           \
                                std::span<const T>, int, const Vec3T<T>&, Frame);
#ifndef VP_PACKS
VP_JACOBIAN_RATES(double)
VP_JACOBIAN_RATES(float)
#endif

}  // namespace vp
