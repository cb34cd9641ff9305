#include "multibody/impulse_factor.h"

#include <algorithm>
#include <cmath>

#include "multibody/kinematics.h"

namespace vp::detail {
namespace {

// An Omega below this fraction of the upper bound of its terms is rounding: a joint about a point
// mass.
constexpr double kNoInertia = 1e-14;

double largest_omega(const AInertia& J, const se3& S) {
  const Sym3 &I = J.angular(), &M = J.linear();
  return (I.xx + I.yy + I.zz) * dot(S.w, S.w) + (M.xx + M.yy + M.zz) * dot(S.v, S.v);
}

}  // namespace

ImpulseFactor::ImpulseFactor(const Model& model) {
  const Tree<double>& tree = model.tree();
  const auto n = static_cast<std::size_t>(model.velocities());
  columns_.resize(n);
  next_.resize(n, kEnd);
  depth_.resize(n);
  a_.resize(n);
  A_.resize(n);
  r_.resize(n);
  J_.resize(tree.nodes.size());
  own_.resize(tree.nodes.size());
  for (const auto& node : tree.nodes) {
    body_dof_.push_back(static_cast<std::uint32_t>(node.v));
    const bool root = node.parent == kWorld;
    std::uint32_t next =
        root ? kEnd
             : static_cast<std::uint32_t>(tree.nodes[static_cast<std::size_t>(node.parent)].v);
    parent_dof_.push_back(next);
    // Within a node, the last degree of freedom is nearest to the root.
    for (int k = node.dofs; k-- > 0;) {
      const auto dof = static_cast<std::uint32_t>(node.v + k);
      next_[dof] = next;
      depth_[dof] = next == kEnd ? 1 : depth_[next] + 1;
      deepest_ = std::max(deepest_, depth_[dof]);
      next = dof;
      inwards_.push_back(dof);
    }
  }
  std::reverse(inwards_.begin(), inwards_.end());
  joint_rows_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    joint_rows_[i].begin = static_cast<std::uint32_t>(cached_.size());
    cached_.resize(cached_.size() + depth_[i]);
  }
  for (const auto& frame : tree.frames) {
    if (frame.node == kWorld) {
      links_.push_back({kEnd, 0, {}});
    } else {
      const auto dof =
          static_cast<std::uint32_t>(tree.nodes[static_cast<std::size_t>(frame.node)].v);
      links_.push_back({dof, depth_[dof], {}});
    }
  }
}

bool ImpulseFactor::factor(const Model& model, const Data& data, double damping_time) {
  const Tree<double>& tree = model.tree();
  const Work<double>& work = data.work();
  const auto nodes = static_cast<int>(tree.nodes.size());
  for (int i = 0; i < nodes; ++i) {
    const auto n = static_cast<std::size_t>(i);
    own_[n] = detail::inertia_of(tree, work, i);
    J_[n] = AInertia(own_[n]);
  }
  for (CachedRow& cached : joint_rows_) cached.valid = false;
  bool fine = true;
  for (int i = nodes; i-- > 0;) {
    const auto& node = tree.nodes[static_cast<std::size_t>(i)];
    AInertia& J = J_[static_cast<std::size_t>(i)];
    const double added = node.armature + damping_time * node.damping;
    for (int k = 0; k < node.dofs; ++k) {
      Column& c = columns_[static_cast<std::size_t>(node.v + k)];
      c.S = column_of(tree, work, i, k);
      const dse3 U = J * c.S;
      const double omega = c.S * U + added;
      fine = fine && omega > kNoInertia * largest_omega(J, c.S);
      c.g = 1.0 / std::sqrt(omega);
      c.s = c.g * c.S;
      c.G = c.g * U;
      J = J - outer(1.0, c.G);
    }
    if (node.parent != kWorld) {
      AInertia& parent = J_[static_cast<std::size_t>(node.parent)];
      parent = parent + J;
    }
  }
  for (std::size_t l = 0; l < links_.size(); ++l) {
    const int node = tree.frames[l].node;
    if (node != kWorld) links_[l].origin = origin_of(work, node);
  }
  return fine;
}

void ImpulseFactor::row(std::uint32_t dof, dse3 r, double* y) const {
  for (std::uint32_t d = dof; d != kEnd; d = next_[d], ++y) {
    const Column& c = columns_[d];
    *y = c.s * r;
    r = r - *y * c.G;
  }
}

void ImpulseFactor::force_row(int link, const Vec3& point, const Vec3& direction, double* y) const {
  const LinkPath& path = links_[static_cast<std::size_t>(link)];
  row(path.first, {cross(point - path.origin, direction), direction}, y);
}
void ImpulseFactor::moment_row(int link, const Vec3& direction, double* y) const {
  row(links_[static_cast<std::size_t>(link)].first, {direction, {}}, y);
}
ImpulseFactor::JointRow ImpulseFactor::joint_row(std::uint32_t dof) {
  CachedRow& cached = joint_rows_[dof];
  double* const y = cached_.data() + cached.begin;
  if (!cached.valid) {
    const Column& c = columns_[dof];
    y[0] = c.g;
    row(next_[dof], -c.g * c.G, y + 1);
    cached.response = 0.0;
    for (std::uint32_t k = 0; k < depth_[dof]; ++k) cached.response += y[k] * y[k];
    cached.valid = true;
  }
  return {y, cached.response};
}

void ImpulseFactor::to_velocities(std::span<double> x) {
  for (std::size_t i = inwards_.size(); i-- > 0;) {
    const std::uint32_t d = inwards_[i], next = next_[d];
    const Column& c = columns_[d];
    const se3 a = next == kEnd ? se3{} : a_[next];
    const double t = x[d] - c.G * a;
    x[d] = c.g * t;
    a_[d] = a + t * c.s;
  }
}

void ImpulseFactor::solve(std::span<double> x) {
  for (dse3& r : r_) r = {};
  for (const std::uint32_t d : inwards_) {
    const Column& c = columns_[d];
    x[d] = c.g * x[d] + c.s * r_[d];
    if (next_[d] != kEnd) r_[next_[d]] = r_[next_[d]] + (r_[d] - x[d] * c.G);
  }
  to_velocities(x);
}

void ImpulseFactor::twists(std::span<const double> v) {
  for (std::size_t i = inwards_.size(); i-- > 0;) {
    const std::uint32_t d = inwards_[i], next = next_[d];
    const se3 own = v[d] * columns_[d].S;
    a_[d] = next == kEnd ? own : a_[next] + own;
  }
}

void ImpulseFactor::bias(const Vec3& gravity, std::span<double> force) {
  for (dse3& r : r_) r = {};
  for (std::size_t i = 0; i < own_.size(); ++i) {
    const std::uint32_t body = body_dof_[i], parent = parent_dof_[i];
    const se3& V = a_[body];
    A_[body] = parent == kEnd ? se3{{}, -gravity} : A_[parent] + ad(a_[parent], V);
    r_[body] = own_[i] * A_[body] - dad(V, own_[i] * V);
  }
  for (const std::uint32_t d : inwards_) {
    const std::uint32_t next = next_[d];
    force[d] = columns_[d].S * r_[d];
    if (next != kEnd) r_[next] = r_[next] + r_[d];
  }
}

void ImpulseFactor::add_load(int link, const Vec3& point, const dse3& load,
                             std::span<double> force) const {
  const LinkPath& path = links_[static_cast<std::size_t>(link)];
  const dse3 F{load.m + cross(point - path.origin, load.f), load.f};
  for (std::uint32_t d = path.first; d != kEnd; d = next_[d]) force[d] += columns_[d].S * F;
}

}  // namespace vp::detail
