// Meshes and height fields for the tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "random.h"
#include "vphysics/height_field.h"
#include "vphysics/triangle_mesh.h"

namespace vp::test {

struct MeshPoints {
  std::vector<Vec3> vertices;
  std::vector<TriangleMesh::Triangle> triangles;

  TriangleMesh made(const MeshOptions& options = {}) const {
    return TriangleMesh::of(vertices, triangles, options).value();
  }
};

// A box's surface with outward normals.
inline MeshPoints box_mesh(const Vec3& half) {
  MeshPoints m;
  for (int k = 0; k < 8; ++k) {
    m.vertices.push_back(
        {k & 4 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 1 ? half.z : -half.z});
  }
  m.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                 {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return m;
}

// The plane z = 0 from (0, 0) to (size, size): a grid with displaced inner vertices and random
// diagonals. The triangles come in a random order and begin at random corners.
inline MeshPoints random_plane(Random& random, std::uint32_t cells, double size) {
  MeshPoints m;
  const double cell = size / cells;
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      Vec3 p{i * cell, j * cell, 0.0};
      if (i > 0 && i < cells) p.x += random.uniform(-0.4, 0.4) * cell;
      if (j > 0 && j < cells) p.y += random.uniform(-0.4, 0.4) * cell;
      m.vertices.push_back(p);
    }
  }
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i, b = a + 1, c = b + cells + 1, d = c - 1;
      // Chooses a diagonal that leaves both triangles counter-clockwise.
      const auto turns = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
        return cross(m.vertices[q] - m.vertices[p], m.vertices[r] - m.vertices[p]).z >
               1e-3 * cell * cell;
      };
      const bool ac = turns(a, b, c) && turns(a, c, d), bd = turns(a, b, d) && turns(b, c, d);
      if (ac && (!bd || random.word() % 2 == 0)) {
        m.triangles.push_back({a, b, c});
        m.triangles.push_back({a, c, d});
      } else {
        m.triangles.push_back({a, b, d});
        m.triangles.push_back({b, c, d});
      }
    }
  }
  for (std::size_t k = m.triangles.size(); k > 1; --k) {
    std::swap(m.triangles[k - 1], m.triangles[random.word() % k]);
  }
  for (TriangleMesh::Triangle& t : m.triangles) {
    std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random.word() % 3), t.end());
  }
  return m;
}

// A square grid of cells from a corner, with the heights z(x, y).
template <class Height>
MeshPoints grid_mesh(std::uint32_t cells, double cell, double corner, const Height& z) {
  MeshPoints m;
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const double x = corner + i * cell, y = corner + j * cell;
      m.vertices.push_back({x, y, z(x, y)});
    }
  }
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i, c = a + cells + 2;
      m.triangles.push_back({a, a + 1, c});
      m.triangles.push_back({a, c, c - 1});
    }
  }
  return m;
}

// Waves of the given height about z = 0, on a grid about the origin.
inline double wave(double x, double y, double height) {
  return height * std::sin(3.0 * x) * std::sin(2.0 * y + 1.0);
}
inline MeshPoints wave_mesh(std::uint32_t cells, double cell, double height) {
  return grid_mesh(cells, cell, -0.5 * cells * cell,
                   [height](double x, double y) { return wave(x, y, height); });
}

// A sphere about the origin, of 20 * 4^levels triangles.
inline MeshPoints sphere_mesh(double radius, int levels) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  MeshPoints m;
  m.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  m.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::vector<TriangleMesh::Triangle> finer;
    for (const auto& [a, b, c] : m.triangles) {
      const auto n = static_cast<std::uint32_t>(m.vertices.size());
      m.vertices.push_back(0.5 * (m.vertices[a] + m.vertices[b]));
      m.vertices.push_back(0.5 * (m.vertices[b] + m.vertices[c]));
      m.vertices.push_back(0.5 * (m.vertices[c] + m.vertices[a]));
      for (const auto& t : {TriangleMesh::Triangle{a, n, n + 2},
                            {n, b, n + 1},
                            {n + 2, n + 1, c},
                            {n, n + 1, n + 2}}) {
        finer.push_back(t);
      }
    }
    m.triangles = finer;
    for (Vec3& v : m.vertices) v = (1.0 / norm(v)) * v;
  }
  for (Vec3& v : m.vertices) v = (radius / norm(v)) * v;
  return m;
}

}  // namespace vp::test
