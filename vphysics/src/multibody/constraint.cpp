#include "vphysics/multibody/constraint.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "multibody/kinematics.h"
#include "multibody/work.h"
#include "vphysics/multibody/dynamics.h"

namespace vp {
namespace {

tl::unexpected<Error> invalid_constraint(std::string why) {
  return tl::make_unexpected(Error{Errc::invalid_argument, std::move(why)});
}

const detail::LinkFrame<double>& frame_of(const Model& model, int link) {
  return model.tree().frames[static_cast<std::size_t>(link)];
}
// Pose of a link in its tree's frame.
SE3 pose_in_tree(const Data& data, const detail::LinkFrame<double>& frame) {
  return detail::pose_of(data.work(), frame.node) * frame.T_node_link;
}

class Coupling final : public Constraint {
 public:
  Coupling(std::vector<CoupledCoordinate> coordinates, double offset)
      : coordinates_(std::move(coordinates)), offset_(offset) {}

  int rows() const override { return 1; }
  Expected<void> check(const Model& model) const override {
    if (coordinates_.empty()) return invalid_constraint("couple: name one coordinate or more");
    if (!std::isfinite(offset_)) return invalid_constraint("couple: the offset must be finite");
    for (const CoupledCoordinate& c : coordinates_) {
      if (c.link < 0 || c.link >= model.links()) {
        return invalid_constraint("couple: there is no link " + std::to_string(c.link));
      }
      const Joint& joint = model.link(c.link).joint;
      const int count = velocities_of(joint);
      if (coordinates_of(joint) != count || c.index < 0 || c.index >= count) {
        return invalid_constraint("couple: the joint of link " + std::to_string(c.link) +
                                  " has no coordinate " + std::to_string(c.index) +
                                  " whose rate is a velocity");
      }
      if (!std::isfinite(c.factor)) return invalid_constraint("couple: factors must be finite");
    }
    return {};
  }
  void evaluate(const ConstraintView& at, const ConstraintRows& out) const override {
    double sum = -offset_;
    for (const CoupledCoordinate& c : coordinates_) {
      const auto q = static_cast<std::size_t>(at.model().first_coordinate(c.link) + c.index);
      const auto v = static_cast<std::size_t>(at.model().first_velocity(c.link) + c.index);
      sum += c.factor * at.q()[q];
      out.jacobian[v] += c.factor;
    }
    out.residual[0] = sum;
  }

 private:
  std::vector<CoupledCoordinate> coordinates_;
  double offset_;
};

}  // namespace

SE3 ConstraintView::T_world_link(int link) const {
  if (link == kWorld) return {};
  return vp::T_world_link<double>(model_, data_, link);
}

SE3 ConstraintView::T_between(int a, int b) const {
  struct LinkPose {
    SE3 X;
    Vec3 origin;
  };
  const auto find = [&](int link) -> LinkPose {
    if (link == kWorld) return {};
    const auto& frame = frame_of(model_, link);
    if (frame.node == kWorld)
      return {SE3(frame.T_node_link.rotation(), {}), frame.T_node_link.position()};
    return {pose_in_tree(data_, frame), detail::origin_of(data_.work(), frame.node)};
  };
  const LinkPose from = find(a), to = find(b);
  return Inv(from.X) * (SE3(to.origin - from.origin) * to.X);
}

se3 ConstraintView::velocity(int link) const {
  if (link == kWorld) return {};
  return link_velocity<double>(model_, data_, link);
}

se3 ConstraintView::bias(int link) const {
  if (link == kWorld) return {};
  const auto& frame = frame_of(model_, link);
  if (frame.node == kWorld) return {};
  return InvAd(pose_in_tree(data_, frame), bias_[static_cast<std::size_t>(frame.node)]);
}

void ConstraintView::add(const ConstraintRows& out, std::size_t row, int link,
                         const dse3& F) const {
  if (link == kWorld) return;
  const auto& tree = model_.tree();
  const auto& frame = frame_of(model_, link);
  if (frame.node == kWorld) return;
  const dse3 in_tree = InvdAd(pose_in_tree(data_, frame), F);
  const std::span<double> J = out.row(row);
  const double m = norm(in_tree.m), f = norm(in_tree.f);
  for (int i = frame.node; i != kWorld; i = tree.nodes[static_cast<std::size_t>(i)].parent) {
    const auto& node = tree.nodes[static_cast<std::size_t>(i)];
    for (int k = 0; k < node.dofs; ++k) {
      const se3 S = detail::column_of<double>(tree, data_.work(), i, k);
      J[static_cast<std::size_t>(node.v + k)] += S * in_tree;
      out.magnitude[row] = std::max(out.magnitude[row], norm(S.w) * m + norm(S.v) * f);
    }
  }
}

Expected<void> Constraint::check(const Model&) const {
  return {};
}

ConstraintPtr couple(std::vector<CoupledCoordinate> coordinates, double offset) {
  return std::make_shared<Coupling>(std::move(coordinates), offset);
}

Expected<ConstraintSet> ConstraintSet::make(const Model& model,
                                            std::vector<ConstraintPtr> constraints) {
  ConstraintSet set;
  for (const ConstraintPtr& constraint : constraints) {
    if (!constraint) return invalid_constraint("a constraint of the set is null; leave it out");
    const int rows = constraint->rows();
    if (rows < 1 || rows > 10000) {
      return invalid_constraint("a constraint must have 1 to 10000 rows, not " +
                                std::to_string(rows));
    }
    if (auto fits = constraint->check(model); !fits) return tl::make_unexpected(fits.error());
    set.rows_ += rows;
  }
  set.constraints_ = std::move(constraints);
  return set;
}

}  // namespace vp
