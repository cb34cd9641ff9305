// Builds a hull from points: snaps them to a grid, computes the triangles exactly, merges them into
// faces, and numbers everything in an order that depends on the corners alone.
#include "vphysics/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "collide/bounds.h"
#include "collide/hull.h"
#include "collide/hull_faces.h"
#include "collide/quickhull.h"

namespace vp {
namespace {

using collide::HullData;
using collide::Loop;

constexpr double kFarthestPoint = 1e9;    // of a coordinate [m], the engine's limit
constexpr double kSmallestExtent = 1e-6;  // [m], the limit of every shape
constexpr double kMinExtent = 1e-6;       // thickness, as a fraction of the extent
// Feature names and the cost of pairs are designed for this many.
constexpr int kMaxHullVertices = 256;
constexpr double kCoarsestTolerance = 0.01;  // the maximum tolerance option

tl::unexpected<Error> invalid_hull(std::string message) {
  return tl::make_unexpected(Error{Errc::invalid_argument, "convex hull: " + std::move(message)});
}

// Sorts lexicographically and removes duplicates.
std::vector<Vec3> sorted(std::span<const Vec3> points) {
  std::vector<Vec3> found(points.begin(), points.end());
  for (Vec3& p : found) p += Vec3{};  // -0 becomes 0
  std::sort(found.begin(), found.end(), [](const Vec3& a, const Vec3& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  });
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

struct Extent {
  Vec3 lower, upper;
  double largest;
};
Extent extent_of(std::span<const Vec3> points) {
  Extent e{points[0], points[0], 0.0};
  for (const Vec3& p : points) {
    for (int i = 0; i < 3; ++i) {
      e.lower[i] = std::min(e.lower[i], p[i]);
      e.upper[i] = std::max(e.upper[i], p[i]);
    }
  }
  const Vec3 size = e.upper - e.lower;
  e.largest = std::max({size.x, size.y, size.z});
  return e;
}

// Cells per metre: a power of two, so that snapping only rounds.
double grid_scale(double extent) {
  int exponent = 0;
  (void)std::frexp(extent, &exponent);  // extent < 2^exponent
  return std::ldexp(1.0, collide::kGridBits - exponent);
}

std::vector<collide::GridPoint> snapped(std::span<const Vec3> points, const Vec3& lower,
                                        double scale) {
  std::vector<collide::GridPoint> grid;
  grid.reserve(points.size());
  const auto cell = [&](double x) {
    return static_cast<std::int64_t>(std::floor(x * scale + 0.5));
  };
  for (const Vec3& p : points) {
    const Vec3 d = p - lower;
    grid.push_back({cell(d.x), cell(d.y), cell(d.z)});
  }
  return grid;
}

// The hull's triangles, without vertices inside flat faces. Indices refer to all points.
collide::Quickhull find_triangles(std::span<const Vec3> points, const Extent& extent, double scale,
                                  const HullOptions& options) {
  const double cells = extent.largest * scale;
  const std::vector<collide::GridPoint> grid = snapped(points, extent.lower, scale);
  collide::Quickhull found =
      collide::quickhull(grid, options.max_vertices, options.tolerance * cells, kMinExtent * cells);
  while (found.result == collide::Quickhull::Result::hull) {
    const std::vector<std::uint32_t> flat =
        collide::flat_corners(points, found.triangles, found.tolerance / scale);
    if (flat.empty()) break;
    std::vector<std::uint32_t> kept_points;  // the corners that are not flat
    for (const collide::Triangle& t : found.triangles)
      kept_points.insert(kept_points.end(), t.begin(), t.end());
    std::sort(kept_points.begin(), kept_points.end());
    kept_points.erase(std::unique(kept_points.begin(), kept_points.end()), kept_points.end());
    std::erase_if(kept_points,
                  [&](auto i) { return std::find(flat.begin(), flat.end(), i) != flat.end(); });
    std::vector<collide::GridPoint> fewer;
    fewer.reserve(kept_points.size());
    for (const std::uint32_t i : kept_points) fewer.push_back(grid[i]);
    collide::Quickhull next =
        collide::quickhull(fewer, options.max_vertices, found.tolerance, kMinExtent * cells);
    if (next.result != collide::Quickhull::Result::hull) break;
    for (collide::Triangle& t : next.triangles)
      t = {kept_points[t[0]], kept_points[t[1]], kept_points[t[2]]};
    found = std::move(next);
  }
  return found;
}

// Numbers the corners in the order of the points, rotates each loop to start with its lowest
// corner, and sorts the loops.
std::vector<Vec3> renumber(std::span<const Vec3> points, std::vector<Loop>& loops) {
  std::vector<std::uint32_t> number(points.size(), 0);
  for (const Loop& loop : loops) {
    for (const std::uint32_t i : loop) number[i] = 1;
  }
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (number[i] == 0) continue;
    number[i] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(points[i]);
  }
  for (Loop& loop : loops) {
    for (std::uint32_t& i : loop) i = number[i];
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  }
  std::sort(loops.begin(), loops.end());
  return vertices;
}

void set_faces(HullData& hull, std::span<const Loop> loops) {
  for (const Loop& loop : loops) {
    for (const std::uint32_t i : loop) hull.corners.push_back(static_cast<std::uint16_t>(i));
  }
  std::size_t first = 0;
  for (const Loop& loop : loops) {
    ConvexHull::Face face;
    face.normal = collide::unit(collide::area_vector(hull.vertices, loop));
    face.offset = dot(face.normal, hull.vertices[0]);
    for (const Vec3& v : hull.vertices) face.offset = std::max(face.offset, dot(face.normal, v));
    face.vertices = std::span(hull.corners).subspan(first, loop.size());
    first += loop.size();
    for (const std::uint16_t v : face.vertices) {
      hull.max_face_depth =
          std::max(hull.max_face_depth, face.offset - dot(face.normal, hull.vertices[v]));
    }
    hull.faces.push_back(face);
  }
}

void set_edges(HullData& hull) {
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const auto& loop = hull.faces[f].vertices;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint16_t from = loop[i], to = loop[(i + 1) % loop.size()];
      if (from < to) hull.edges.push_back({from, to, static_cast<std::uint16_t>(f), 0});
    }
  }
  const auto before = [](const collide::HullEdge& a, const collide::HullEdge& b) {
    return a.v0 != b.v0 ? a.v0 < b.v0 : a.v1 < b.v1;
  };
  std::sort(hull.edges.begin(), hull.edges.end(), before);
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    hull.first_corner.push_back(static_cast<std::uint16_t>(hull.corner_edges.size()));
    const auto& loop = hull.faces[f].vertices;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint16_t from = loop[i], to = loop[(i + 1) % loop.size()];
      const collide::HullEdge key{std::min(from, to), std::max(from, to), 0, 0};
      const auto edge = std::lower_bound(hull.edges.begin(), hull.edges.end(), key, before);
      hull.corner_edges.push_back(static_cast<std::uint16_t>(edge - hull.edges.begin()));
      if (from > to) edge->right = static_cast<std::uint16_t>(f);
    }
  }
}

// A vertex has as many faces as neighbours.
void set_surroundings(HullData& hull) {
  std::vector<std::vector<std::uint16_t>> faces(hull.vertices.size()), next(hull.vertices.size());
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const auto& loop = hull.faces[f].vertices;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      faces[loop[i]].push_back(static_cast<std::uint16_t>(f));
      next[loop[i]].push_back(loop[(i + 1) % loop.size()]);
    }
  }
  for (std::size_t v = 0; v < hull.vertices.size(); ++v) {
    hull.first_around.push_back(static_cast<std::uint16_t>(hull.faces_around.size()));
    hull.faces_around.insert(hull.faces_around.end(), faces[v].begin(), faces[v].end());
    hull.neighbours.insert(hull.neighbours.end(), next[v].begin(), next[v].end());
  }
  hull.first_around.push_back(static_cast<std::uint16_t>(hull.faces_around.size()));
}

// Adds a tetrahedron of density 1 from the reference point (here the origin) to a, b, c: volume V,
// first moment V (a + b + c) / 4, and the integral of x x^T, V (S S^T + the sum of each corner's) /
// 20, S = a + b + c.
struct Moments {
  double volume = 0.0;
  Vec3 first;
  Sym3 second;

  void add_tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double V = dot(a, cross(b, c)) / 6.0;
    const Vec3 S = a + b + c;
    volume += V;
    first += (0.25 * V) * S;
    const double k = 0.05 * V;
    second = second + (outer(k, S) + outer(k, a)) + (outer(k, b) + outer(k, c));
  }
};

void set_mass(HullData& hull) {
  Vec3 reference;  // near the hull, to keep precision if the frame's origin is far away
  for (const Vec3& v : hull.vertices) reference += v;
  reference *= 1.0 / static_cast<double>(hull.vertices.size());
  Moments m;
  for (const ConvexHull::Face& face : hull.faces) {
    for (std::size_t i = 2; i < face.vertices.size(); ++i) {
      m.add_tetrahedron(hull.vertices[face.vertices[0]] - reference,
                        hull.vertices[face.vertices[i - 1]] - reference,
                        hull.vertices[face.vertices[i]] - reference);
    }
  }
  const Sym3& s = m.second;
  const Sym3 about_centre{s.yy + s.zz, s.zz + s.xx, s.xx + s.yy, -s.xy, -s.yz, -s.zx};
  hull.volume = m.volume;
  hull.centre = reference + (1.0 / m.volume) * m.first;
  hull.unit = Inertia(m.volume, m.first, about_centre).about(-reference);
  if (hull.vertices.size() <= collide::kMaxScanned) {
    for (const Vec3& v : hull.vertices) hull.scanned_vertices.add(v);
    while (!hull.scanned_vertices.is_whole()) hull.scanned_vertices.add(hull.vertices[0]);
  }
  collide::ScanPlanes& planes = hull.scanned_faces;
  for (const ConvexHull::Face& face : hull.faces) planes.normal.add(face.normal);
  for (const ConvexHull::Face& face : hull.faces) planes.offset.push_back(face.offset);
  while (!planes.normal.is_whole()) {
    planes.normal.add({});
    planes.offset.push_back(collide::kFar);
  }
  hull.radius = 0.0;
  for (const Vec3& v : hull.vertices) hull.radius = std::max(hull.radius, norm(v - hull.centre));
}

}  // namespace

Expected<ConvexHull> ConvexHull::of(std::span<const Vec3> points, const HullOptions& options) {
  if (options.max_vertices < 4 || options.max_vertices > kMaxHullVertices) {
    return invalid_hull("max_vertices must be from 4 to 256");
  }
  if (!(options.tolerance >= 0.0 && options.tolerance <= kCoarsestTolerance)) {
    return invalid_hull("the tolerance must be in [0, 0.01]");
  }
  for (const Vec3& p : points) {
    for (const double x : {p.x, p.y, p.z}) {
      if (!(std::fabs(x) <= kFarthestPoint)) {
        return invalid_hull("every coordinate must be finite and at most 1e9 in magnitude");
      }
    }
  }
  const std::vector<Vec3> distinct = sorted(points);
  if (distinct.size() < 4) return invalid_hull("at least four different points are needed");
  const Extent extent = extent_of(distinct);
  if (!(extent.largest >= kSmallestExtent)) {
    return invalid_hull("the points lie within a micrometre; give them in metres");
  }
  const double scale = grid_scale(extent.largest);
  const collide::Quickhull found = find_triangles(distinct, extent, scale, options);
  switch (found.result) {
    case collide::Quickhull::Result::hull:
      break;
    case collide::Quickhull::Result::point:
    case collide::Quickhull::Result::line:
      return invalid_hull("the points lie on one line; a capsule has a thickness of its own");
    case collide::Quickhull::Result::plane:
      return invalid_hull(
          "the points lie in one plane; give the body a thickness, or use a thin box");
  }
  auto hull = std::make_shared<HullData>();
  std::vector<Loop> loops = collide::faces_of(distinct, found.triangles, found.tolerance / scale);
  hull->vertices = renumber(distinct, loops);
  const Extent kept_points = extent_of(hull->vertices);
  hull->lower = kept_points.lower;
  hull->upper = kept_points.upper;
  set_faces(*hull, loops);
  set_edges(*hull);
  set_surroundings(*hull);
  set_mass(*hull);
  return ConvexHull(std::move(hull));
}

std::span<const Vec3> ConvexHull::vertices() const {
  return data_->vertices;
}
std::span<const ConvexHull::Face> ConvexHull::faces() const {
  return data_->faces;
}
double ConvexHull::volume() const {
  return data_->volume;
}
Vec3 ConvexHull::centre_of_mass() const {
  return data_->centre;
}
Inertia ConvexHull::inertia(double density) const {
  const Inertia& unit = data_->unit;
  return {density * unit.mass(), density * unit.first_moment(), density * unit.rotational()};
}

}  // namespace vp
