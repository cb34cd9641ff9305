// An island of few rows, solved with the matrix of how each row answers each.
//
// With W = J M^-1 J^T, impulses p and speeds u = W p + b, a round of projected Gauss-Seidel
// (contact_solver.cpp) costs a line of W for each row. A load that is handed to and fro, as of a
// ball pinched between a man and the field, settles slowly in rounds: from one to the next by as
// little as 0.5 %. So before a round comes a step of Newton's method: the rows that are within
// their bounds are set right together,
//     (W + S + e D) dp = target - u - S p,     S: softness, D: the diagonal of W,
// those that slide or roll at their bounds by their own law (Equation). e is small, so that only
// what no row feels is held where it is: contacts have more rows than their bodies can answer. The
// impulses are put back into their bounds; the step is halved until the rows are less wrong than
// they were, and where that does not help, rounds go on alone for a while, and e grows.
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

  // Prepared rows, whose matrix it writes into the scratch.
  DenseIsland(const StepContext& context, const Islands& islands, const Island& island,
              DenseScratch& scratch);
  // From the velocities of now; impulses and velocities are then those of the end.
  void iterate(int iterations);

 private:
  using Rows = std::array<double, kMaxRows>;
  // The rows of one contact, which follow one another: normal and tangents of each point, and
  // where it resists rolling three more.
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
  // Rows of friction, two of them, or of what resists rolling, three: |p| <= friction * load, the
  // load being that of some normals, three rows apart.
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
  // Of a row that Newton's step sets right. What slides does so as its disc has it: along the
  // direction d of q = p - m u, u the speeds and m the mass,
  //     p = mu p_n q / |q|,   derived by p, with dq / |q| = P (dp - m du) / |q| across d.
  struct Equation {
    std::uint32_t row;
    Disc disc;  // of what slides; else of no rows
    double direction[3];
    double turning;   // mu p_n / |q|
    double softness;  // of a joint; of what slides 1 / m, by which its equation is multiplied
    double error;     // its right side
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
  double max_ = 0.0;       // of what change() has changed speeds by
  std::uint32_t size_ = 0, contact_count_ = 0;
  std::uint32_t free_count_ = 0, symmetric_count_ = 0, sliding_count_ = 0;
  std::array<Contact, kMaxRows / 3 + 1> contacts_;
  std::array<std::uint32_t, kMaxRows> free_;
  std::array<Equation, kMaxRows> equations_;  // of each free row
  std::array<Equation, kMaxRows> sliding_;    // those that will be its last
  Rows u_, p_, start_, step_;  // step_: the equations' right sides, then what they are solved by
};

}  // namespace vp::solve
