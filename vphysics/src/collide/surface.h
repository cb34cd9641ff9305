// A common view of meshes and height fields: triangles, their neighbours, and active edges.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "collide/height_data.h"
#include "collide/mesh_data.h"

namespace vp::collide {

// Scaled, in the surface's frame.
struct SurfaceTriangle {
  std::uint32_t id;
  Vec3 p[3];
  Vec3 normal;               // unit, of the front side
  std::uint32_t corners[3];  // names of vertices
  Vec3 opposite[3];          // the neighbour's third corner across the edge from p[i]
  bool has_opposite[3];
  unsigned active;  // as in MeshData
};

class Surface {
 public:
  Surface(const MeshData& mesh, const Vec3& scale) : mesh_(&mesh), scale_(scale) {}
  Surface(const HeightData& field, const Vec3& scale) : field_(&field), scale_(scale) {}

  bool two_sided() const { return mesh_ != nullptr && mesh_->two_sided; }
  Bounds bounds() const;
  SurfaceTriangle triangle(std::uint32_t id) const;
  void corners(std::uint32_t id, Vec3 p[3]) const;  // of the triangle
  // Appends the triangles whose bounds overlap the box, in ascending order.
  void append_overlapping(const Bounds& box, std::vector<std::uint32_t>& ids) const;
  // Calls found(triangle) for the same triangles, in an order that depends on surface and box
  // alone.
  template <class F>
  void overlapping(const Bounds& box, const F& found) const;
  // Whether the surface around a vertex is below the plane through it that is perpendicular to the
  // unit vector d, up to rounding.
  bool lies_below(std::uint32_t vertex, const Vec3& d) const;

  // Calls hit(triangle, entry) for triangles whose bounds a moving box touches at a fraction of at
  // most limit; hit returns the new limit. In order of entry: of the bounds or, for a height field,
  // of the row of cells.
  template <class F>
  void cast(const Sweep& sweep, double limit, CastScratch& scratch, const F& hit) const;

  // Calls near(triangle) for triangles whose bounds are at most limit [m] from the box; near
  // returns the new limit, which must not exceed the old one.
  template <class F>
  void nearest(const Bounds& box, double limit, CastScratch& scratch, const F& near) const;

 private:
  Vec3 scaled(const Vec3& p) const { return {scale_.x * p.x, scale_.y * p.y, scale_.z * p.z}; }
  Bounds unscaled(const Bounds& b) const;
  SurfaceTriangle of_mesh(std::uint32_t id) const;
  SurfaceTriangle of_field(std::uint32_t id) const;
  template <class F>
  void for_cells(const Bounds& box, const F& found) const;
  template <class F>
  void cast_field(const Sweep& sweep, double limit, const F& hit) const;
  template <class F>
  void nearest_of_field(const Bounds& box, double limit, const F& near) const;

  const MeshData* mesh_ = nullptr;
  const HeightData* field_ = nullptr;
  Vec3 scale_;
};

template <class F>
void Surface::overlapping(const Bounds& box, const F& found) const {
  if (field_ != nullptr) return for_cells(unscaled(box), found);
  mesh_->tree.overlapping(rounded_outward(unscaled(box)), found);
}

// For a height field, unscaled.
template <class F>
void Surface::for_cells(const Bounds& box, const F& found) const {
  const HeightData& f = *field_;
  if (box.upper.z < f.lowest || box.lower.z > f.highest) return;
  const auto cell = [](double x, double spacing, std::uint32_t samples) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(x / spacing), 0.0, samples - 2.0));
  };
  const double width = (f.columns - 1) * f.spacing_x, depth = (f.rows - 1) * f.spacing_y;
  if (box.upper.x < 0.0 || box.upper.y < 0.0 || box.lower.x > width || box.lower.y > depth) return;
  // A box that touches a line between two cells overlaps both: adds a rounding tolerance relative
  // to a cell.
  const double ex = 1e-9 * f.spacing_x, ey = 1e-9 * f.spacing_y;
  const std::uint32_t i0 = cell(box.lower.x - ex, f.spacing_x, f.columns),
                      i1 = cell(box.upper.x + ex, f.spacing_x, f.columns),
                      j0 = cell(box.lower.y - ey, f.spacing_y, f.rows),
                      j1 = cell(box.upper.y + ey, f.spacing_y, f.rows);
  for (std::uint32_t j = j0; j <= j1; ++j) {
    const double* row = &f.heights[std::size_t{j} * f.columns];
    const double* next = row + f.columns;
    for (std::uint32_t i = i0; i <= i1; ++i) {
      if (f.is_hole(i, j)) continue;
      const double l0 = std::min(row[i], next[i + 1]), h0 = std::max(row[i], next[i + 1]);
      const std::uint32_t id = 2 * (j * (f.columns - 1) + i);
      const auto overlaps = [&](double third) {
        return std::min(l0, third) <= box.upper.z && std::max(h0, third) >= box.lower.z;
      };
      if (overlaps(row[i + 1])) found(id);
      if (overlaps(next[i])) found(id + 1);
    }
  }
}

// Visits row after row of cells, along the axis of the larger displacement.
template <class F>
void Surface::cast_field(const Sweep& sweep, double limit, const F& hit) const {
  const HeightData& f = *field_;
  const bool by_columns = std::fabs(sweep.displacement.x) * f.spacing_y >=
                          std::fabs(sweep.displacement.y) * f.spacing_x;
  const int axis = by_columns ? 0 : 1;
  const double spacing = by_columns ? f.spacing_x : f.spacing_y, d = sweep.displacement[axis];
  const std::uint32_t rows = (by_columns ? f.columns : f.rows) - 1;
  const double lower = sweep.start.lower[axis], upper = sweep.start.upper[axis];
  const auto box_between = [&](double from, double to) {  // of the box between two fractions
    const Vec3 a = from * sweep.displacement, b = to * sweep.displacement;
    return merged(Bounds{sweep.start.lower + a, sweep.start.upper + a},
                  Bounds{sweep.start.lower + b, sweep.start.upper + b});
  };
  const auto row_at = [&](double x) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(x / spacing), 0.0, rows - 1.0));
  };
  const Bounds all_box = box_between(0.0, std::min(limit, 1.0));
  const std::uint32_t low = row_at(all_box.lower[axis]), high = row_at(all_box.upper[axis]);
  for (std::uint32_t k = 0; k <= high - low; ++k) {
    const std::uint32_t row = d < 0.0 ? high - k : low + k;
    const double from = row * spacing, to = from + spacing;
    double in = 0.0, out = 1.0;
    if (std::fabs(d) > 1e-12 * spacing) {
      in = std::clamp((d > 0.0 ? from - upper : to - lower) / d - 1e-9, 0.0, 1.0);
      out = std::clamp((d > 0.0 ? to - lower : from - upper) / d + 1e-9, 0.0, 1.0);
    }
    if (in > limit) return;
    Bounds box = box_between(in, out);
    box.lower[axis] = from + 0.5 * spacing;  // only this row
    box.upper[axis] = from + 0.5 * spacing;
    for_cells(box, [&](std::uint32_t id) {
      if (limit >= in) limit = hit(id, in);
    });
    if (limit < 0.0) return;
  }
}

template <class F>
void Surface::cast(const Sweep& sweep, double limit, CastScratch& scratch, const F& hit) const {
  const Sweep local{unscaled(sweep.start),
                    {sweep.displacement.x / scale_.x, sweep.displacement.y / scale_.y,
                     sweep.displacement.z / scale_.z}};
  if (mesh_ != nullptr) {
    mesh_->tree.cast(local, limit, scratch, [&](std::uint32_t id, float entry) {
      return hit(id, static_cast<double>(entry));
    });
  } else if (limit >= 0.0) {
    cast_field(local, limit, hit);
  }
}

// Searches all cells within a distance, then within twice that, and so on: reports a cell several
// times.
template <class F>
void Surface::nearest_of_field(const Bounds& box, double limit, const F& near) const {
  const HeightData& f = *field_;
  const Bounds all = bounds();
  double box_between = std::max(f.spacing_x * scale_.x, f.spacing_y * scale_.y);
  for (;;) {
    const Bounds within = grown(box, std::min(box_between, limit));
    for_cells(unscaled(within), [&](std::uint32_t id) { limit = near(id); });
    const auto covers = [&](int i) {
      return within.lower[i] <= all.lower[i] && within.upper[i] >= all.upper[i];
    };
    if (box_between >= limit || (covers(0) && covers(1) && covers(2))) return;
    box_between *= 2.0;
  }
}

template <class F>
void Surface::nearest(const Bounds& box, double limit, CastScratch& scratch, const F& near) const {
  if (field_ != nullptr) return nearest_of_field(box, limit, near);
  mesh_->tree.nearest(unscaled(box), scale_, limit, scratch,
                      [&](std::uint32_t id, float) { return near(id); });
}

}  // namespace vp::collide
