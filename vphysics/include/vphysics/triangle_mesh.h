// Surfaces of triangles, for what does not move. Lengths in metres.
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
  // One-sided, a triangle is the skin of something solid: it stops what has its middle on the side
  // from which its corners run counter-clockwise, and nothing else. Two-sided, it is a sheet that
  // stops what comes from either side, but does not hold what has come through.
  bool two_sided = false;
  // Triangles without area (two corners in one place, or all on a line) are left out, or else the
  // mesh that has any is refused.
  bool reject_degenerate = false;
};

// Triangles that share corners. A handle: copies share the same constant data, which may be used by
// any number of colliders, worlds and threads, each with its own scale.
//
// Neighbours are known by their corners: those in the same place bit for bit are one. Across an
// edge that two triangles share and that is flat or goes inwards nothing is felt: what slides over
// them meets their faces alone. An edge that one or more than two triangles have is a border, which
// is felt as it is.
class TriangleMesh {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  // Refused: no triangles or more than 2^26, more than 2^26 vertices, vertices that are not finite
  // or beyond 1e9 m, indices of no vertex, a mesh of which all triangles have no area.
  [[nodiscard]] static Expected<TriangleMesh> of(std::span<const Vec3> vertices,
                                                 std::span<const Triangle> triangles,
                                                 const MeshOptions& options = {});

  // The same data, stretched along the axes of the mesh's frame; factors multiply those that it has
  // already. Refused: factors, or products of them, that are not in [1e-6, 1e6].
  [[nodiscard]] Expected<TriangleMesh> scaled(const Vec3& factors) const;

  // Precondition of all below: not moved from.
  const Vec3& scale() const { return scale_; }
  std::span<const Vec3> vertices() const;  // as given, not scaled
  // As given, but for corners in one place, of which the first is named. A contact's sub-shape is
  // an index of these.
  std::span<const Triangle> triangles() const;
  std::size_t left_out() const;  // number of triangles without area
  bool two_sided() const;
  // Each edge has two triangles, which run along it in opposite ways: then it has an inside.
  bool closed() const;

  double volume() const;  // [m^3]; of a closed mesh, > 0 if its triangles face outwards
  // Of what is inside, of uniform density [kg/m^3], about the frame's origin. Refused: a mesh that
  // is not closed, or inside out.
  [[nodiscard]] Expected<Inertia> inertia(double density) const;

  // For the engine; null if moved from.
  const std::shared_ptr<const collide::MeshData>& data() const { return data_; }

 private:
  explicit TriangleMesh(std::shared_ptr<const collide::MeshData> data) : data_(std::move(data)) {}
  std::shared_ptr<const collide::MeshData> data_;
  Vec3 scale_{1.0, 1.0, 1.0};
};

}  // namespace vp
