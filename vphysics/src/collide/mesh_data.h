// What a TriangleMesh holds: constant once built, shared by everything that uses the mesh.
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
  // The corner across each edge (from corner e to the next) that the neighbour there has, or
  // kNoVertex at a border.
  std::vector<TriangleMesh::Triangle> opposite;
  // Edges that can be felt: bit e from the front, bit 3 + e from the back. Whether they can depends
  // on which side of a plane a corner lies, which no scale changes.
  std::vector<std::uint8_t> active;
  std::vector<std::uint8_t> degenerate;
  // Corners next to corner v: from first_around[v] up to first_around[v + 1].
  std::vector<std::uint32_t> first_around, around;
  BoundingTree tree;  // of all that are not degenerate
  Vec3 lower, upper;  // bounds
  std::size_t left_out = 0;
  bool two_sided = false, closed = false;
  // Integrals of 1, x and x x^T over the inside, x from middle.
  Vec3 centre;
  double volume = 0.0;
  Vec3 first_moment;
  Sym3 second_moment;
};

// From vertices, triangles and which of them are degenerate: who is whose neighbour.
void set_topology(MeshData& mesh);

// An edge seen from a triangle: from p to q, the triangle's own third corner, and the neighbour's.
// Bit 0: it can be felt from the front; bit 1: from the back.
unsigned active_sides(const Vec3& p, const Vec3& q, const Vec3& third, const Vec3& opposite);

}  // namespace vp::collide
