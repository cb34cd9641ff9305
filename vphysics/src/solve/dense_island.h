// Solves an island of few rows with its dense matrix W.
//
// With W = J M^-1 J^T, impulses p and speeds u = W p + b, an iteration of projected Gauss-Seidel
// (contact_solver.cpp) costs one line of W per row. It converges slowly where a load passes back
// and forth, as for a ball pinched between a link and the ground: the error may shrink by only
// 0.5 % per iteration. So a Newton step precedes an iteration. It solves all rows within their
// bounds together,
//     (W + S + e D) dp = target - u - S p,     S: softness, D: the diagonal of W,
// and rows that slide or roll at their bounds by their own equation (Equation). e is small: it only
// regularizes directions in which no row changes speed, since contacts have more rows than their
// bodies have degrees of freedom. The impulses are then projected onto their bounds. The step is
// halved until the error decreases. If no fraction decreases it, plain iterations continue for a
// while, and e grows.
//
// Sources: Alart and Curnier 1991 for Newton's method on contacts with friction; Parikh and Boyd
// 2014 for the term e D, the proximal point method.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solve/dense_matrix.h"

namespace vp::solve {

class DenseIsland {
 public:
  static constexpr std::uint32_t kMaxRows = kMaxDenseRows;

  // Precondition: the rows are prepared. Writes their matrix into the scratch memory.
  DenseIsland(const StepContext& context, const Islands& islands, const Island& island,
              DenseScratch& scratch);
  // Starts from the current velocities; writes the resulting impulses and velocities.
  void iterate(int iterations);

 private:
  using Rows = std::array<double, kMaxRows>;
  // The rows of one contact, in order: normal and tangents of each point, then three more if it
  // resists rolling.
  struct Contact {
    ContactConstraint* constraint;
    std::uint32_t row;
    std::uint32_t row_of_rolling() const {
      return row + 3 * static_cast<std::uint32_t>(constraint->count);
    }
    bool rolls() const { return constraint->rolling_mass > 0.0; }
  };

  void read();
  void write();
  void change(std::uint32_t row, double by);
  double eliminate(bool forward);
  double joint_after(std::uint32_t row) const;
  double normal_after(const ContactPoint& p, std::uint32_t row) const;
  void solve_rolling(const Contact& contact);
  void solve_friction(const ContactConstraint& c, const ContactPoint& p, std::uint32_t row);
  double load(const Contact& contact) const;
  double load() const;
  // Rows of friction (two) or of rolling resistance (three) with |p| <= friction * load. The load
  // is the sum of some normal impulses, three rows apart.
  struct Disc {
    std::uint32_t row, size;
    std::uint32_t first_normal, normals;
    double friction, mass;
    double speed[3];
    bool is_pressed_by(std::uint32_t normal) const {
      if (normal < first_normal) return false;
      const std::uint32_t from = normal - first_normal;
      return from < 3 * normals && from % 3 == 0;
    }
    bool has(std::uint32_t other) const { return other >= row && other - row < size; }
  };
  // One row of the Newton step. A sliding row follows its disc: along the direction d of q = p - m
  // u, with u the speeds and m the mass,
  //     p = mu p_n q / |q|.
  // Its derivative uses d(q / |q|) = P (dp - m du) / |q|, with P the projection perpendicular to d.
  struct Equation {
    std::uint32_t row;
    Disc disc;  // of a sliding row; else empty
    double direction[3];
    double turning;   // mu p_n / |q|
    double softness;  // of a joint; for a sliding row 1 / m, by which its equation is multiplied
    double error;     // right-hand side
  };
  bool step();
  bool solve_directly();
  void go(double fraction);
  double error() const;
  void find_equations();
  void add_equation(std::uint32_t row, double error, double softness);
  void add_disc(const Disc& disc, double load);
  void write_equation(std::size_t i, double* A) const;
  void project(Rows& impulses) const;
  void forget();
  double fastest() const;
  double fastest_target() const;

  const StepContext& s_;
  std::span<const std::uint32_t> joints_;
  const double* W_ = nullptr;
  std::size_t stride_;
  std::vector<double>& factor_;
  double at_bound_ = 0.0;  // e
  double max_ = 0.0;       // the maximum change of speed by change()
  std::uint32_t size_ = 0, contact_count_ = 0;
  std::uint32_t free_count_ = 0, symmetric_count_ = 0, sliding_count_ = 0;
  std::array<Contact, kMaxRows / 3 + 1> contacts_;
  std::array<std::uint32_t, kMaxRows> free_;
  std::array<Equation, kMaxRows> equations_;  // one per free row
  std::array<Equation, kMaxRows> sliding_;    // sliding rows, appended last
  Rows u_, p_, start_, step_;                 // step_: the right-hand sides, then the solution
};

}  // namespace vp::solve
