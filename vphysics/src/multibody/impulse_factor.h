// How the velocities of a tree answer impulses: the inverse of its mass matrix as a square.
//
//   M^-1 = H^T H,   so an impulse p along a row J changes v by  dv = M^-1 J^T p = H^T (y p),
//   and the speed of a row J' by  J' dv = (y', y) p,   where  y = H J^T
//
// H is the articulated recursion's inward pass and has the tree's pattern: y has entries only for
// the joints between the link that is pushed and its root. An iterative solver therefore keeps one
// vector z, the sum of all y p; a row costs it two products as short as the link is deep. At the
// end dv = H^T z, one outward pass.
//
// With the equations of forward_dynamics.cpp, in the tree's frame, and g = 1 / sqrt(Omega),
// s = g S, G = g J^ S:
//   inwards    y = g tau + (s, r),  r_next = r - G y        r: the impulse on all that is further
//   out outwards   t = z - (G, a),  dv = g t,  a = a_next + s t  a: the change of twist
//
// Each degree of freedom is taken as a joint of its own; `next` is the one it hangs on. Source:
// Featherstone 2008, chapter 7, for the recursion; the square root of its factors is ours.
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

  // The inertias of the bodies in the configuration that the last call has left in the data.
  void find_inertias(const Model& model, const Data& data);
  // From that configuration, whose inertias are found unless they have been. With a time h the
  // joints' viscous damping D is in it: M + h D in the place of M, for implicit steps. False if a
  // joint moves no inertia; what is computed with the factors then is unspecified.
  bool factor(const Model& model, const Data& data, double damping_time = 0.0,
              bool inertias_are_found = false);

  // The degrees of freedom that a link's rows have entries for: the first, those next to it, and
  // how many they are. None for a link that is fixed to the world.
  std::uint32_t first(int link) const { return links_[static_cast<std::size_t>(link)].first; }
  std::uint32_t depth(int link) const { return links_[static_cast<std::size_t>(link)].depth; }
  std::uint32_t depth_of_dof(std::uint32_t dof) const { return depth_[dof]; }
  const std::uint32_t* next() const { return next_.data(); }
  std::uint32_t deepest() const { return deepest_; }
  std::size_t dofs() const { return columns_.size(); }

  // y of a unit impulse: a force through a point of the link, or a moment, in world axes. It has as
  // many entries as the link is deep.
  void force_row(int link, const Vec3& point, const Vec3& direction, double* y) const;
  void moment_row(int link, const Vec3& direction, double* y) const;
  // Three of either, one behind the other.
  void force_rows(int link, const Vec3& point, const Vec3 (&directions)[3], double* y) const;
  void moment_rows(int link, const Vec3 (&directions)[3], double* y) const;
  // Of a force of one joint coordinate: y, as long as the coordinate is deep, kept until the next
  // factor(); and (y, y), what a unit impulse gives the coordinate's own speed.
  struct JointRow {
    const double* y;
    double response;
  };
  JointRow joint_row(std::uint32_t dof);

  // x <- H^T x and x <- M^-1 x, for all degrees of freedom.
  void to_velocities(std::span<double> x);
  void solve(std::span<double> x);

  // With the velocities v, of the configuration of the last factor(): the angular velocity of a
  // link and the velocity of a point of it, in the world. twists() comes first.
  void twists(std::span<const double> v);
  se3 twist_at(int link, const Vec3& point) const {
    const LinkPath& path = links_[static_cast<std::size_t>(link)];
    if (path.first == kEnd) return {};
    const se3& V = a_[path.first];
    return {V.w, V.v + cross(V.w, point - path.origin)};
  }
  // Of some nodes' bodies, ascending, together, in the tree's frame: the inertia, once
  // find_inertias() has been called, and the momentum at the data's twists or at those of twists().
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
  // What forward_kinematics() makes of these, to the same bits, where poses have changed by the
  // places of free roots alone since it was called last. Not of users' joints.
  static void kinematics_of(const Model& model, Data& data, std::span<const double> q,
                            std::span<const double> v);

  // The joints' forces that keep the velocities that twists() was given last: those of the
  // velocities, and those against gravity. Without damping; of models whose joints' subspaces are
  // constant, in the frame of the joint's one side or the other: all but users' joints. Recursive
  // Newton-Euler: with V the twists, A = A_parent + ad(V_parent, V) and F = J A - dad(V, J V) of a
  // body, S times the sum of F of all that hangs on a joint.
  void bias(const Vec3& gravity, std::span<double> force);
  // Adds what a load on a link, about a point of it and in world axes, does along the joints.
  void add_load(int link, const Vec3& point, const dse3& load, std::span<double> force) const;

 private:
  using Column = FactorColumn;
  struct CachedRow {
    std::uint32_t begin = 0;  // in cached_
    bool valid = false;
    double response = 0.0;
  };
  struct LinkPath {
    std::uint32_t first, depth;
    Vec3 origin;  // of its tree, in the world
  };
  void row(std::uint32_t dof, dse3 impulse, double* y) const;
  Momentum momentum_at(std::span<const int> nodes, const Data& data, const void* twists) const;

  std::vector<Column> columns_;              // of each degree of freedom
  std::vector<std::uint32_t> next_, depth_;  // likewise
  std::vector<std::uint32_t> inwards_;       // all of them, from the leaves to the roots
  std::vector<LinkPath> links_;
  std::vector<CachedRow> joint_rows_;  // of each degree of freedom
  std::vector<double> cached_;
  std::vector<std::uint32_t> body_dof_;  // of each node: that which carries its body
  std::vector<std::uint32_t>
      parent_dof_;  // of each node: that which carries its parent's body, or kEnd
  // Inertias of the slots' bodies, by groups of slots (lanes.h): in the nodes' own frames, and in
  // the tree's; where each node's begins.
  AlignedArray<double> bodies_, inertias_;
  std::vector<std::uint32_t> inertia_at_;
  AlignedArray<double> J_;  // of each node: scratch
  std::vector<se3> A_;      // of each degree of freedom: scratch
  std::vector<se3> a_;      // likewise: what twists() leaves
  std::vector<dse3> r_;     // scratch
  std::uint32_t deepest_ = 0;
};

}  // namespace vp::detail
