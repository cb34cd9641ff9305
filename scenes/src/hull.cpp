// The convex hull of a few points, by brute force over the planes through every three of them.
#include <algorithm>
#include <cmath>

#include "scenes/scene.h"

namespace scenes {
namespace {

constexpr double kFlat = 1e-9;  // of the extent: points farther from a plane are not on it

double extent_of(const std::vector<Vec3>& points) {
  double largest = 0.0;
  for (const Vec3& p : points) largest = std::max(largest, norm(p - points[0]));
  return largest;
}

// The corners of the convex hull of points on a plane, counter-clockwise about the normal: gift
// wrapping (Jarvis, 1973).
std::vector<int> ring_of(const std::vector<Vec3>& points, const std::vector<int>& on_plane,
                         const Vec3& normal, double tolerance) {
  const auto at = [&](int i) { return points[static_cast<std::size_t>(i)]; };
  // The farthest point along an edge direction is a corner.
  const Vec3 along = at(on_plane[1]) - at(on_plane[0]);
  const Vec3 across = cross(normal, along);
  const int first = *std::max_element(on_plane.begin(), on_plane.end(), [&](int i, int j) {
    const double a = dot(along, at(i)), b = dot(along, at(j));
    if (std::fabs(a - b) > tolerance * norm(along)) return a < b;
    return dot(across, at(i)) < dot(across, at(j));
  });
  std::vector<int> ring;
  int from = first;
  do {
    ring.push_back(from);
    int next = from;
    for (const int i : on_plane) {
      if (i == from) continue;
      if (next == from) {
        next = i;
        continue;
      }
      const Vec3 edge = at(next) - at(from), other = at(i) - at(from);
      const double right = dot(normal, cross(other, edge));  // > 0: i is right of the edge
      const double flat = tolerance * norm(edge);
      if (right > flat || (right >= -flat && norm(other) > norm(edge))) next = i;
    }
    from = next;
  } while (from != first && ring.size() <= on_plane.size());
  return ring;
}

}  // namespace

Hull hull_of(std::vector<Vec3> points) {
  const int count = static_cast<int>(points.size());
  const double tolerance = kFlat * extent_of(points);
  const auto at = [&](int i) { return points[static_cast<std::size_t>(i)]; };
  Polyhedron out;
  const auto add_face = [&](int i, int j, int k) {
    Vec3 normal = cross(at(j) - at(i), at(k) - at(i));
    const double size = norm(normal);
    if (size <= tolerance * norm(at(j) - at(i))) return;
    normal = (1.0 / size) * normal;
    const double offset = dot(normal, at(i));
    std::vector<int> on_plane;
    for (int m = 0; m < count; ++m) {
      const double beyond = dot(normal, at(m)) - offset;
      if (beyond > tolerance) return;
      if (beyond >= -tolerance) on_plane.push_back(m);
    }
    // Adds each face once: for the first three of its points in order.
    const bool first_three = on_plane[0] == std::min({i, j, k});
    if (!first_three) return;
    for (const Polyhedron::Face& face : out.faces) {
      if (dot(face.normal, normal) > 1.0 - 1e-9 && std::fabs(face.offset - offset) <= tolerance)
        return;
    }
    out.faces.push_back({normal, offset, ring_of(points, on_plane, normal, tolerance)});
  };
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      for (int k = j + 1; k < count; ++k) {
        add_face(i, j, k);
        add_face(i, k, j);
      }
    }
  }
  // Removes points that belong to no face.
  std::vector<int> renamed(points.size(), -1);
  for (Polyhedron::Face& face : out.faces) {
    for (int& corner : face.corners) {
      int& name = renamed[static_cast<std::size_t>(corner)];
      if (name < 0) {
        name = static_cast<int>(out.points.size());
        out.points.push_back(at(corner));
      }
      corner = name;
    }
  }
  return {std::make_shared<const Polyhedron>(std::move(out))};
}

}  // namespace scenes
