#include "urdf/build.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include "urdf/mend.h"

namespace vp::detail {
namespace {

// Captures what urdfdom would print: the reason for its rejection. The console bridge is global to
// the process, so a mutex allows one thread at a time.
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

// urdfdom's tree, destroyed without recursion: its links own each other to the depth of the tree.
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

// A rotation that maps z to the axis.
Mat3 frame_of_plane(const Vec3& axis) {
  const Vec3 z = (1.0 / norm(axis)) * axis;
  const Vec3 perpendicular = cross(z, std::fabs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  const Vec3 x = (1.0 / norm(perpendicular)) * perpendicular;
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

double bounded(double stated) {
  return std::fabs(stated) < kUrdfUnbounded ? stated : std::copysign(JointForces::kNever, stated);
}
UrdfJoint to_urdf_joint(const urdf::Joint& joint, int link, bool mimics) {
  UrdfJoint out;
  out.name = joint.name;
  out.link = link;
  if (joint.limits) {
    if (joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::PRISMATIC) {
      out.lower = bounded(joint.limits->lower);
      out.upper = bounded(joint.limits->upper);
    }
    out.effort = bounded(joint.limits->effort);
    out.velocity = bounded(joint.limits->velocity);
  }
  if (joint.dynamics) out.friction = joint.dynamics->friction;
  if (mimics) {
    out.mimics = joint.mimic->joint_name;
    out.multiplier = joint.mimic->multiplier;
    out.offset = joint.mimic->offset;
  }
  return out;
}

// Limits, friction and effort for each of the joint's velocities.
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
  Builder(const UrdfLines& lines, std::vector<std::string>& notes) : lines_(lines), notes_(notes) {}

  Expected<UrdfModel> build(const UrdfTree& tree, const UrdfOptions& options) {
    LinkSpec root;
    root.T_parent_joint = options.T_world_root;
    if (options.base == UrdfBase::floating) root.joint = FreeJoint{};
    add(std::move(root), *tree->getRoot());
    // Depth first; the joints of a link in the order of the file.
    while (!waiting_.empty()) {
      const auto [joint, parent] = waiting_.back();
      waiting_.pop_back();
      this->joint(*joint, parent, *tree->getLink(joint->child_link_name));
    }
    auto model = this->model();
    if (!model) return tl::make_unexpected(model.error());
    std::vector<ConstraintPtr> couplings = this->couplings(*model);
    return UrdfModel{tree->getName(),      *std::move(model),      std::move(joints_),
                     std::move(couplings), std::move(collisions_), std::move(notes_)};
  }

 private:
  struct PendingJoint {
    const urdf::Joint* joint;
    int parent;
  };

  // Adds a link with its joint, and queues its child joints.
  void add(LinkSpec spec, const urdf::Link& link) {
    spec.name = link.name;
    spec.inertia = inertia_of(link);
    spec.inertia_as_stated = true;
    const auto inertial = lines_.inertials.find(link.name);
    const int number =
        add(std::move(spec),
            inertial != lines_.inertials.end() ? inertial->second : lines_.links.at(link.name));
    if (const auto found = lines_.collisions.find(link.name); found != lines_.collisions.end()) {
      for (const UrdfCollision& collision : found->second) {
        collisions_.push_back(collision);
        collisions_.back().link = number;
      }
    }
    const std::size_t first = waiting_.size();
    for (const auto& joint : link.child_joints) waiting_.push_back({joint.get(), number});
    std::sort(waiting_.begin() + static_cast<std::ptrdiff_t>(first), waiting_.end(),
              [&](const PendingJoint& a, const PendingJoint& b) { return order(a) > order(b); });
  }
  int add(LinkSpec spec, int line) {
    links_.push_back(std::move(spec));
    link_lines_.push_back(line);
    return static_cast<int>(links_.size()) - 1;
  }

  Inertia inertia_of(const urdf::Link& link) {
    if (!link.inertial) return {};
    const urdf::Inertial& i = *link.inertial;
    Sym3 moments{i.ixx, i.iyy, i.izz, i.ixy, i.iyz, i.ixz};
    const StatedMoments stated = judged(i.mass, moments);
    if (stated != StatedMoments::physical) {
      std::string what = "no body has the inertia of link \"" + link.name + "\": ";
      if (stated == StatedMoments::negative) {
        moments = without_negative(moments);
        what += "a principal moment is negative, and taken as zero";
      } else {
        what += i.mass > 0.0 ? "one principal moment is more than the two others together; "
                             : "it has moments and no mass; ";
        what += "it is taken as it stands";
      }
      notes_.push_back(urdf_note(lines_.inertials.at(link.name), what));
    }
    return Inertia(i.mass, {}, moments).InvXform(to_pose(i.origin));
  }

  Expected<Model> model() {
    for (const int link : add_armatures(links_)) {
      const auto i = static_cast<std::size_t>(link);
      notes_.push_back(urdf_note(link_lines_[i],
                                 "the joint above this link moves no mass in some direction, and "
                                 "is given an armature; better give the link, or one after it, an "
                                 "<inertial>"));
    }
    ModelBuilder builder;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (const auto added = builder.add(std::move(links_[i])); !added) {
        return tl::make_unexpected(urdf_error(link_lines_[i], added.error().message));
      }
    }
    auto model = builder.build();
    if (!model) {
      return tl::make_unexpected(
          urdf_error(1,
                     "no joint of the robot moves, so that it has no dynamics; load it with "
                     "UrdfBase::floating, or take bodies in its place"));
    }
    return model;
  }
  int order(const PendingJoint& waiting) const {
    return lines_.joints.at(waiting.joint->name).order;
  }

  void joint(const urdf::Joint& joint, int parent, const urdf::Link& child) {
    LinkSpec spec;
    spec.parent = parent;
    spec.joint = to_joint(joint);
    spec.T_parent_joint = to_pose(joint.parent_to_joint_origin_transform);
    if (joint.dynamics) spec.damping = joint.dynamics->damping;
    const Vec3 axis = to_vec3(joint.axis);
    joints_.push_back(to_urdf_joint(joint, static_cast<int>(links_.size()),
                                    lines_.joints.at(joint.name).mimic_line != 0));
    spec.forces = to_forces(joints_.back(), velocities_of(spec.joint));
    if (joint.type == urdf::Joint::PLANAR && !(axis.x == 0.0 && axis.y == 0.0 && axis.z > 0.0)) {
      // The plane's frame is rotated relative to the link's frame; a fixed joint rotates back.
      const Mat3 Q = frame_of_plane(axis);
      spec.T_parent_joint = spec.T_parent_joint * SE3(Q, {});
      const int plane = add(std::move(spec), lines_.joints.at(joint.name).line);
      spec = {};
      spec.parent = plane;
      spec.T_parent_joint = SE3(transpose(Q), {});
    }
    add(std::move(spec), child);
  }

  // q - multiplier * q of the other joint = offset.
  std::vector<ConstraintPtr> couplings(const Model& model) {
    std::map<std::string_view, int> links;
    for (const UrdfJoint& joint : joints_) links[joint.name] = joint.link;
    std::vector<ConstraintPtr> out;
    for (UrdfJoint& joint : joints_) {
      if (joint.mimics.empty()) continue;
      const int other = links.at(joint.mimics);
      if (coordinates_of(model.link(joint.link).joint) != 1 ||
          coordinates_of(model.link(other).joint) != 1) {
        notes_.push_back(urdf_note(
            lines_.joints.at(joint.name).mimic_line,
            "what joint \"" + joint.name + "\" mimics is left out: both need one coordinate"));
        joint.mimics.clear();
        continue;
      }
      out.push_back(couple({{joint.link, 0, 1.0}, {other, 0, -joint.multiplier}}, joint.offset));
    }
    return out;
  }

  const UrdfLines& lines_;
  std::vector<std::string>& notes_;
  std::vector<LinkSpec> links_;
  std::vector<int> link_lines_;
  std::vector<PendingJoint> waiting_;
  std::vector<UrdfJoint> joints_;
  std::vector<UrdfCollision> collisions_;
};

}  // namespace

Expected<UrdfModel> build_urdf(const std::string& text, const UrdfLines& lines,
                               const UrdfOptions& options, std::vector<std::string> notes) {
  const UrdfTree tree(text);
  if (!tree) return tl::make_unexpected(urdf_error(1, "urdfdom refuses it: " + tree.refusal()));
  return Builder(lines, notes).build(tree, options);
}

}  // namespace vp::detail
