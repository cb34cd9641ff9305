// A tree of links and joints: what does not change while it moves.
//
// Built once and checked there, then const: any number of threads may use a model at once, each
// with its own data (data.h). Links are numbered in the order they were added, a parent before its
// children; their coordinates and velocities follow each other in the same order.
//
// ModelT<float> is made from a Model, for data in float.
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
  double armature = 0.0;  // rotor inertia, added to each of the joint's own in joint space
  double damping = 0.0;   // viscous, of each of its velocities [N s/m] or [N m s/rad]
  // None, or one for each of its velocities. Those of a ball or free joint, which have no
  // coordinate of their own, know friction and the motor's limit only.
  std::vector<JointForces> forces{};
  // Take the inertia as it is stated, though no body may have it, as robots' files do. It should be
  // positive semidefinite: else forward dynamics may have no solution.
  bool inertia_as_stated = false;
};

namespace detail {
template <class B>
struct Tree;
}

template <class B>
class ModelT {
 public:
  // The same tree in another precision.
  template <class C>
  explicit ModelT(const ModelT<C>& other);

  int links() const;
  int coordinates() const;  // length of q
  int velocities() const;   // length of v, of the accelerations and of the forces
  // The first of a link's coordinates and velocities.
  int first_coordinate(int link) const;
  int first_velocity(int link) const;
  const LinkSpec& link(int link) const;
  int find_link(std::string_view name) const;  // or -1
  // Coordinates with every joint at zero and every quaternion at one.
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
  // The link's number. Refused: a parent that does not exist, a number that is not finite, an axis
  // of length zero, parallel axes, an inertia that no body has (negative mass, not positive
  // semidefinite, moments against the triangle inequality; taken where it is inertia_as_stated),
  // negative armature or damping, forces that are not the joint's or contradict themselves, a user
  // joint that says less than 1 or more than 6 degrees of freedom.
  Expected<int> add(LinkSpec link);
  // Refused: no joint that moves; a joint that moves no mass, neither by itself nor through its
  // children.
  Expected<Model> build() const;

 private:
  std::vector<LinkSpec> links_;
};

}  // namespace vp
