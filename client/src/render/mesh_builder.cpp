#include "render/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

namespace client {
namespace {

std::uint8_t byte_of(float share) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.0f, 1.0f) * 255.0f));
}

// Point and outward direction of a superellipse at the angle.
glm::vec2 superellipse(const LoftRing& ring, float angle) {
  const float c = std::cos(angle), s = std::sin(angle), e = 2.0f / ring.exponent;
  return {ring.half.x * std::copysign(std::pow(std::abs(c), e), c),
          ring.half.y * std::copysign(std::pow(std::abs(s), e), s)};
}

glm::vec3 ring_point(const LoftRing& ring, float angle) {
  const glm::vec2 p = superellipse(ring, angle);
  return {ring.centre.x + p.x, ring.centre.y + p.y, ring.centre.z};
}

}  // namespace

int MeshBuilder::scaled(int count, int min) const {
  const int n = static_cast<int>(std::lround(static_cast<float>(count) * detail_));
  return std::max(min, n - n % 2);
}

std::uint32_t MeshBuilder::vertex(const glm::vec3& position, const glm::vec3& normal) {
  MeshVertex v;
  v.position = glm::vec3(transform_ * glm::vec4(position, 1.0f));
  v.normal = glm::normalize(glm::vec3(transform_ * glm::vec4(normal, 0.0f)));
  for (int i = 0; i < 3; ++i) v.albedo[i] = byte_of(std::sqrt(paint_.albedo[i]));
  v.albedo[3] = byte_of(paint_.tint);
  v.material[0] = byte_of(paint_.roughness);
  v.material[1] = byte_of(paint_.metal);
  v.material[2] = byte_of(paint_.emission / 4.0f);
  v.material[3] = 255;
  mesh_.vertices.push_back(v);
  return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
}

// Omits a degenerate triangle (at a pole, where a profile meets its axis).
void MeshBuilder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const auto& v = mesh_.vertices;
  const glm::vec3 normal = glm::cross(v[b].position - v[a].position, v[c].position - v[a].position);
  if (glm::dot(normal, normal) < 1e-20f) return;
  mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
}

void MeshBuilder::quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  triangle(a, b, c);
  triangle(a, c, d);
}

// A fan over a convex ring, counter-clockwise seen against the normal.
void MeshBuilder::cap(std::span<const glm::vec3> ring, const glm::vec3& normal) {
  std::vector<std::uint32_t> rim;
  for (const glm::vec3& p : ring) rim.push_back(vertex(p, normal));
  for (std::size_t i = 2; i < rim.size(); ++i) triangle(rim[0], rim[i - 1], rim[i]);
}

void MeshBuilder::rounded_box(const glm::vec3& centre, const glm::vec3& half, float bevel,
                              int steps) {
  // Coarse boxes have no bevel: four corners per side, each with that side's normal.
  steps = fine() ? steps : 0;
  const float b = std::min({bevel, half.x * 0.98f, half.y * 0.98f, half.z * 0.98f});
  const glm::vec3 core = half - b;
  // Along each edge of the cube: the bevel's steps, the flat part, the bevel again. The tangent
  // spaces the steps uniformly over the quarter circle.
  const auto lines = [&](float h) {
    if (steps == 0) return std::vector<float>{-h, h};
    std::vector<float> t;
    for (int i = 0; i <= steps; ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(steps);
      t.push_back(-h + b * (1.0f - std::tan((1.0f - share) * glm::quarter_pi<float>())));
    }
    for (int i = steps; i >= 0; --i) t.push_back(-t[static_cast<std::size_t>(i)]);
    return t;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, w = (axis + 2) % 3;
    const std::vector<float> us = lines(half[u]), ws = lines(half[w]);
    for (const float side : {-1.0f, 1.0f}) {
      const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
      for (const float pw : ws) {
        for (const float pu : us) {
          glm::vec3 p;
          p[axis] = side * half[axis];
          p[u] = pu;
          p[w] = pw;
          const glm::vec3 inner = glm::clamp(p, -core, core);
          glm::vec3 normal{0.0f};
          normal[axis] = side;
          if (steps > 0) normal = glm::normalize(p - inner);
          vertex(steps > 0 ? centre + inner + normal * b : centre + p, normal);
        }
      }
      const auto columns = static_cast<std::uint32_t>(us.size());
      for (std::uint32_t row = 0; row + 1 < ws.size(); ++row) {
        for (std::uint32_t column = 0; column + 1 < columns; ++column) {
          const std::uint32_t i = first + row * columns + column;
          if (side > 0) {
            quad(i, i + 1, i + columns + 1, i + columns);
          } else {
            quad(i, i + columns, i + columns + 1, i + 1);
          }
        }
      }
    }
  }
}

void MeshBuilder::ellipsoid(const glm::vec3& centre, const glm::vec3& radii, int slices,
                            int stacks) {
  slices = scaled(slices, 8);
  stacks = scaled(stacks, 6);
  const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
  for (int i = 0; i <= stacks; ++i) {
    const float polar =
        glm::pi<float>() * (static_cast<float>(i) / static_cast<float>(stacks) - 0.5f);
    const bool pole = i == 0 || i == stacks;
    for (int j = 0; j <= slices; ++j) {
      const float turn =
          glm::two_pi<float>() * static_cast<float>(j % slices) / static_cast<float>(slices);
      const float r = pole ? 0.0f : std::cos(polar);
      const glm::vec3 d{r * std::cos(turn), r * std::sin(turn),
                        pole ? (i == 0 ? -1.0f : 1.0f) : std::sin(polar)};
      vertex(centre + d * radii, d / radii);
    }
  }
  const auto columns = static_cast<std::uint32_t>(slices + 1);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(stacks); ++i) {
    for (std::uint32_t j = 0; j + 1 < columns; ++j) {
      const std::uint32_t k = first + i * columns + j;
      quad(k, k + 1, k + columns + 1, k + columns);
    }
  }
}

void MeshBuilder::loft(std::span<const LoftRing> rings, int slices) {
  slices = scaled(slices, 8);
  const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
  const auto angle = [&](int j) {
    return glm::two_pi<float>() * static_cast<float>(j % slices) / static_cast<float>(slices);
  };
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const LoftRing& below = rings[i == 0 ? 0 : i - 1];
    const LoftRing& above = rings[i + 1 == rings.size() ? i : i + 1];
    for (int j = 0; j <= slices; ++j) {
      const float a = angle(j), step = 0.02f;
      const glm::vec3 along = ring_point(rings[i], a + step) - ring_point(rings[i], a - step);
      const glm::vec3 up = ring_point(above, a) - ring_point(below, a);
      vertex(ring_point(rings[i], a), glm::cross(along, up));
    }
  }
  const auto columns = static_cast<std::uint32_t>(slices + 1);
  for (std::uint32_t i = 0; i + 1 < rings.size(); ++i) {
    for (std::uint32_t j = 0; j + 1 < columns; ++j) {
      const std::uint32_t k = first + i * columns + j;
      quad(k, k + 1, k + columns + 1, k + columns);
    }
  }
  std::vector<glm::vec3> bottom, top;
  for (int j = 0; j < slices; ++j) {
    bottom.push_back(ring_point(rings.front(), angle(slices - j)));
    top.push_back(ring_point(rings.back(), angle(j)));
  }
  cap(bottom, {0, 0, -1});
  cap(top, {0, 0, 1});
}

void MeshBuilder::turned(std::span<const ProfilePoint> profile, int slices, bool sharp) {
  slices = scaled(slices, 8);
  const auto at = [&](const ProfilePoint& p, int j) {
    const float a =
        glm::two_pi<float>() * static_cast<float>(j % slices) / static_cast<float>(slices);
    return glm::vec3(p.radius * std::cos(a), p.radius * std::sin(a), p.z);
  };
  const auto normal = [&](const ProfilePoint& p, const ProfilePoint& q, int j) {
    const float a =
        glm::two_pi<float>() * static_cast<float>(j % slices) / static_cast<float>(slices);
    const float dz = q.z - p.z, dr = q.radius - p.radius;
    return glm::vec3(dz * std::cos(a), dz * std::sin(a), -dr);
  };
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const ProfilePoint &p = profile[i], &q = profile[i + 1];
    const ProfilePoint& before = sharp || i == 0 ? p : profile[i - 1];
    const ProfilePoint& after = sharp || i + 2 >= profile.size() ? q : profile[i + 2];
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (int j = 0; j <= slices; ++j) {
      vertex(at(p, j), normal(before, q, j));
      vertex(at(q, j), normal(p, after, j));
    }
    for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(slices); ++j) {
      const std::uint32_t k = first + 2 * j;
      quad(k, k + 2, k + 3, k + 1);
    }
  }
  std::vector<glm::vec3> bottom, top;
  for (int j = 0; j < slices; ++j) {
    bottom.push_back(at(profile.front(), slices - j));
    top.push_back(at(profile.back(), j));
  }
  if (profile.front().radius > 0) cap(bottom, {0, 0, -1});
  if (profile.back().radius > 0) cap(top, {0, 0, 1});
}

void MeshBuilder::torus(const glm::vec3& centre, float radius, float section, int slices,
                        int sides) {
  slices = scaled(slices, 8);
  sides = scaled(sides, 6);
  const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
  for (int i = 0; i <= slices; ++i) {
    const float a =
        glm::two_pi<float>() * static_cast<float>(i % slices) / static_cast<float>(slices);
    const glm::vec3 out{std::cos(a), std::sin(a), 0};
    for (int j = 0; j <= sides; ++j) {
      const float b =
          glm::two_pi<float>() * static_cast<float>(j % sides) / static_cast<float>(sides);
      const glm::vec3 n = out * std::cos(b) + glm::vec3(0, 0, std::sin(b));
      vertex(centre + out * radius + n * section, n);
    }
  }
  const auto columns = static_cast<std::uint32_t>(sides + 1);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(slices); ++i) {
    for (std::uint32_t j = 0; j + 1 < columns; ++j) {
      const std::uint32_t k = first + i * columns + j;
      quad(k, k + columns, k + columns + 1, k + 1);
    }
  }
}

void MeshBuilder::tetrahedron(std::array<glm::vec3, 4> corners) {
  const glm::vec3 middle = 0.25f * (corners[0] + corners[1] + corners[2] + corners[3]);
  constexpr int kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  for (const auto& face : kFaces) {
    const glm::vec3 a = corners[static_cast<std::size_t>(face[0])];
    glm::vec3 b = corners[static_cast<std::size_t>(face[1])];
    glm::vec3 c = corners[static_cast<std::size_t>(face[2])];
    if (glm::dot(glm::cross(b - a, c - a), a - middle) < 0) std::swap(b, c);
    const glm::vec3 n = glm::cross(b - a, c - a);
    triangle(vertex(a, n), vertex(b, n), vertex(c, n));
  }
}

glm::mat4 axis_along_y() {  // x stays, z to y, y to -z
  return {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}};
}

glm::mat4 axis_along_x() {  // y stays, z to x, x to -z
  return {{0, 0, -1, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 1}};
}

}  // namespace client
