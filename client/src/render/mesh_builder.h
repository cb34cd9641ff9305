// Builds closed solids from rounded boxes, lofts and solids of revolution. Every solid is closed
// separately, with outward normals; solids may overlap.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <span>

#include "render/mesh_data.h"

namespace client {

// One cross-section of a loft: a superellipse |x/a|^e + |y/b|^e = 1 at height z.
struct LoftRing {
  glm::vec3 centre;
  glm::vec2 half;         // a, b [m]
  float exponent = 2.0f;  // 2 ellipse, 4 nearly a box
};

// Point of a profile of revolution, from the axis.
struct ProfilePoint {
  float radius;
  float z;
};

class MeshBuilder {
 public:
  // detail: 1 for close views, 0.5 where vertices are expensive.
  explicit MeshBuilder(float detail = 1.0f) : detail_(detail) {}

  // A coarse mesh omits trimmings that cover few pixels.
  bool fine() const { return detail_ > 0.5f; }

  void paint(const Paint& paint) { paint_ = paint; }
  void transform(const glm::mat4& T_mesh_solid) { transform_ = T_mesh_solid; }  // rigid

  void rounded_box(const glm::vec3& centre, const glm::vec3& half, float bevel, int steps = 2);
  void ellipsoid(const glm::vec3& centre, const glm::vec3& radii, int slices = 20, int stacks = 12);
  // Rings from bottom to top, closed by flat caps. Precondition: at least two rings, z increasing.
  void loft(std::span<const LoftRing> rings, int slices = 20);
  // A profile revolved about z, from bottom to top; ends off the axis are closed by flat caps.
  // sharp: corners of the profile keep hard edges.
  void turned(std::span<const ProfilePoint> profile, int slices = 20, bool sharp = false);
  // A torus about z with circular section.
  void torus(const glm::vec3& centre, float radius, float section, int slices = 24, int sides = 8);
  void tetrahedron(std::array<glm::vec3, 4> corners);

  const MeshData& mesh() const { return mesh_; }
  MeshData take() { return std::move(mesh_); }

 private:
  std::uint32_t vertex(const glm::vec3& position, const glm::vec3& normal);
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
  void cap(std::span<const glm::vec3> ring, const glm::vec3& normal);
  int scaled(int count, int min) const;

  float detail_;
  Paint paint_;
  glm::mat4 transform_{1.0f};
  MeshData mesh_;
};

// Rotates z (the axis of a loft or a solid of revolution) to y or x.
glm::mat4 axis_along_y();
glm::mat4 axis_along_x();

}  // namespace client
