// Penetration depths of polyhedra and triangle meshes; for measure.cpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "scenes/scene.h"

namespace scenes {

Polyhedron box_polyhedron(const Vec3& half_extents);
// Distance of a point from a triangle: from its plane if the projected point is inside, else from
// the nearest edge.
double triangle_distance(const Vec3 (&corners)[3], const Vec3& p);
// Depth of a point below the nearest face's plane, in the hull's frame. Negative outside, but then
// not always the distance.
double depth_in(const Polyhedron& hull, const Vec3& p);
// Distance of a point from a hull; 0 inside.
double hull_distance(const Polyhedron& hull, const Vec3& p);
// The depth of the deepest corner of one hull in the other.
double hulls_penetration(const Polyhedron& a, const SE3& T_world_a, const Polyhedron& b,
                         const SE3& T_world_b);

// Points with a radius that represent a shape against a mesh: a sphere's centre, the ends of a
// capsule's axis, or corners.
struct Probe {
  std::vector<Vec3> points;  // in the shape's frame
  double radius = 0.0;
  Vec3 centre;         // of the bounding sphere, in the shape's frame
  double reach = 0.0;  // radius of the bounding sphere [m]
};

// Triangles and vertices of a mesh, sorted into the cells of a grid over x and y by their bounds.
class MeshGrid {
 public:
  explicit MeshGrid(const Triangles& mesh);  // the mesh must outlive the grid

  // The largest depth of the probe's points behind their nearest triangle, within the probe's
  // reach, and of the mesh's vertices in the shape, by depth_of(vertex in the shape's frame).
  template <class DepthOf>
  double penetration(const Probe& probe, const SE3& T_mesh_shape, const DepthOf& depth_of) const {
    double deepest = -kFar;
    for (const Vec3& p : probe.points) {
      deepest = std::max(deepest, probe.radius + behind(T_mesh_shape * p, probe.reach));
    }
    const Vec3 at = T_mesh_shape * probe.centre, around{probe.reach, probe.reach, probe.reach};
    visit(vertices_, at - around, at + around, [&](std::uint32_t i) {
      deepest = std::max(deepest, depth_of(inverse_times(T_mesh_shape, mesh_->vertices[i])));
    });
    return deepest;
  }

 private:
  static constexpr double kFar = 1e9;
  // The items of cell k are items[starts[k]] to items[starts[k + 1] - 1].
  struct Cells {
    std::vector<std::uint32_t> starts, items;
  };

  // Depth of a point behind its nearest triangle, negative in front; -kFar if no triangle is within
  // reach.
  double behind(const Vec3& p, double reach) const;
  int column(double x) const;
  int row(double y) const;
  template <class BoundsOf>
  Cells sorted(std::size_t count, const BoundsOf& bounds_of) const;
  template <class F>
  void visit(const Cells& cells, const Vec3& lower, const Vec3& upper, const F& f) const {
    if (upper.x < lower_.x || upper.y < lower_.y || upper.z < lower_.z || lower.x > upper_.x ||
        lower.y > upper_.y || lower.z > upper_.z)
      return;
    for (int j = row(lower.y); j <= row(upper.y); ++j) {
      for (int i = column(lower.x); i <= column(upper.x); ++i) {
        const auto k = static_cast<std::size_t>(j * columns_ + i);
        for (std::uint32_t n = cells.starts[k]; n < cells.starts[k + 1]; ++n) f(cells.items[n]);
      }
    }
  }

  const Triangles* mesh_;
  Vec3 lower_, upper_;
  int columns_ = 1, rows_ = 1;
  Cells triangles_, vertices_;
};

}  // namespace scenes
