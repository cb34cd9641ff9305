// The neighbours of a mesh's triangles, and the active edges.
#include <algorithm>
#include <cmath>

#include "collide/mesh_data.h"

namespace vp::collide {
namespace {

// The sine of the angle below which neighbours count as coplanar.
constexpr double kFlatSine = 1e-3;

// Edge e of a triangle, identified by its corners.
struct HalfEdge {
  std::uint64_t corners;  // the lower index in the upper half
  std::uint32_t triangle;
  std::uint8_t edge;
  bool upwards;  // from the lower corner to the higher one

  bool operator<(const HalfEdge& b) const {
    return corners != b.corners     ? corners < b.corners
           : triangle != b.triangle ? triangle < b.triangle
                                    : edge < b.edge;
  }
};

std::vector<HalfEdge> half_edges(const MeshData& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const TriangleMesh::Triangle& c = mesh.triangles[t];
    // Two corners coincide: the triangle's neighbours are neighbours of each other.
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    for (std::uint8_t e = 0; e < 3; ++e) {
      const std::uint32_t from = c[e], to = c[(e + 1) % 3];
      const std::uint64_t corners = (std::uint64_t{std::min(from, to)} << 32) | std::max(from, to);
      edges.push_back({corners, t, e, from < to});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// The partner across each edge: 3 * triangle + edge there; kNoVertex if there is none, or more than
// one.
std::vector<std::uint32_t> partners(const MeshData& mesh, bool& closed) {
  const std::vector<HalfEdge> edges = half_edges(mesh);
  std::vector<std::uint32_t> partner(3 * mesh.triangles.size(), kNoVertex);
  closed = true;
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && edges[last].corners == edges[first].corners) ++last;
    const HalfEdge &a = edges[first], &b = edges[last - 1];
    closed = closed && last - first == 2 && a.upwards != b.upwards;
    if (last - first != 2 || a.triangle == b.triangle) continue;
    partner[3 * a.triangle + a.edge] = 3 * b.triangle + b.edge;
    partner[3 * b.triangle + b.edge] = 3 * a.triangle + a.edge;
  }
  return partner;
}

// The third corner of the first triangle with area across an edge, through triangles without area.
std::uint32_t opposite_corner(const MeshData& mesh, const std::vector<std::uint32_t>& partner,
                              std::uint32_t half_edge) {
  std::uint32_t waiting[8] = {half_edge};
  std::size_t count = 1;
  // Adjacent triangles without area are few: with more of them the edge counts as a border.
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t opposite = partner[waiting[k]];
    if (opposite == kNoVertex) continue;
    const std::uint32_t t = opposite / 3, e = opposite % 3;
    if (mesh.degenerate[t] == 0) return mesh.triangles[t][(e + 2) % 3];
    for (std::uint32_t i = 1; i < 3 && count < 8; ++i) waiting[count++] = 3 * t + (e + i) % 3;
  }
  return kNoVertex;
}

void set_edges(MeshData& mesh, const std::vector<std::uint32_t>& partner) {
  mesh.opposite.assign(mesh.triangles.size(), {kNoVertex, kNoVertex, kNoVertex});
  mesh.active.assign(mesh.triangles.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.degenerate[t] != 0) continue;
    const TriangleMesh::Triangle& c = mesh.triangles[t];
    for (std::uint32_t e = 0; e < 3; ++e) {
      const std::uint32_t opposite = opposite_corner(mesh, partner, 3 * t + e);
      mesh.opposite[t][e] = opposite;
      const Vec3 &p = mesh.vertices[c[e]], &q = mesh.vertices[c[(e + 1) % 3]];
      const unsigned sides =
          opposite == kNoVertex
              ? 3
              : active_sides(p, q, mesh.vertices[c[(e + 2) % 3]], mesh.vertices[opposite]);
      mesh.active[t] |= static_cast<std::uint8_t>((sides & 1u) << e | (sides >> 1) << (3 + e));
    }
  }
}

void set_surroundings(MeshData& mesh) {
  std::vector<std::uint64_t> pairs;
  pairs.reserve(6 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.degenerate[t] != 0) continue;
    const TriangleMesh::Triangle& c = mesh.triangles[t];
    for (std::size_t e = 0; e < 3; ++e) {
      pairs.push_back((std::uint64_t{c[e]} << 32) | c[(e + 1) % 3]);
      pairs.push_back((std::uint64_t{c[(e + 1) % 3]} << 32) | c[e]);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  mesh.first_around.assign(mesh.vertices.size() + 1, 0);
  mesh.around.reserve(pairs.size());
  for (const std::uint64_t pair : pairs) {
    ++mesh.first_around[(pair >> 32) + 1];
    mesh.around.push_back(static_cast<std::uint32_t>(pair));
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    mesh.first_around[v + 1] += mesh.first_around[v];
  }
}

}  // namespace

unsigned active_sides(const Vec3& p, const Vec3& q, const Vec3& third, const Vec3& opposite) {
  const Vec3 along = q - p, this_side = third - p, other = opposite - p;
  const Vec3 n = cross(along, this_side), inwards = cross(n, along);
  // In the plane perpendicular to the edge: the neighbour's extent outwards, and upwards.
  const double out = -dot(inwards, other) / norm(inwards), up = dot(n, other) / norm(n);
  const double length = std::sqrt(out * out + up * up);
  const bool flat = std::fabs(up) <= kFlatSine * length;
  if (flat) return out > 0.0 ? 0u : 3u;  // coplanar, or folded onto itself
  return up < 0.0 ? 1u : 2u;
}

void set_topology(MeshData& mesh) {
  const std::vector<std::uint32_t> partner = partners(mesh, mesh.closed);
  set_edges(mesh, partner);
  set_surroundings(mesh);
}

}  // namespace vp::collide
