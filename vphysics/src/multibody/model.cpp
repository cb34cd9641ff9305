// Builds and checks a model, and decomposes its joints into nodes (tree.h).
#include "vphysics/multibody/model.h"

#include <array>
#include <cmath>

#include "multibody/tree.h"

namespace vp {
namespace {

using detail::LinkFrame;
using detail::Node;
using detail::NodeKind;
using detail::Tree;

tl::unexpected<Error> invalid(const LinkSpec& link, const std::string& why) {
  return tl::make_unexpected(Error{Errc::invalid_argument, "link \"" + link.name + "\": " + why});
}

bool finite(const Mat3& R) {
  return is_finite(R.cx) && is_finite(R.cy) && is_finite(R.cz);
}
bool is_rotation(const Mat3& R) {
  const Vec3 z = cross(R.cx, R.cy) - R.cz;
  return std::fabs(dot(R.cx, R.cx) - 1) < 1e-6 && std::fabs(dot(R.cy, R.cy) - 1) < 1e-6 &&
         std::fabs(dot(R.cx, R.cy)) < 1e-6 && dot(z, z) < 1e-12;
}

// A rotation that maps z to the axis.
Mat3 frame_along(const Vec3& axis) {
  const Vec3 z = (1.0 / norm(axis)) * axis;
  if (z.x == 0.0 && z.y == 0.0 && z.z > 0.0) return Mat3::identity();
  const Vec3 beside = std::fabs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 perpendicular = cross(z, beside);
  const Vec3 x = (1.0 / norm(perpendicular)) * perpendicular;
  return {x, cross(z, x), z};
}

std::array<Vec3, 2> axes_of(const Joint& joint) {
  struct {
    std::array<Vec3, 2> operator()(const FixedJoint&) const { return kNone; }
    std::array<Vec3, 2> operator()(const RevoluteJoint& j) const { return {j.axis, j.axis}; }
    std::array<Vec3, 2> operator()(const PrismaticJoint& j) const { return {j.axis, j.axis}; }
    std::array<Vec3, 2> operator()(const HelicalJoint& j) const { return {j.axis, j.axis}; }
    std::array<Vec3, 2> operator()(const CylindricalJoint& j) const { return {j.axis, j.axis}; }
    std::array<Vec3, 2> operator()(const UniversalJoint& j) const { return {j.first, j.second}; }
    std::array<Vec3, 2> operator()(const PlanarJoint&) const { return kNone; }
    std::array<Vec3, 2> operator()(const BallJoint&) const { return kNone; }
    std::array<Vec3, 2> operator()(const FreeJoint&) const { return kNone; }
    std::array<Vec3, 2> operator()(const std::shared_ptr<const UserJoint>&) const { return kNone; }
    std::array<Vec3, 2> kNone{Vec3{0, 0, 1}, Vec3{0, 0, 1}};
  } visitor;
  return std::visit(visitor, joint);
}

// Whether a body can have this inertia: the matrix trace(I)/2 - I about the centre of mass, the
// second moments of its mass, is positive semidefinite. I is then positive semidefinite too, and no
// moment exceeds the sum of the other two.
bool physical(const Inertia& J) {
  if (J == Inertia{}) return true;
  if (!(J.mass() > 0.0)) return false;
  const Sym3 I = J.central();
  const double trace = I.xx + I.yy + I.zz, half = 0.5 * trace;
  const double slack = 1e-9 * (std::fabs(J.rotational().xx) + std::fabs(J.rotational().yy) +
                               std::fabs(J.rotational().zz));
  const double a = half - I.xx + slack, b = half - I.yy + slack, c = half - I.zz + slack;
  const double minor = a * b - I.xy * I.xy;
  const double det =
      a * (b * c - I.yz * I.yz) - I.xy * (I.xy * c + I.yz * I.zx) - I.zx * (I.xy * I.yz + b * I.zx);
  const double scale = slack * trace;
  return a >= 0 && b >= 0 && c >= 0 && minor >= -scale && b * c - I.yz * I.yz >= -scale &&
         a * c - I.zx * I.zx >= -scale && det >= -scale * trace;
}

bool has_own_coordinates(const Joint& joint) {
  return !std::holds_alternative<BallJoint>(joint) && !std::holds_alternative<FreeJoint>(joint);
}

// The reason why a joint cannot have these forces, or null.
const char* wrong_with(const JointForces& f) {
  if (!(f.lower <= f.upper) || f.lower == JointForces::kNever || f.upper == -JointForces::kNever) {
    return "the lower limit must not be above the upper one";
  }
  if (!(f.limit_stiffness > 0.0)) return "the stiffness of its limits must be positive";
  if (!(f.limit_damping >= 0.0 && f.limit_damping < 1e300)) {
    return "the damping of its limits must be finite and not negative";
  }
  if (!(f.stiffness >= 0.0 && f.stiffness < 1e300) || !std::isfinite(f.rest)) {
    return "its spring must be finite, of a stiffness that is not negative";
  }
  if (!(f.friction >= 0.0 && f.motor_limit >= 0.0)) {
    return "its friction and its motor's limit must not be negative";
  }
  return nullptr;
}
const char* wrong_with_forces(const LinkSpec& link) {
  if (link.forces.empty()) return nullptr;
  if (static_cast<int>(link.forces.size()) != velocities_of(link.joint)) {
    return "its forces must be none, or one for each of its joint's velocities";
  }
  for (const JointForces& f : link.forces) {
    if (const char* why = wrong_with(f)) return why;
    const bool by_coordinate =
        f.lower > -JointForces::kNever || f.upper < JointForces::kNever || f.stiffness > 0.0;
    if (by_coordinate && !has_own_coordinates(link.joint)) {
      return "a ball or free joint has no coordinate for a spring or a limit; take a chain of "
             "simple joints";
    }
  }
  return nullptr;
}

// Adds the nodes of one joint, parents first, and returns the frame of its link.
class NodeMaker {
 public:
  NodeMaker(Tree<double>& tree, const LinkSpec& link) : tree_(tree), link_(link) {
    if (link.parent == kWorld) {
      frame_ = {kWorld, link.T_parent_joint, 0, 0};
    } else {
      const LinkFrame<double>& parent = tree.frames[static_cast<std::size_t>(link.parent)];
      frame_ = {parent.node, parent.T_node_link * link.T_parent_joint, 0, 0};
    }
    frame_.q = tree.coordinates;
    frame_.v = tree.velocities;
  }

  void operator()(const FixedJoint&) {}
  void operator()(const RevoluteJoint& j) { simple(NodeKind::revolute, j.axis); }
  void operator()(const PrismaticJoint& j) { simple(NodeKind::prismatic, j.axis); }
  void operator()(const HelicalJoint& j) { simple(NodeKind::helical, j.axis, j.pitch); }
  void operator()(const CylindricalJoint& j) {
    simple(NodeKind::prismatic, j.axis);
    simple(NodeKind::revolute, j.axis);
  }
  void operator()(const UniversalJoint& j) {
    simple(NodeKind::revolute, j.first);
    simple(NodeKind::revolute, j.second);
  }
  void operator()(const PlanarJoint&) {
    simple(NodeKind::prismatic, {1, 0, 0});
    simple(NodeKind::prismatic, {0, 1, 0});
    simple(NodeKind::revolute, {0, 0, 1});
  }
  void operator()(const BallJoint&) { add(NodeKind::ball, Mat3::identity(), 4, 3); }
  void operator()(const FreeJoint&) { add(NodeKind::free, Mat3::identity(), 7, 6); }
  void operator()(const std::shared_ptr<const UserJoint>& j) {
    const int dofs = j->degrees_of_freedom();
    add(NodeKind::user, Mat3::identity(), dofs, dofs, 0.0, j.get());
  }

  // Adds the link's inertia to the node, and returns the link's frame.
  LinkFrame<double> finish() {
    if (frame_.node != kWorld) {
      Inertia& J = tree_.nodes[static_cast<std::size_t>(frame_.node)].J;
      J = J + link_.inertia.InvXform(frame_.T_node_link);
    }
    return frame_;
  }

 private:
  void simple(NodeKind kind, const Vec3& axis, double pitch = 0.0) {
    add(kind, frame_along(axis), 1, 1, pitch);
  }
  // The node's frame is rotated by Q relative to the joint's frame; the link's frame is rotated
  // back.
  void add(NodeKind kind, const Mat3& Q, int coordinates, int dofs, double pitch = 0.0,
           const UserJoint* user = nullptr) {
    Node<double> node{};
    node.parent = frame_.node;
    node.kind = kind;
    node.q = tree_.coordinates;
    node.v = tree_.velocities;
    node.dofs = dofs;
    node.T_parent = frame_.T_node_link * SE3(Q, {});
    node.pitch = pitch;
    node.armature = link_.armature;
    node.damping = link_.damping;
    node.user = user;
    tree_.coordinates += coordinates;
    tree_.velocities += dofs;
    frame_.node = static_cast<int>(tree_.nodes.size());
    frame_.T_node_link = SE3(transpose(Q), {});
    tree_.nodes.push_back(node);
  }

  Tree<double>& tree_;
  const LinkSpec& link_;
  LinkFrame<double> frame_;
};

template <class To, class From>
Vec3T<To> cast(const Vec3T<From>& a) {
  return {static_cast<To>(a.x), static_cast<To>(a.y), static_cast<To>(a.z)};
}
template <class To, class From>
SE3T<To> cast(const SE3T<From>& A) {
  const auto& R = A.rotation();
  return {Mat3T<To>{cast<To>(R.cx), cast<To>(R.cy), cast<To>(R.cz)}, cast<To>(A.position())};
}
template <class To, class From>
InertiaT<To> cast(const InertiaT<From>& J) {
  const auto& I = J.rotational();
  const auto to = [](From x) { return static_cast<To>(x); };
  return {to(J.mass()),
          cast<To>(J.first_moment()),
          {to(I.xx), to(I.yy), to(I.zz), to(I.xy), to(I.yz), to(I.zx)}};
}

}  // namespace

int coordinates_of(const Joint& joint) {
  if (std::holds_alternative<BallJoint>(joint)) return 4;
  if (std::holds_alternative<FreeJoint>(joint)) return 7;
  return velocities_of(joint);
}

int velocities_of(const Joint& joint) {
  constexpr int kDegrees[] = {0, 1, 1, 1, 2, 2, 3, 3, 6};  // in the order of Joint
  if (const auto* user = std::get_if<std::shared_ptr<const UserJoint>>(&joint)) {
    return *user ? (*user)->degrees_of_freedom() : 0;
  }
  return kDegrees[joint.index()];
}

Expected<int> ModelBuilder::add(LinkSpec link) {
  const int count = static_cast<int>(links_.size());
  if (link.parent != kWorld && (link.parent < 0 || link.parent >= count)) {
    return invalid(link, "its parent is no earlier link; add links from the root on");
  }
  const Mat3& R = link.T_parent_joint.rotation();
  if (!finite(R) || !is_finite(link.T_parent_joint.position()) || !is_rotation(R)) {
    return invalid(link, "T_parent_joint must be finite and its rotation a rotation");
  }
  for (const Vec3& axis : axes_of(link.joint)) {
    const double length = norm(axis);
    if (!(length > 1e-100 && length < 1e100)) {
      return invalid(link, "a joint's axis must be finite and not zero");
    }
  }
  if (const auto* universal = std::get_if<UniversalJoint>(&link.joint)) {
    const Vec3 perpendicular = cross(universal->first, universal->second);
    if (norm(perpendicular) < 1e-6 * norm(universal->first) * norm(universal->second)) {
      return invalid(link, "the two axes of a universal joint must not be parallel");
    }
  }
  if (const auto* helical = std::get_if<HelicalJoint>(&link.joint);
      helical && !std::isfinite(helical->pitch)) {
    return invalid(link, "the pitch of a helical joint must be finite");
  }
  if (const auto* user = std::get_if<std::shared_ptr<const UserJoint>>(&link.joint)) {
    const int dofs = *user ? (*user)->degrees_of_freedom() : 0;
    if (dofs < 1 || dofs > 6) {
      return invalid(
          link, "a user-defined joint must not be null and must have 1 to 6 degrees of freedom");
    }
  }
  const Inertia& J = link.inertia;
  const Sym3& I = J.rotational();
  if (!std::isfinite(J.mass()) || !is_finite(J.first_moment()) ||
      !is_finite(Vec3{I.xx, I.yy, I.zz}) || !is_finite(Vec3{I.xy, I.yz, I.zx}) ||
      !(link.inertia_as_stated || physical(J))) {
    return invalid(link,
                   "no body has this inertia: the mass must be positive, the moments about the "
                   "centre of mass positive and none larger than the two others together");
  }
  if (!(link.armature >= 0.0 && link.armature < 1e300 && link.damping >= 0.0 &&
        link.damping < 1e300)) {
    return invalid(link, "armature and damping must be finite and not negative");
  }
  if (const char* why = wrong_with_forces(link)) return invalid(link, why);
  links_.push_back(std::move(link));
  return count;
}

Expected<Model> ModelBuilder::build() const {
  auto tree = std::make_shared<Tree<double>>();
  tree->links = links_;
  for (const LinkSpec& link : links_) {
    NodeMaker maker(*tree, link);
    std::visit(maker, link.joint);
    tree->frames.push_back(maker.finish());
  }
  if (tree->nodes.empty()) {
    return tl::make_unexpected(Error{Errc::invalid_argument,
                                     "build: the model has no joint that moves, so that it has no "
                                     "dynamics; add a link with a joint that does"});
  }
  // Which joints move an inertia; armature alone suffices.
  std::vector<char> moves(tree->nodes.size());
  for (std::size_t i = tree->nodes.size(); i-- > 0;) {
    const Node<double>& node = tree->nodes[i];
    if (node.J != Inertia{}) moves[i] = 1;
    if (moves[i] && node.parent != kWorld) moves[static_cast<std::size_t>(node.parent)] = 1;
    if (moves[i] || node.armature > 0.0) continue;
    for (std::size_t l = 0; l < links_.size(); ++l) {
      if (tree->frames[l].v <= node.v &&
          node.v < tree->frames[l].v + velocities_of(links_[l].joint)) {
        return invalid(links_[l],
                       "its joint moves no mass; give it, or a link after it, an inertia "
                       "or an armature");
      }
    }
  }
  tree->build_rows();
  return Model(std::move(tree));
}

template <class B>
template <class C>
ModelT<B>::ModelT(const ModelT<C>& other) {
  auto tree = std::make_shared<Tree<B>>();
  const Tree<C>& from = other.tree();
  for (const Node<C>& n : from.nodes) {
    tree->nodes.push_back({n.parent, n.kind, n.q, n.v, n.dofs, 0, 0, cast<B>(n.T_parent),
                           cast<B>(n.J), static_cast<B>(n.pitch), static_cast<B>(n.armature),
                           static_cast<B>(n.damping), n.user});
  }
  for (const LinkFrame<C>& p : from.frames) {
    tree->frames.push_back({p.node, cast<B>(p.T_node_link), p.q, p.v});
  }
  tree->links = from.links;
  tree->coordinates = from.coordinates;
  tree->velocities = from.velocities;
  tree->build_rows();
  tree_ = std::move(tree);
}

template <class B>
int ModelT<B>::links() const {
  return static_cast<int>(tree_->links.size());
}
template <class B>
int ModelT<B>::coordinates() const {
  return tree_->coordinates;
}
template <class B>
int ModelT<B>::velocities() const {
  return tree_->velocities;
}
template <class B>
int ModelT<B>::first_coordinate(int link) const {
  return tree_->frames[static_cast<std::size_t>(link)].q;
}
template <class B>
int ModelT<B>::first_velocity(int link) const {
  return tree_->frames[static_cast<std::size_t>(link)].v;
}
template <class B>
const LinkSpec& ModelT<B>::link(int link) const {
  return tree_->links[static_cast<std::size_t>(link)];
}
template <class B>
int ModelT<B>::find_link(std::string_view name) const {
  for (int i = 0; i < links(); ++i) {
    if (link(i).name == name) return i;
  }
  return -1;
}
template <class B>
std::vector<B> ModelT<B>::zero_coordinates() const {
  std::vector<B> q(static_cast<std::size_t>(coordinates()));
  for (const Node<B>& node : tree_->nodes) {
    if (node.kind == NodeKind::ball) q[static_cast<std::size_t>(node.q) + 3] = B(1);
    if (node.kind == NodeKind::free) q[static_cast<std::size_t>(node.q) + 6] = B(1);
  }
  return q;
}

template class ModelT<double>;
template class ModelT<float>;
template ModelT<float>::ModelT(const ModelT<double>&);
template ModelT<double>::ModelT(const ModelT<float>&);

}  // namespace vp
