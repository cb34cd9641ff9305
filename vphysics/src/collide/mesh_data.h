// The data of a TriangleMesh: constant once built, shared by all users of the mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/bounding_tree.h"
#include "vphysics/triangle_mesh.h"

namespace vp::collide {

inline constexpr std::uint32_t kNoVertex = 0xffffffffu;

struct MeshData {
  std::vector<Vec3> vertices;
  std::vector<TriangleMesh::Triangle> triangles;
  // The neighbour's third corner across each edge (from corner e to the next), or kNoVertex at a
  // border.
  std::vector<TriangleMesh::Triangle> opposite;
  // Active edges: bit e from the front, bit 3 + e from the back. This depends on which side of a
  // plane a corner is, which no scale changes.
  std::vector<std::uint8_t> active;
  std::vector<std::uint8_t> degenerate;
  // Neighbours of vertex v: the range from first_around[v] to first_around[v + 1].
  std::vector<std::uint32_t> first_around, around;
  BoundingTree tree;  // of all triangles that are not degenerate
  Vec3 lower, upper;  // bounds
  std::size_t left_out = 0;
  bool two_sided = false, closed = false;
  // Integrals of 1, x and x x^T over the interior, with x relative to centre.
  Vec3 centre;
  double volume = 0.0;
  Vec3 first_moment;
  Sym3 second_moment;
};

// Computes the topology from vertices, triangles and the degenerate flags.
void set_topology(MeshData& mesh);

// For an edge from p to q of a triangle with the given third corner, and the neighbour's third
// corner. Bit 0: the edge is active from the front; bit 1: from the back.
unsigned active_sides(const Vec3& p, const Vec3& q, const Vec3& third, const Vec3& opposite);

}  // namespace vp::collide
