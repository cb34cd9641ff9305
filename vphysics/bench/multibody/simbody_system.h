// An interface to Simbody that uses plain numbers only: its headers do not compile as C++20, and
// ours require C++20.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace vp::bench {

// In Simbody's convention: a free body has its quaternion (w, x, y, z), then its position; its
// velocity is angular, then linear, in world axes.
class SimbodySystem {
 public:
  struct Body {
    int parent;                                     // or -1
    bool free;                                      // else a pin about the axis
    std::array<std::array<double, 3>, 3> rotation;  // of the joint in the parent's frame, by rows
    std::array<double, 3> position, axis;
    double mass;
    std::array<double, 3> centre;
    std::array<double, 6> inertia;  // about the body's origin: xx, yy, zz, xy, xz, yz
  };

  SimbodySystem(const std::vector<Body>& bodies, const std::array<double, 3>& gravity);
  ~SimbodySystem();
  void add_state(const std::vector<double>& q, const std::vector<double>& v,
                 const std::vector<double>& tau, const std::vector<double>& a);

  // Each returns a number of its result. The result is valid until the next call.
  double forward(std::size_t state);
  double inverse(std::size_t state);
  double mass(std::size_t state);
  std::vector<double> vector() const;  // result of forward or inverse
  std::vector<double> matrix() const;  // result of mass, by rows

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace vp::bench
