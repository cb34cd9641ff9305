// A tree of links and joints: the constant part of a multibody system.
//
// A model is built once, checked, and then const. Any number of threads may share it, each with its
// own data (data.h). Links are numbered in the order in which they were added, parents before
// children. Their coordinates and velocities follow in the same order.
//
// ModelT<float> is converted from a Model, for data in float.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "vphysics/error.h"
#include "vphysics/multibody/joint.h"

namespace vp {

inline constexpr int kWorld = -1;  // as a parent

struct LinkSpec {
  std::string name{};  // may be empty
  int parent = kWorld;
  Joint joint = FixedJoint{};
  SE3 T_parent_joint{};   // pose of the joint's frame in the parent's link frame
  Inertia inertia{};      // about the link's origin, in its frame; may be zero
  double armature = 0.0;  // rotor inertia, added to each velocity's inertia in joint space
  double damping = 0.0;   // viscous, for each velocity [N s/m] or [N m s/rad]
  // Empty, or one for each velocity. Velocities of ball and free joints are not rates of
  // coordinates and use only friction and motor_limit.
  std::vector<JointForces> forces{};
  // Accept the inertia as given, even if no physical body has it, as in many robot files. It should
  // be positive semidefinite: otherwise forward dynamics may have no solution.
  bool inertia_as_stated = false;
};

namespace detail {
template <class B>
struct Tree;
}

template <class B>
class ModelT {
 public:
  // Converts the tree to another precision.
  template <class C>
  explicit ModelT(const ModelT<C>& other);

  int links() const;
  int coordinates() const;  // length of q
  int velocities() const;   // length of v, of accelerations and of joint forces
  // Index of the link's first coordinate and of its first velocity.
  int first_coordinate(int link) const;
  int first_velocity(int link) const;
  const LinkSpec& link(int link) const;
  int find_link(std::string_view name) const;  // -1 if not found
  // Coordinates with all joints at zero and identity quaternions.
  std::vector<B> zero_coordinates() const;

  const detail::Tree<B>& tree() const { return *tree_; }

 private:
  friend class ModelBuilder;
  template <class C>
  friend class ModelT;
  explicit ModelT(std::shared_ptr<const detail::Tree<B>> tree) : tree_(std::move(tree)) {}
  std::shared_ptr<const detail::Tree<B>> tree_;
};

using Model = ModelT<double>;

class ModelBuilder {
 public:
  // Returns the link's number. Fails on a parent that does not exist, a non-finite number, an axis
  // of zero length, parallel axes, a non-physical inertia (negative mass, not positive
  // semidefinite, principal moments that violate the triangle inequality; accepted with
  // inertia_as_stated), negative armature or damping, forces that do not match the joint or
  // contradict each other, or a user joint with less than 1 or more than 6 degrees of freedom.
  Expected<int> add(LinkSpec link);
  // Fails if no joint moves, or if a joint moves no mass, neither itself nor through its
  // descendants.
  Expected<Model> build() const;

 private:
  std::vector<LinkSpec> links_;
};

}  // namespace vp
