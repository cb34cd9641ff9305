// Momentum and centre of mass of a tree with a free root.
//
// Only gravity and contacts change its momentum; between them its centre of mass moves uniformly.
// The integration of the coordinates conserves both only to its order. Corrections of the root
// conserve them to rounding. With P the target momentum, L the target angular momentum about the
// centre of mass c, and P', L' those of the current velocities:
//   root's twist += (I_c^-1 (L - L'), (P - P') / m at c)
// I_c, m: inertia and mass of the tree as one rigid body, its joints locked.
#pragma once

#include <span>
#include <vector>

#include "multibody/impulse_factor.h"
#include "vphysics/multibody/dynamics.h"

namespace vp {

struct CompositeBody {
  double mass = 0.0;
  Vec3 centre;           // centre of mass, world frame
  Sym3 central;          // rotational inertia about it, world axes
  Vec3 linear, angular;  // momentum; the angular one about the centre
  Vec3 root;             // the root joint's origin, world frame
};

// Whether the node is the root of a floating tree: a free joint without damping and armature.
bool floats(const Model& model, int node);

class FloatingTree {
 public:
  // All floating trees of a model.
  static std::vector<FloatingTree> of(const Model& model);

  // For the configuration of the last forward_kinematics() and factor.find_inertias(), with the
  // velocities of the former, or with those of the last factor.twists().
  CompositeBody composite(const Data& data, const detail::ImpulseFactor& factor) const;
  CompositeBody composite_of_twists(const Data& data, const detail::ImpulseFactor& factor) const;
  // Changes the root's velocities in v so that the tree has the target momentum. now: the tree at
  // v.
  void set_momentum(const Model& model, const Data& data, const CompositeBody& now,
                    const CompositeBody& target, std::span<double> v) const;
  void shift(const Model& model, const Vec3& by, std::span<double> q) const;
  int root() const { return root_; }  // index of its node

 private:
  CompositeBody composite(const Data& data, const Inertia& J, const dse3& momentum) const;

  int root_ = 0;
  std::vector<int> nodes_;
};

}  // namespace vp
