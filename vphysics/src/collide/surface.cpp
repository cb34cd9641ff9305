#include "collide/surface.h"

namespace vp::collide {
namespace {

// Rounding tolerance of a direction: a neighbour at most this far above the plane [fraction of its
// distance] counts as in the plane.
constexpr double kInPlane = 1e-6;

void set_normal(SurfaceTriangle& t) {
  const Vec3 n = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  t.normal = (1.0 / norm(n)) * n;
}

bool is_above(const Vec3& from, const Vec3& corner, const Vec3& d) {
  const Vec3 offset = corner - from;
  const double height = dot(offset, d);
  return height > 0.0 && height * height > kInPlane * kInPlane * dot(offset, offset);
}

// Corners and neighbours of the two triangles of a cell, as offsets in columns and rows from its
// first sample: the corners, the third corner across each edge, and the cell that contains it.
struct CellTriangle {
  int corner[3][2], opposite[3][2], cell[3][2];
};
constexpr CellTriangle kLowerCell{
    {{0, 0}, {1, 0}, {1, 1}}, {{0, -1}, {2, 1}, {0, 1}}, {{0, -1}, {1, 0}, {0, 0}}};
constexpr CellTriangle kUpperCell{
    {{0, 0}, {1, 1}, {0, 1}}, {{1, 0}, {1, 2}, {-1, 0}}, {{0, 0}, {0, 1}, {-1, 0}}};

// Neighbours of a sample, including diagonals, each with two cells of which at least one must
// exist.
constexpr int kAround[6][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 0}, {-1, -1}, {0, -1}};
constexpr int kAroundCells[6][2][2] = {{{0, 0}, {0, -1}},    {{0, 0}, {0, 0}},
                                       {{0, 0}, {-1, 0}},    {{-1, 0}, {-1, -1}},
                                       {{-1, -1}, {-1, -1}}, {{-1, -1}, {0, -1}}};

}  // namespace

Bounds Surface::bounds() const {
  if (mesh_ != nullptr) return {scaled(mesh_->lower), scaled(mesh_->upper)};
  const Vec3 far{(field_->columns - 1) * field_->spacing_x, (field_->rows - 1) * field_->spacing_y,
                 field_->highest};
  return {scaled({0.0, 0.0, field_->lowest}), scaled(far)};
}

Bounds Surface::unscaled(const Bounds& b) const {
  Bounds local;
  for (int i = 0; i < 3; ++i) {
    local.lower[i] = b.lower[i] / scale_[i];
    local.upper[i] = b.upper[i] / scale_[i];
  }
  return local;
}

void Surface::append_overlapping(const Bounds& box, std::vector<std::uint32_t>& ids) const {
  const auto first = static_cast<std::ptrdiff_t>(ids.size());
  overlapping(box, [&](std::uint32_t id) { ids.push_back(id); });
  std::sort(ids.begin() + first, ids.end());
}

SurfaceTriangle Surface::triangle(std::uint32_t id) const {
  return mesh_ != nullptr ? of_mesh(id) : of_field(id);
}

void Surface::corners(std::uint32_t id, Vec3 p[3]) const {
  if (mesh_ != nullptr) {
    for (std::size_t i = 0; i < 3; ++i) p[i] = scaled(mesh_->vertices[mesh_->triangles[id][i]]);
    return;
  }
  const std::uint32_t cell = id / 2, i = cell % (field_->columns - 1),
                      j = cell / (field_->columns - 1);
  const CellTriangle& shape = id % 2 == 0 ? kLowerCell : kUpperCell;
  for (int k = 0; k < 3; ++k) {
    p[k] = scaled(field_->sample(i + static_cast<std::uint32_t>(shape.corner[k][0]),
                                 j + static_cast<std::uint32_t>(shape.corner[k][1])));
  }
}

SurfaceTriangle Surface::of_mesh(std::uint32_t id) const {
  SurfaceTriangle t;
  t.id = id;
  for (std::size_t i = 0; i < 3; ++i) {
    t.corners[i] = mesh_->triangles[id][i];
    t.p[i] = scaled(mesh_->vertices[t.corners[i]]);
    const std::uint32_t opposite = mesh_->opposite[id][i];
    t.has_opposite[i] = opposite != kNoVertex;
    if (t.has_opposite[i]) t.opposite[i] = scaled(mesh_->vertices[opposite]);
  }
  t.active = mesh_->active[id];
  set_normal(t);
  return t;
}

SurfaceTriangle Surface::of_field(std::uint32_t id) const {
  const HeightData& f = *field_;
  const std::uint32_t cell = id / 2, i = cell % (f.columns - 1), j = cell / (f.columns - 1);
  const CellTriangle& shape = id % 2 == 0 ? kLowerCell : kUpperCell;
  const auto sample = [&](const int(&step)[2]) {
    return scaled(
        f.sample(i + static_cast<std::uint32_t>(step[0]), j + static_cast<std::uint32_t>(step[1])));
  };
  SurfaceTriangle t;
  t.id = id;
  t.active = 0;
  for (int k = 0; k < 3; ++k) {
    const int(&c)[2] = shape.corner[k];
    t.corners[k] =
        (j + static_cast<std::uint32_t>(c[1])) * f.columns + i + static_cast<std::uint32_t>(c[0]);
    t.p[k] = sample(c);
    t.has_opposite[k] =
        !f.is_hole(std::int64_t{i} + shape.cell[k][0], std::int64_t{j} + shape.cell[k][1]);
    if (t.has_opposite[k]) t.opposite[k] = sample(shape.opposite[k]);
  }
  for (int k = 0; k < 3; ++k) {
    const unsigned sides =
        t.has_opposite[k] ? active_sides(t.p[k], t.p[(k + 1) % 3], t.p[(k + 2) % 3], t.opposite[k])
                          : 3;
    t.active |= (sides & 1u) << k | (sides >> 1) << (3 + k);
  }
  set_normal(t);
  return t;
}

bool Surface::lies_below(std::uint32_t vertex, const Vec3& d) const {
  if (mesh_ != nullptr) {
    const Vec3 from = scaled(mesh_->vertices[vertex]);
    for (std::uint32_t k = mesh_->first_around[vertex]; k < mesh_->first_around[vertex + 1]; ++k) {
      if (is_above(from, scaled(mesh_->vertices[mesh_->around[k]]), d)) return false;
    }
    return true;
  }
  const HeightData& f = *field_;
  const std::int64_t i = vertex % f.columns, j = vertex / f.columns;
  const Vec3 from = scaled(f.sample(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)));
  for (int k = 0; k < 6; ++k) {
    const auto& cells = kAroundCells[k];
    if (f.is_hole(i + cells[0][0], j + cells[0][1]) && f.is_hole(i + cells[1][0], j + cells[1][1]))
      continue;
    const auto at_i = static_cast<std::uint32_t>(i + kAround[k][0]),
               at_j = static_cast<std::uint32_t>(j + kAround[k][1]);
    if (is_above(from, scaled(f.sample(at_i, at_j)), d)) return false;
  }
  return true;
}

}  // namespace vp::collide
