// The convex hull of points on an integer grid, as triangles, computed exactly.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace vp::collide {

// Each coordinate in [0, 2^40].
struct GridPoint {
  std::int64_t x, y, z;
};

inline constexpr int kGridBits = 40;

using Triangle = std::array<std::uint32_t, 3>;  // point indices, counter-clockwise from outside

struct Quickhull {
  enum class Result : std::uint8_t { hull, point, line, plane };
  Result result = Result::point;
  double tolerance = 0.0;           // the tolerance used: at most a hundredth of the thickness
  std::vector<Triangle> triangles;  // if result is hull: closed, two triangles share every edge
};

// Keeps at most max_vertices, the farthest first, and drops points that protrude by at most
// tolerance. Points thinner than `thinnest` form a plane, a line or a point. Both in grid cells.
Quickhull quickhull(std::span<const GridPoint> points, int max_vertices, double tolerance,
                    double thinnest);

}  // namespace vp::collide
