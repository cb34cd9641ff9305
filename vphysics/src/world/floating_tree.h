// What a tree whose root is free does as a whole.
//
// Nothing but gravity and contacts change its momentum, and its centre of mass moves evenly between
// them. A step of its coordinates keeps both only to the order of the integrator; these put the
// root right, so that they are kept to rounding: with P the momentum wanted, L that about the
// centre of mass c, and P', L' those of the velocities at hand,
//   root's twist += (I_c^-1 (L - L'), (P - P') / m at c),   I_c, m: of the tree with its joints
//   held
#pragma once

#include <span>
#include <vector>

#include "multibody/impulse_factor.h"
#include "vphysics/multibody/dynamics.h"

namespace vp {

struct CompositeBody {
  double mass = 0.0;
  Vec3 centre;           // of mass, world frame
  Sym3 central;          // rotational inertia about it, world axes
  Vec3 linear, angular;  // momentum, the angular one about the centre
  Vec3 root;             // the root's origin, world frame
};

// Whether a node of a model is the root of one: its freedom has neither damping nor armature.
bool floats(const Model& model, int node);

class FloatingTree {
 public:
  // Those of a model.
  static std::vector<FloatingTree> of(const Model& model);

  // Of the configuration that forward_kinematics() and factor.find_inertias() were given last, and
  // of the former's velocities, or those that factor.twists() was given last.
  CompositeBody composite(const Data& data, const detail::ImpulseFactor& factor) const;
  CompositeBody whole_of_twists(const Data& data, const detail::ImpulseFactor& factor) const;
  // Changes the root's velocities in v, of which the tree is as it is now, to those with the
  // momentum wanted.
  void set_momentum(const Model& model, const Data& data, const CompositeBody& now,
                    const CompositeBody& target, std::span<double> v) const;
  void shift(const Model& model, const Vec3& by, std::span<double> q) const;
  int root() const { return root_; }  // the number of its node

 private:
  CompositeBody composite(const Data& data, const Inertia& J, const dse3& momentum) const;

  int root_ = 0;
  std::vector<int> nodes_;
};

}  // namespace vp
