#include "solve/dense_matrix.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "solve/dense_passes.h"
#include "solve/fours.h"
#include "solve/impulses.h"

namespace vp::solve {
namespace {

// y of a free body's rows, with (y, y') the response of one row to another. An impulse f through
// the centre of mass and a moment m about it give f / sqrt(mass) and L^T m, with L L^T the inverse
// inertia.
class BodyAnswer {
 public:
  static constexpr std::size_t kSize = 8;  // six numbers and two zeros

  explicit BodyAnswer(const SolverBody& body) : linear_(std::sqrt(body.inverse_mass)) {
    const Sym3& A = body.angular;
    xx_ = root(A.xx);
    yx_ = quotient(A.xy, xx_);
    zx_ = quotient(A.zx, xx_);
    yy_ = root(A.yy - yx_ * yx_);
    zy_ = quotient(A.yz - zx_ * yx_, yy_);
    zz_ = root(A.zz - zx_ * zx_ - zy_ * zy_);
  }
  void add(const Vec3& f, const Vec3& m, double* y) const {
    y[0] += linear_ * f.x;
    y[1] += linear_ * f.y;
    y[2] += linear_ * f.z;
    y[3] += xx_ * m.x + yx_ * m.y + zx_ * m.z;
    y[4] += yy_ * m.y + zy_ * m.z;
    y[5] += zz_ * m.z;
  }

 private:
  static double root(double square) { return square > 0.0 ? std::sqrt(square) : 0.0; }
  static double quotient(double a, double b) { return b > 0.0 ? a / b : 0.0; }
  double linear_, xx_, yx_, zx_, yy_, zy_, zz_;
};

void add_rows_of_body(const SolverBody& body, const ContactConstraint& c, bool is_a, double* y) {
  const BodyAnswer answer(body);
  const double sign = is_a ? -1.0 : 1.0;
  for (int i = 0; i < c.count; ++i) {
    const Vec3& arm = is_a ? c.points[i].arm_a : c.points[i].arm_b;
    for (const Vec3* d : {&c.normal, &c.tangent[0], &c.tangent[1]}) {
      answer.add(sign * *d, sign * cross(arm, *d), y);
      y += BodyAnswer::kSize;
    }
  }
  if (c.rolling <= 0.0) return;
  for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    answer.add({}, sign * d, y);
    y += BodyAnswer::kSize;
  }
}

void add_rows_of_links(const LinkSide& side, int rows, std::size_t size, double* y) {
  for (int r = 0; r < rows; ++r, y += size) {
    const double* from = side.row(r);
    for (std::uint32_t k = 0, d = side.first; k < side.depth; ++k, d = side.next[d]) {
      y[d] += from[k];
    }
  }
}

// Whether an impulse of the contact acts on the articulation through this body.
bool is_of(const StepContext& s, std::uint32_t body, const LinkSide& side,
           std::uint32_t articulation) {
  return side.depth > 0 && s.bodies[body].articulation == static_cast<int>(articulation);
}

// Assembles W: each body or articulation adds Y Y^T, with Y the matrix of the rows that act on it.
class Assembly {
 public:
  Assembly(const StepContext& s, const Islands& islands, const Island& island,
           DenseScratch& scratch)
      : s_(s),
        joints_(islands.joints(island)),
        contacts_(islands.contacts(island)),
        scratch_(scratch),
        n_(island.rows),
        stride_(in_fours(n_)),
        W_(scratch.matrix.data()) {}

  void run() {
    list_ends();
    auto& ends = scratch_.ends;
    for (std::size_t begin = 0, end = 0; begin < ends.size(); begin = end) {
      const MovingBodyKey key = ends[begin].mover;
      while (end < ends.size() && ends[end].mover == key) ++end;
      add_moving_body(key, std::span(ends).subspan(begin, end - begin));
    }
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t j = 0; j < i; ++j) W_[j * stride_ + i] = W_[i * stride_ + j];
    }
  }

 private:
  // Lists the bodies and articulations that each joint row and each contact acts on.
  void list_ends() {
    auto& ends = scratch_.ends;
    ends.clear();
    std::uint32_t row = 0;
    for (const std::uint32_t j : joints_) {
      const JointRow& joint = s_.joints[j];
      const auto add = [&](MovingBodyKey mover) { ends.push_back({mover, row, kNoContact}); };
      if (joint.pair == kNoPair) {
        add(key_of_articulation(joint.articulation));
      } else {
        for_moving_bodies(s_, s_.pairs[joint.pair], add);
      }
      ++row;
    }
    for (const std::uint32_t k : contacts_) {
      const ContactConstraint& c = s_.contacts[k];
      for_moving_bodies(s_, c, [&](MovingBodyKey mover) { ends.push_back({mover, row, k}); });
      row += static_cast<std::uint32_t>(rows_of(c));
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  }

  void add_moving_body(MovingBodyKey key, std::span<const DenseEnd> ends) {
    const bool is_body = key < key_of_articulation(0);
    const auto mover = static_cast<std::uint32_t>(key);
    size_ = is_body ? BodyAnswer::kSize : in_fours(s_.articulations[mover].factor->dofs());
    scratch_.rows.clear();
    std::size_t rows = 0;
    for (const DenseEnd& end : ends) {
      const bool of_joint = end.contact == kNoContact;
      rows += of_joint ? 1 : static_cast<std::size_t>(rows_of(s_.contacts[end.contact]));
    }
    scratch_.answers.assign(rows * size_, 0.0);
    for (const DenseEnd& end : ends) {
      if (end.contact == kNoContact) {
        add_joint(s_.joints[joints_[end.row]], is_body, mover, append(end.row, 1));
        continue;
      }
      const ContactConstraint& c = s_.contacts[end.contact];
      const int count = rows_of(c);
      double* const y = append(end.row, count);
      if (is_body) {
        if (c.moves_a && c.a == mover) add_rows_of_body(s_.bodies[c.a], c, true, y);
        if (c.moves_b && c.b == mover) add_rows_of_body(s_.bodies[c.b], c, false, y);
      } else {
        if (is_of(s_, c.a, c.side_a, mover)) add_rows_of_links(c.side_a, count, size_, y);
        if (is_of(s_, c.b, c.side_b, mover)) add_rows_of_links(c.side_b, count, size_, y);
      }
    }
    add_products();
  }

  void add_joint(const JointRow& row, bool is_body, std::uint32_t mover, double* y) const {
    if (row.pair == kNoPair) return add_rows_of_links(row.side, 1, size_, y);
    const JointPair& pair = s_.pairs[row.pair];
    for (const PairEnd* end : {&pair.a, &pair.b}) {
      if (!is_body) {
        if (is_of(s_, end->body, end->side, mover)) add_rows_of_links(end->side, 1, size_, y);
      } else if (end->moves && end->body == mover) {
        BodyAnswer(s_.bodies[mover]).add(end->linear, end->angular, y);
      }
    }
  }

  // Appends `count` consecutive rows and returns their y, initially zero.
  double* append(std::uint32_t first, int count) {
    const std::size_t before = scratch_.rows.size();
    for (int r = 0; r < count; ++r) scratch_.rows.push_back(first + static_cast<std::uint32_t>(r));
    return scratch_.answers.data() + before * size_;
  }

  // Adds to the lower half only: the rows ascend. Most entries of a y are zero: links of different
  // branches share only the degrees of freedom that support both.
  void add_products() {
    const std::size_t n = scratch_.rows.size(), numbers = size_ * in_fours(n);
    if (scratch_.columns.size() < numbers) scratch_.columns.resize(numbers);
    dense_passes().add_products({scratch_.answers.data(), n, size_, scratch_.rows.data(),
                                 scratch_.columns.data(), W_, stride_});
  }

  static constexpr std::uint32_t kNoContact = 0xffffffffu;

  const StepContext& s_;
  std::span<const std::uint32_t> joints_, contacts_;
  DenseScratch& scratch_;
  std::size_t n_, stride_, size_ = 0;  // size_: the length of a y of the current unit
  double* W_;
};

}  // namespace

void write_dense_matrix(const StepContext& s, const Islands& islands, const Island& island,
                        DenseScratch& scratch) {
  scratch.matrix.assign(island.rows * in_fours(island.rows), 0.0);
  Assembly(s, islands, island, scratch).run();
}

}  // namespace vp::solve
