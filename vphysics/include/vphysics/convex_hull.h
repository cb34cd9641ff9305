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
  // Maximum number of vertices, 4 to 256. If there are more, the hull keeps those that protrude the
  // farthest. What it cuts off is thinner than the next vertex would protrude. The cost of a
  // contact grows with the number of vertices.
  int max_vertices = 64;
  // A vertex or an edge that protrudes by less than this becomes part of one face. Fraction of the
  // points' largest extent, in [0, 0.01]. The engine limits it to a hundredth of the hull's
  // thickness.
  double tolerance = 1e-5;
};

// The convex hull of a set of points. A handle: copies share the same constant data. Any number of
// colliders, worlds and threads may use it.
//
// The same points and options give the same hull bit for bit, in any order of the points.
class ConvexHull {
 public:
  struct Face {
    Vec3 normal;    // unit, outward
    double offset;  // no vertex is farther along the normal [m]
    // Vertex indices, counter-clockwise seen from outside, starting with the lowest. The vertices
    // lie in the face's plane to within the tolerance.
    std::span<const std::uint16_t> vertices;
  };

  // Interior, duplicate, coplanar, collinear and nearly degenerate points are valid: exact integer
  // arithmetic handles them. Errors: points that are not finite or beyond 1e9 m; an extent below
  // 1e-6 m; a set without volume: fewer than four distinct points, collinear points, coplanar
  // points, or a body thinner than a millionth of its extent.
  [[nodiscard]] static Expected<ConvexHull> of(std::span<const Vec3> points,
                                               const HullOptions& options = {});

  // Precondition of all functions below: not moved from.
  std::span<const Vec3> vertices() const;  // a subset of the given points, in lexicographic order
  std::span<const Face> faces() const;
  double volume() const;                  // [m^3], > 0
  Vec3 centre_of_mass() const;            // of uniform density
  Inertia inertia(double density) const;  // [kg/m^3]; about the origin of the points' frame

  // For the engine. Null if moved from.
  const std::shared_ptr<const collide::HullData>& data() const { return data_; }

 private:
  explicit ConvexHull(std::shared_ptr<const collide::HullData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collide::HullData> data_;
};

}  // namespace vp
