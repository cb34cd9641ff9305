// The response of a tree's velocities to impulses, with the inverse of the mass matrix in factored
// form.
//
//   M^-1 = H^T H,   so an impulse p along a row J changes v by  dv = M^-1 J^T p = H^T (y p),
//   and the speed of a row J' by  J' dv = (y', y) p,   where  y = H J^T
//
// H is the tip-to-base pass of the articulated body recursion and has the tree's sparsity: y has
// entries only for the joints between the loaded link and its root. An iterative solver keeps one
// vector z, the sum of all y p. A row then costs two dot products whose length is the link's depth.
// At the end one base-to-tip pass gives dv = H^T z.
//
// With the equations of forward_dynamics.h, in the tree's frame, and g = 1 / sqrt(Omega), s = g S,
// G = g J^ S:
//   tip to base   y = g tau + (s, r),  r_next = r - G y       r: the impulse on all descendants
//   base to tip   t = z - (G, a),  dv = g t,  a = a_next + s t   a: the change of twist
//
// Each degree of freedom is treated as a joint; `next` is its parent. Source: Featherstone 2008,
// chapter 7, for the recursion; the square root of its factors is our own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "multibody/factor_column.h"
#include "multibody/lanes.h"
#include "vphysics/multibody/dynamics.h"

namespace vp::detail {

class ImpulseFactor {
 public:
  static constexpr std::uint32_t kEnd = 0xffffffffu;

  explicit ImpulseFactor(const Model& model);

  // Computes the inertias of the bodies in the configuration of the last call on the data.
  void find_inertias(const Model& model, const Data& data);
  // Factors M in that configuration; computes the inertias first unless inertias_are_found.
  // For implicit steps it factors M + h D + diag(gains) instead, with h = damping_time, the joints'
  // viscous damping D, and the gains of other joint forces, one for each degree of freedom or none.
  // Returns false if a joint moves no inertia; results with the factors are then unspecified.
  bool factor(const Model& model, const Data& data, double damping_time = 0.0,
              bool inertias_are_found = false, std::span<const double> gains = {});

  // The degrees of freedom for which a link's rows have entries: the first, the parent of each
  // (next), and their number (depth). None for a link fixed to the world.
  std::uint32_t first(int link) const { return links_[static_cast<std::size_t>(link)].first; }
  std::uint32_t depth(int link) const { return links_[static_cast<std::size_t>(link)].depth; }
  std::uint32_t depth_of_dof(std::uint32_t dof) const { return depth_[dof]; }
  const std::uint32_t* next() const { return next_.data(); }
  std::uint32_t deepest() const { return deepest_; }
  std::size_t dofs() const { return columns_.size(); }
  // The inertia that a joint coordinate moves, gains and damping included, with all coordinates
  // nearer to the root locked.
  double moved_inertia(std::size_t dof) const { return 1.0 / (columns_[dof].g * columns_[dof].g); }

  // y of a unit impulse in world axes: a force through a point of the link, or a moment. It has
  // depth(link) entries.
  void force_row(int link, const Vec3& point, const Vec3& direction, double* y) const;
  void moment_row(int link, const Vec3& direction, double* y) const;
  // Three rows of either kind, one after the other.
  void force_rows(int link, const Vec3& point, const Vec3 (&directions)[3], double* y) const;
  void moment_rows(int link, const Vec3 (&directions)[3], double* y) const;
  // Row of a force of one joint coordinate: y, with depth_of_dof(dof) entries, valid until the next
  // factor(); and (y, y), the velocity change of the coordinate due to a unit impulse.
  struct JointRow {
    const double* y;
    double response;
  };
  JointRow joint_row(std::uint32_t dof);

  // x <- H^T x and x <- M^-1 x, over all degrees of freedom.
  void to_velocities(std::span<double> x);
  void solve(std::span<double> x);

  // twists() computes all twists from the velocities v, in the configuration of the last factor().
  // twist_at() then returns the angular velocity of a link and the velocity of a point of it, in
  // the world.
  void twists(std::span<const double> v);
  se3 twist_at(int link, const Vec3& point) const {
    const LinkPath& path = links_[static_cast<std::size_t>(link)];
    if (path.first == kEnd) return {};
    const se3& V = a_[path.first];
    return {V.w, V.v + cross(V.w, point - path.origin)};
  }
  // Sums over the bodies of some nodes, ascending, in the tree's frame: the inertia, after a call
  // of find_inertias(), and the momentum at the data's twists or at those of twists().
  struct Momentum {
    Inertia inertia;
    dse3 momentum{};
  };
  Momentum momentum_of(std::span<const int> nodes, const Data& data) const {
    return momentum_at(nodes, data, nullptr);
  }
  Momentum momentum_of_twists(std::span<const int> nodes, const Data& data) const {
    return momentum_at(nodes, data, a_.data());
  }
  // Equals forward_kinematics(), to the same bits, if only the poses of free roots have changed
  // since its last call. Not for user joints.
  static void kinematics_of(const Model& model, Data& data, std::span<const double> q,
                            std::span<const double> v);

  // The bias forces of the joints, for the velocities of the last twists(): velocity-product terms
  // and gravity, without damping. Valid for joints whose subspace is constant in the frame of one
  // side of the joint: all but user joints. Recursive Newton-Euler: with the twists V, A = A_parent
  // + ad(V_parent, V) and F = J A - dad(V, J V) of a body, S times the sum of F over the joint's
  // subtree.
  void bias(const Vec3& gravity, std::span<double> force);
  // Adds the joint forces of a wrench on a link, about a point of it and in world axes.
  void add_load(int link, const Vec3& point, const dse3& load, std::span<double> force) const;

 private:
  using Column = FactorColumn;
  struct CachedRow {
    std::uint32_t begin = 0;  // into cached_
    bool valid = false;
    double response = 0.0;
  };
  struct LinkPath {
    std::uint32_t first, depth;
    Vec3 origin;  // of its tree, in the world
  };
  void row(std::uint32_t dof, dse3 impulse, double* y) const;
  Momentum momentum_at(std::span<const int> nodes, const Data& data, const void* twists) const;

  std::vector<Column> columns_;                   // one for each degree of freedom
  std::vector<std::uint32_t> next_, depth_;       // one for each degree of freedom
  std::vector<std::uint32_t> tip_to_base_order_;  // all degrees of freedom, tip to base
  std::vector<LinkPath> links_;
  std::vector<CachedRow> joint_rows_;  // one for each degree of freedom
  std::vector<double> cached_;
  std::vector<std::uint32_t> body_dof_;    // of each node: the one that carries its body
  std::vector<std::uint32_t> parent_dof_;  // of each node: that of its parent's body, or kEnd
  // Inertias of the slots' bodies, by groups of slots (lanes.h): in the nodes' own frames, and in
  // the tree's frame; where each node's begins.
  AlignedArray<double> bodies_, inertias_;
  std::vector<std::uint32_t> inertia_at_;
  AlignedArray<double> J_;  // of each node: scratch
  std::vector<se3> A_;      // of each degree of freedom: scratch
  std::vector<se3> a_;      // of each degree of freedom: the result of twists()
  std::vector<dse3> r_;     // scratch
  std::uint32_t deepest_ = 0;
};

}  // namespace vp::detail
