#include "urdf/build.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

namespace vp::detail {
namespace {

// What urdfdom would print is kept: it is the reason of its refusal. The bridge to the console is
// one for the whole process, so one thread uses it at a time.
class Listener final : public console_bridge::OutputHandler {
 public:
  Listener() : alone_(mutex()), before_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~Listener() override { console_bridge::useOutputHandler(before_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (heard_.empty() && level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) heard_ = text;
  }
  const std::string& heard() const { return heard_; }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> alone_;
  console_bridge::OutputHandler* before_;
  std::string heard_;
};

// urdfdom's tree, taken apart without recursion: its links own each other as deep as the tree is.
class UrdfTree {
 public:
  explicit UrdfTree(const std::string& text) {
    const Listener listener;
    tree_ = urdf::parseURDF(text);
    if (!tree_) refusal_ = listener.heard();
  }
  ~UrdfTree() {
    if (!tree_) return;
    for (auto& [name, link] : tree_->links_) {
      link->child_links.clear();
      link->child_joints.clear();
    }
  }
  UrdfTree(const UrdfTree&) = delete;
  UrdfTree& operator=(const UrdfTree&) = delete;

  const urdf::ModelInterface* operator->() const { return tree_.get(); }
  explicit operator bool() const { return tree_ != nullptr; }
  const std::string& refusal() const { return refusal_; }

 private:
  urdf::ModelInterfaceSharedPtr tree_;
  std::string refusal_;
};

Vec3 to_vec3(const urdf::Vector3& a) {
  return {a.x, a.y, a.z};
}
SE3 to_pose(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {from_quaternion(Quaternion{r.x, r.y, r.z, r.w}), to_vec3(pose.position)};
}
Inertia to_inertia(const urdf::Link& link) {
  if (!link.inertial) return {};
  const urdf::Inertial& i = *link.inertial;
  return Inertia(i.mass, {}, {i.ixx, i.iyy, i.izz, i.ixy, i.iyz, i.ixz})
      .InvXform(to_pose(i.origin));
}

// The rotation that takes z to the axis.
Mat3 frame_of_plane(const Vec3& axis) {
  const Vec3 z = (1.0 / norm(axis)) * axis;
  const Vec3 across = cross(z, std::fabs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  const Vec3 x = (1.0 / norm(across)) * across;
  return {x, cross(z, x), z};
}

Joint to_joint(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
      return RevoluteJoint{to_vec3(joint.axis)};
    case urdf::Joint::PRISMATIC:
      return PrismaticJoint{to_vec3(joint.axis)};
    case urdf::Joint::FLOATING:
      return FreeJoint{};
    case urdf::Joint::PLANAR:
      return PlanarJoint{};
    default:
      return FixedJoint{};
  }
}

UrdfJoint to_urdf_joint(const urdf::Joint& joint, int link) {
  UrdfJoint out;
  out.name = joint.name;
  out.link = link;
  if (joint.limits) {
    if (joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::PRISMATIC) {
      out.lower = joint.limits->lower;
      out.upper = joint.limits->upper;
    }
    out.effort = joint.limits->effort;
    out.velocity = joint.limits->velocity;
  }
  if (joint.dynamics) out.friction = joint.dynamics->friction;
  if (joint.mimic) {
    out.mimics = joint.mimic->joint_name;
    out.multiplier = joint.mimic->multiplier;
    out.offset = joint.mimic->offset;
  }
  return out;
}

// Limits, friction and effort, for each of the joint's velocities.
std::vector<JointForces> to_forces(const UrdfJoint& joint, int velocities) {
  JointForces forces;
  forces.lower = joint.lower;
  forces.upper = joint.upper;
  forces.friction = joint.friction;
  forces.motor_limit = joint.effort;
  return std::vector<JointForces>(static_cast<std::size_t>(velocities), forces);
}

class Builder {
 public:
  explicit Builder(const UrdfLines& lines) : lines_(lines) {}

  Expected<UrdfModel> build(const UrdfTree& tree, const UrdfOptions& options) {
    LinkSpec root;
    root.T_parent_joint = options.T_world_root;
    if (options.base == UrdfBase::floating) root.joint = FreeJoint{};
    if (auto added = add(std::move(root), *tree->getRoot()); !added) {
      return tl::make_unexpected(added.error());
    }
    // Depth first; of one link's joints the first in the file goes first.
    while (!waiting_.empty()) {
      const auto [joint, parent] = waiting_.back();
      waiting_.pop_back();
      if (auto added = this->joint(*joint, parent, *tree->getLink(joint->child_link_name));
          !added) {
        return tl::make_unexpected(added.error());
      }
    }
    if (auto good = every_joint_moves_mass(); !good) return tl::make_unexpected(good.error());
    auto model = builder_.build();
    if (!model) return tl::make_unexpected(urdf_error(1, model.error().message));
    auto couplings = this->couplings(*model);
    if (!couplings) return tl::make_unexpected(couplings.error());
    return UrdfModel{
        tree->getName(), *std::move(model), std::move(joints_), *std::move(couplings), {}};
  }

 private:
  struct Waiting {
    const urdf::Joint* joint;
    int parent;
  };
  struct Added {
    int parent, velocities, line;
    double mass;
  };

  // Adds a link below its joint, and has its own joints wait.
  Expected<int> add(LinkSpec spec, const urdf::Link& link) {
    spec.name = link.name;
    spec.inertia = to_inertia(link);
    const auto inertial = lines_.inertials.find(link.name);
    const int line =
        inertial != lines_.inertials.end() ? inertial->second : lines_.links.at(link.name);
    auto number = add(std::move(spec), line);
    if (!number) return number;
    const std::size_t first = waiting_.size();
    for (const auto& joint : link.child_joints) waiting_.push_back({joint.get(), *number});
    std::sort(waiting_.begin() + static_cast<std::ptrdiff_t>(first), waiting_.end(),
              [&](const Waiting& a, const Waiting& b) { return order(a) > order(b); });
    return number;
  }
  Expected<int> add(LinkSpec spec, int line) {
    added_.push_back({spec.parent, velocities_of(spec.joint), line, spec.inertia.mass()});
    auto number = builder_.add(std::move(spec));
    if (!number) return tl::make_unexpected(urdf_error(line, number.error().message));
    return number;
  }
  int order(const Waiting& waiting) const { return lines_.joints.at(waiting.joint->name).order; }

  Expected<int> joint(const urdf::Joint& joint, int parent, const urdf::Link& child) {
    LinkSpec spec;
    spec.parent = parent;
    spec.joint = to_joint(joint);
    spec.T_parent_joint = to_pose(joint.parent_to_joint_origin_transform);
    if (joint.dynamics) spec.damping = joint.dynamics->damping;
    const Vec3 axis = to_vec3(joint.axis);
    joints_.push_back(to_urdf_joint(joint, static_cast<int>(added_.size())));
    spec.forces = to_forces(joints_.back(), velocities_of(spec.joint));
    if (joint.type == urdf::Joint::PLANAR && !(axis.x == 0.0 && axis.y == 0.0 && axis.z > 0.0)) {
      // The plane's frame is turned against the link's, and turned back by a fixed joint.
      const Mat3 Q = frame_of_plane(axis);
      spec.T_parent_joint = spec.T_parent_joint * SE3(Q, {});
      auto plane = add(std::move(spec), lines_.joints.at(joint.name).line);
      if (!plane) return plane;
      spec = {};
      spec.parent = *plane;
      spec.T_parent_joint = SE3(transpose(Q), {});
    }
    return add(std::move(spec), child);
  }

  // q - multiplier q of the other = offset.
  Expected<std::vector<ConstraintPtr>> couplings(const Model& model) const {
    std::map<std::string_view, int> links;
    for (const UrdfJoint& joint : joints_) links[joint.name] = joint.link;
    std::vector<ConstraintPtr> out;
    for (const UrdfJoint& joint : joints_) {
      if (joint.mimics.empty()) continue;
      const int other = links.at(joint.mimics);
      if (joint.link == other || coordinates_of(model.link(joint.link).joint) != 1 ||
          coordinates_of(model.link(other).joint) != 1) {
        return tl::make_unexpected(urdf_error(
            lines_.joints.at(joint.name).mimic_line,
            "a joint of one coordinate may mimic another joint of one coordinate, no other"));
      }
      out.push_back(couple({{joint.link, 0, 1.0}, {other, 0, -joint.multiplier}}, joint.offset));
    }
    return out;
  }

  Expected<void> every_joint_moves_mass() const {
    std::vector<double> moved(added_.size());
    for (std::size_t i = added_.size(); i-- > 0;) {
      const Added& link = added_[i];
      moved[i] += link.mass;
      if (link.velocities > 0 && !(moved[i] > 0.0)) {
        return tl::make_unexpected(
            urdf_error(link.line,
                       "the joint above this link moves no mass; give it, or a link "
                       "after it, an <inertial>"));
      }
      if (link.parent != kWorld) moved[static_cast<std::size_t>(link.parent)] += moved[i];
    }
    return {};
  }

  const UrdfLines& lines_;
  ModelBuilder builder_;
  std::vector<Added> added_;
  std::vector<Waiting> waiting_;
  std::vector<UrdfJoint> joints_;
};

}  // namespace

Expected<UrdfModel> build_urdf(const std::string& text, const UrdfLines& lines,
                               const UrdfOptions& options) {
  const UrdfTree tree(text);
  if (!tree) return tl::make_unexpected(urdf_error(1, "urdfdom refuses it: " + tree.refusal()));
  return Builder(lines).build(tree, options);
}

}  // namespace vp::detail
