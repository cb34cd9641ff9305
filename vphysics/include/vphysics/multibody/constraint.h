// Constraints between the links of a tree: closed loops, couplings, and one's own.
//
//   phi(q) = 0         residual, one number a row
//   phi' = J(q) v      J: Jacobian, rows x velocities
//   phi'' = J a + b    b: bias, (dJ/dt) v
//
// A constraint of one's own is a class derived from Constraint, in one's own source file. It may be
// used by any number of models, sets and threads.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "vphysics/error.h"
#include "vphysics/multibody/data.h"

namespace vp {

// What a constraint fills in. All is zero at first.
struct ConstraintRows {
  std::span<double> residual, bias;  // one a row
  std::span<double> jacobian;        // row by row
  // Of each row, the largest term in any of its sums. Below 1e-11 of it the row counts as zero:
  // links that another joint keeps together already, or a plane that they cannot leave. Left at
  // zero, only a row of zeros is zero. ConstraintView::add keeps it.
  std::span<double> magnitude;
  std::size_t velocities;

  std::span<double> row(std::size_t i) const {
    return jacobian.subspan(i * velocities, velocities);
  }
};

// A configuration and its velocities, as a constraint sees them. A link may be kWorld: its frame is
// the world's, and it rests.
class ConstraintView {
 public:
  ConstraintView(const Model& model, const Data& data, std::span<const double> q,
                 std::span<const double> v, std::span<const se3> bias)
      : model_(model), data_(data), q_(q), v_(v), bias_(bias) {}

  const Model& model() const { return model_; }
  std::span<const double> q() const { return q_; }
  std::span<const double> v() const { return v_; }
  SE3 T_world_link(int link) const;
  // Of link b in the frame of link a; exact however far both are from the world's origin.
  SE3 T_between(int a, int b) const;
  // In the link's frame: its velocity V, and V's rate while no joint's velocity changes.
  se3 velocity(int link) const;
  se3 bias(int link) const;
  // Adds to row i of the Jacobian the row that takes v to <F, V>; F in the link's frame.
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
  virtual int rows() const = 0;  // 1 or more, the same always
  // Whether it can be used with the model: whether the links are there, the numbers finite.
  virtual Expected<void> check(const Model& model) const;
  // Called without allocating. Rows that depend on others are fine. A residual of rotations must
  // not vanish where the constraint does not hold.
  virtual void evaluate(const ConstraintView& at, const ConstraintRows& out) const = 0;
};

using ConstraintPtr = std::shared_ptr<const Constraint>;

// A frame on a link, or in the world.
struct Attachment {
  int link = kWorld;
  SE3 T_link_frame{};
};

// Loop closures, as if a joint connected the two frames. Residuals are in metres and radians.
//
// A ball: the origins coincide. 3 rows.
ConstraintPtr close_ball(const Attachment& a, const Attachment& b);
// A hinge: the origins and the z axes coincide. 5 rows, the last two 2 tan(angle / 2) between the
// axes, about x and y; not for frames that start opposite.
ConstraintPtr close_hinge(const Attachment& a, const Attachment& b);
// Welded: the frames coincide. 6 rows, Log(T_a_b), angular first; not for frames half a turn apart.
ConstraintPtr close_weld(const Attachment& a, const Attachment& b);
// A bar between the two origins. One row, (d^2 - length^2) / (2 length), which is d - length to
// first order. Precondition: length > 0.
ConstraintPtr keep_distance(const Attachment& a, const Attachment& b, double length);

// Gears, mimic joints, differentials: sum of factor_i q_i = offset, over coordinates of joints that
// are no ball and not free. One row.
struct CoupledCoordinate {
  int link = 0;
  int index = 0;  // among the joint's coordinates
  double factor = 1.0;
};
ConstraintPtr couple(std::vector<CoupledCoordinate> coordinates, double offset = 0.0);

// Constraints that have been found to fit a model.
class ConstraintSet {
 public:
  // Refused: a constraint that is null, has no rows, or does not pass its own check().
  static Expected<ConstraintSet> make(const Model& model, std::vector<ConstraintPtr> constraints);

  int rows() const { return rows_; }
  std::span<const ConstraintPtr> constraints() const { return constraints_; }

 private:
  std::vector<ConstraintPtr> constraints_;
  int rows_ = 0;
};

}  // namespace vp
