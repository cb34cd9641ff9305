// Constraints between the links of a tree: closed loops, couplings, and user-defined constraints.
//
//   phi(q) = 0         residual, one number for each row
//   phi' = J(q) v      J: Jacobian, rows x velocities
//   phi'' = J a + b    b: bias, (dJ/dt) v
//
// A user-defined constraint is a class derived from Constraint, in a source file of the user. Any
// number of models, sets and threads may share it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "vphysics/error.h"
#include "vphysics/multibody/data.h"

namespace vp {

// The output of a constraint. All values are zero on entry.
struct ConstraintRows {
  std::span<double> residual, bias;  // one for each row
  std::span<double> jacobian;        // row by row
  // For each row, the largest term in any of its sums. A row below 1e-11 of this magnitude counts
  // as zero: the links are already connected by another joint, or cannot leave a plane. If the
  // magnitude stays at zero, only a row of zeros counts as zero. ConstraintView::add updates it.
  std::span<double> magnitude;
  std::size_t velocities;

  std::span<double> row(std::size_t i) const {
    return jacobian.subspan(i * velocities, velocities);
  }
};

// A configuration and its velocities, as a constraint sees them. A link may be kWorld: the world
// frame, at rest.
class ConstraintView {
 public:
  ConstraintView(const Model& model, const Data& data, std::span<const double> q,
                 std::span<const double> v, std::span<const se3> bias)
      : model_(model), data_(data), q_(q), v_(v), bias_(bias) {}

  const Model& model() const { return model_; }
  std::span<const double> q() const { return q_; }
  std::span<const double> v() const { return v_; }
  SE3 T_world_link(int link) const;
  // Pose of link b in the frame of link a; exact at any distance from the world's origin.
  SE3 T_between(int a, int b) const;
  // In the link's frame: the velocity V, and the rate of V at zero joint accelerations.
  se3 velocity(int link) const;
  se3 bias(int link) const;
  // Adds to row i of the Jacobian the row that maps v to <F, V>; F is in the link's frame.
  void add(const ConstraintRows& out, std::size_t i, int link, const dse3& F) const;

 private:
  const Model& model_;
  const Data& data_;
  std::span<const double> q_, v_;
  std::span<const se3> bias_;
};

class Constraint {
 public:
  virtual ~Constraint() = default;
  virtual int rows() const = 0;  // at least 1, constant
  // Checks the constraint against the model: links exist, numbers are finite.
  virtual Expected<void> check(const Model& model) const;
  // Must not allocate. Rows may depend on others. A residual of rotations must not vanish where the
  // constraint is violated.
  virtual void evaluate(const ConstraintView& at, const ConstraintRows& out) const = 0;
};

using ConstraintPtr = std::shared_ptr<const Constraint>;

// A frame on a link, or in the world.
struct Attachment {
  int link = kWorld;
  SE3 T_link_frame{};
};

// Loop closures, which act as a joint between the two frames. Residuals are in metres and radians.
//
// Ball: the origins coincide. 3 rows.
ConstraintPtr close_ball(const Attachment& a, const Attachment& b);
// Hinge: the origins and the z axes coincide. 5 rows; the last two are 2 tan(angle / 2) between the
// axes, about x and y. Not for frames whose z axes start opposite.
ConstraintPtr close_hinge(const Attachment& a, const Attachment& b);
// Weld: the frames coincide. 6 rows, Log(T_a_b), angular first. Not for frames that differ by a
// rotation of pi.
ConstraintPtr close_weld(const Attachment& a, const Attachment& b);
// Distance: a bar between the two origins. One row, (d^2 - length^2) / (2 length), which is d -
// length to first order. Precondition: length > 0.
ConstraintPtr keep_distance(const Attachment& a, const Attachment& b, double length);

// Gears, mimic joints, differentials: sum of factor_i q_i = offset, over coordinates of joints
// other than ball and free. One row.
struct CoupledCoordinate {
  int link = 0;
  int index = 0;  // among the joint's coordinates
  double factor = 1.0;
};
ConstraintPtr couple(std::vector<CoupledCoordinate> coordinates, double offset = 0.0);

// Constraints that were checked against a model.
class ConstraintSet {
 public:
  // Fails on a constraint that is null, has no rows, or fails its own check().
  static Expected<ConstraintSet> make(const Model& model, std::vector<ConstraintPtr> constraints);

  int rows() const { return rows_; }
  std::span<const ConstraintPtr> constraints() const { return constraints_; }

 private:
  std::vector<ConstraintPtr> constraints_;
  int rows_ = 0;
};

}  // namespace vp
