// Triangle meshes, for colliders of fixed and kinematic bodies. Lengths in metres.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "vphysics/error.h"
#include "vphysics/lie.h"

namespace vp {

namespace collide {
struct MeshData;
}

struct MeshOptions {
  // One-sided, a triangle is the surface of a solid: it stops only shapes whose centre is on the
  // side from which its vertices run counter-clockwise. Two-sided, it is a sheet that stops shapes
  // from either side, but does not push back shapes that have passed through.
  bool two_sided = false;
  // A triangle without area has two coincident or three collinear vertices. False: such triangles
  // are omitted; true: a mesh that has any is an error.
  bool reject_degenerate = false;
};

// Triangles that share vertices. A handle: copies share the same constant data. Any number of
// colliders, worlds and threads may use it, each with its own scale.
//
// Adjacency follows from positions: vertices that are equal bit for bit are one. An edge shared by
// two triangles that is flat or concave is not active: a shape that slides over it collides with
// the faces only. An edge of one triangle, or of more than two, is a border, which is active.
class TriangleMesh {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  // Errors: no triangles or more than 2^26; more than 2^26 vertices; vertices that are not finite
  // or beyond 1e9 m; vertex indices out of range; a mesh in which no triangle has an area.
  [[nodiscard]] static Expected<TriangleMesh> of(std::span<const Vec3> vertices,
                                                 std::span<const Triangle> triangles,
                                                 const MeshOptions& options = {});

  // The same data, scaled along the axes of the mesh's frame. The factors multiply the current
  // scale. Errors: factors, or products of them, outside [1e-6, 1e6].
  [[nodiscard]] Expected<TriangleMesh> scaled(const Vec3& factors) const;

  // Precondition of all functions below: not moved from.
  const Vec3& scale() const { return scale_; }
  std::span<const Vec3> vertices() const;  // as given, not scaled
  // As given, except that of coincident vertices the first is named. A contact's sub-shape is an
  // index into this list.
  std::span<const Triangle> triangles() const;
  std::size_t left_out() const;  // number of triangles without area
  bool two_sided() const;
  // Each edge has two triangles, which traverse it in opposite directions: the mesh has an inside.
  bool closed() const;

  double volume() const;  // [m^3]; of a closed mesh, > 0 if its triangles face outwards
  // Inertia of the enclosed solid, of uniform density [kg/m^3], about the frame's origin. Errors:
  // the mesh is not closed, or its triangles face inwards.
  [[nodiscard]] Expected<Inertia> inertia(double density) const;

  // For the engine. Null if moved from.
  const std::shared_ptr<const collide::MeshData>& data() const { return data_; }

 private:
  explicit TriangleMesh(std::shared_ptr<const collide::MeshData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collide::MeshData> data_;
  Vec3 scale_{1.0, 1.0, 1.0};
};

}  // namespace vp
