#include "measure_hull.h"

#include <algorithm>
#include <cmath>

namespace scenes {

Polyhedron box_polyhedron(const Vec3& half_extents) {
  Polyhedron out;
  for (int corner = 0; corner < 8; ++corner) {
    out.points.push_back({corner & 1 ? half_extents.x : -half_extents.x,
                          corner & 2 ? half_extents.y : -half_extents.y,
                          corner & 4 ? half_extents.z : -half_extents.z});
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int x = 1 << axis, y = 1 << (axis + 1) % 3, z = 1 << (axis + 2) % 3;
    Vec3 normal;
    normal[axis] = 1.0;
    out.faces.push_back({normal, half_extents[axis], {x, x | y, x | y | z, x | z}});
    out.faces.push_back({-normal, half_extents[axis], {0, z, y | z, y}});
  }
  return out;
}

double triangle_distance(const Vec3 (&corners)[3], const Vec3& p) {
  const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vec3 &from = corners[i], edge = corners[(i + 1) % 3] - from;
    inside = inside && dot(cross(edge, p - from), normal) >= 0.0;
    const double along = std::clamp(dot(p - from, edge) / dot(edge, edge), 0.0, 1.0);
    nearest = std::min(nearest, norm(p - from - along * edge));
  }
  return inside ? std::fabs(dot(normal, p - corners[0])) / norm(normal) : nearest;
}

double depth_in(const Polyhedron& hull, const Vec3& p) {
  double min = std::numeric_limits<double>::infinity();
  for (const Polyhedron::Face& face : hull.faces) {
    min = std::min(min, face.offset - dot(face.normal, p));
  }
  return min;
}

double hull_distance(const Polyhedron& hull, const Vec3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (const Polyhedron::Face& face : hull.faces) {
    if (dot(face.normal, p) <= face.offset) continue;
    inside = false;
    const auto at = [&](std::size_t k) {
      return hull.points[static_cast<std::size_t>(face.corners[k])];
    };
    for (std::size_t k = 2; k < face.corners.size(); ++k) {
      nearest = std::min(nearest, triangle_distance({at(0), at(k - 1), at(k)}, p));
    }
  }
  return inside ? 0.0 : nearest;
}

double hulls_penetration(const Polyhedron& a, const SE3& T_world_a, const Polyhedron& b,
                         const SE3& T_world_b) {
  double deepest = -std::numeric_limits<double>::infinity();
  const SE3 T_b_a = Inv(T_world_b) * T_world_a, T_a_b = Inv(T_b_a);
  for (const Vec3& p : a.points) deepest = std::max(deepest, depth_in(b, T_b_a * p));
  for (const Vec3& p : b.points) deepest = std::max(deepest, depth_in(a, T_a_b * p));
  return deepest;
}

MeshGrid::MeshGrid(const Triangles& mesh) : mesh_(&mesh) {
  lower_ = upper_ = mesh.vertices[0];
  for (const Vec3& v : mesh.vertices) {
    for (int i = 0; i < 3; ++i) {
      lower_[i] = std::min(lower_[i], v[i]);
      upper_[i] = std::max(upper_[i], v[i]);
    }
  }
  // About two triangles a cell.
  const double x = std::max(upper_.x - lower_.x, 1e-9), y = std::max(upper_.y - lower_.y, 1e-9);
  const double squares = 0.5 * static_cast<double>(mesh.corners.size());
  const double size = std::max({std::sqrt(x * y / squares), 1e-3 * x, 1e-3 * y});
  columns_ = 1 + static_cast<int>(x / size);
  rows_ = 1 + static_cast<int>(y / size);
  vertices_ = sorted(mesh.vertices.size(), [&](std::size_t i, Vec3& lower, Vec3& upper) {
    lower = upper = mesh.vertices[i];
  });
  triangles_ = sorted(mesh.corners.size(), [&](std::size_t i, Vec3& lower, Vec3& upper) {
    lower = upper = mesh.vertices[mesh.corners[i][0]];
    for (const std::uint32_t corner : mesh.corners[i]) {
      const Vec3& v = mesh.vertices[corner];
      lower = {std::min(lower.x, v.x), std::min(lower.y, v.y), 0.0};
      upper = {std::max(upper.x, v.x), std::max(upper.y, v.y), 0.0};
    }
  });
}

int MeshGrid::column(double x) const {
  const double share = (x - lower_.x) / std::max(upper_.x - lower_.x, 1e-9);
  return std::clamp(static_cast<int>(std::floor(share * columns_)), 0, columns_ - 1);
}
int MeshGrid::row(double y) const {
  const double share = (y - lower_.y) / std::max(upper_.y - lower_.y, 1e-9);
  return std::clamp(static_cast<int>(std::floor(share * rows_)), 0, rows_ - 1);
}

template <class BoundsOf>
MeshGrid::Cells MeshGrid::sorted(std::size_t count, const BoundsOf& bounds_of) const {
  Cells cells;
  cells.starts.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  const auto each = [&](const auto& f) {
    for (std::size_t i = 0; i < count; ++i) {
      Vec3 lower, upper;
      bounds_of(i, lower, upper);
      for (int r = row(lower.y); r <= row(upper.y); ++r) {
        for (int c = column(lower.x); c <= column(upper.x); ++c) {
          f(static_cast<std::size_t>(r * columns_ + c), static_cast<std::uint32_t>(i));
        }
      }
    }
  };
  each([&](std::size_t cell, std::uint32_t) { ++cells.starts[cell + 1]; });
  for (std::size_t k = 1; k < cells.starts.size(); ++k) cells.starts[k] += cells.starts[k - 1];
  cells.items.resize(cells.starts.back());
  std::vector<std::uint32_t> next = cells.starts;
  each([&](std::size_t cell, std::uint32_t i) { cells.items[next[cell]++] = i; });
  return cells;
}

// Of triangles at the same distance, as at a common edge, the one whose plane is farther from the
// point decides on which side the point is.
double MeshGrid::behind(const Vec3& p, double reach) const {
  const Vec3 around{reach, reach, reach};
  double nearest = reach, off_plane = 0.0, sign = 0.0;
  visit(triangles_, p - around, p + around, [&](std::uint32_t i) {
    const auto& [a, b, c] = mesh_->corners[i];
    const Vec3 corners[3] = {mesh_->vertices[a], mesh_->vertices[b], mesh_->vertices[c]};
    const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double plane = dot(normal, p - corners[0]) / norm(normal);
    if (std::fabs(plane) > nearest + 1e-9) return;
    const double distance = triangle_distance(corners, p);
    const bool same = std::fabs(distance - nearest) <= 1e-9 && sign != 0.0;
    if (same ? std::fabs(plane) <= off_plane : distance >= nearest) return;
    nearest = std::min(nearest, distance);
    off_plane = std::fabs(plane);
    sign = plane < 0.0 ? 1.0 : -1.0;
  });
  return sign == 0.0 ? -kFar : sign * nearest;
}

}  // namespace scenes
