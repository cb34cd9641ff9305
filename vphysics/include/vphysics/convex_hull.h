// Convex polyhedra, built from points. Lengths in metres.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "vphysics/error.h"
#include "vphysics/lie.h"

namespace vp {

namespace collide {
struct HullData;
}

struct HullOptions {
  // At most this many corners are kept, 4 to 256: of more, those that stick out the farthest. What
  // is cut off is less than the next one would stick out. A contact's cost grows with the corners.
  int max_vertices = 64;
  // What is flatter than this is smoothed away: a corner or an edge that sticks out less becomes
  // part of one face. Share of the points' largest extent, in [0, 0.01]; never more than a
  // hundredth of the hull's thickness.
  double tolerance = 1e-5;
};

// The smallest convex body that holds a set of points. A handle: copies share the same constant
// data, which may be used by any number of colliders, worlds and threads.
//
// The same points and options give the same hull bit for bit, whatever the points' order.
class ConvexHull {
 public:
  struct Face {
    Vec3 normal;    // unit, outward
    double offset;  // no vertex of the hull lies farther along the normal [m]
    // Corners, counter-clockwise seen from outside, beginning with the lowest index. They lie in
    // the face's plane to within the tolerance.
    std::span<const std::uint16_t> vertices;
  };

  // Any points do: inside, duplicate, coplanar, collinear or nearly so ones are sorted out
  // exactly, in integers. Refused: points that are not finite or beyond 1e9 m, an extent below 1e-6
  // m, and what has no volume: fewer than four different points, points on a line, points in a
  // plane, or a body thinner than a millionth of its extent.
  [[nodiscard]] static Expected<ConvexHull> of(std::span<const Vec3> points,
                                               const HullOptions& options = {});

  // Precondition of all below: not moved from.
  std::span<const Vec3> vertices() const;  // among the points given, in lexicographic order
  std::span<const Face> faces() const;
  double volume() const;                  // [m^3], > 0
  Vec3 centre_of_mass() const;            // of uniform density
  Inertia inertia(double density) const;  // [kg/m^3]; about the origin of the points' frame

  // For the engine; null if moved from.
  const std::shared_ptr<const collide::HullData>& data() const { return data_; }

 private:
  explicit ConvexHull(std::shared_ptr<const collide::HullData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collide::HullData> data_;
};

}  // namespace vp
