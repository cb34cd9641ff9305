// Manifolds of any two shapes: one of two convex ones, any number where one is made of parts.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "collide/manifold.h"
#include "collide/triangle_contact.h"

namespace vp::collide {

// Between a part of a and a part of b: a part of a compound, a triangle of a mesh or a height field
// (of several triangles that lie in one plane, the one with the deepest point); 0 of others.
struct SubManifold {
  Manifold manifold;
  std::uint32_t sub_a = 0, sub_b = 0;
  PairCache cache;  // of parts that are both convex and no triangles
};

// What such a call has left for the next one about the same pair.
struct KnownPart {
  std::uint32_t sub_a, sub_b;
  PairCache cache;
};

// Memory of find_manifolds, kept by whoever calls it. Between calls there is nothing in it.
struct ManifoldScratch {
  std::vector<std::uint32_t> triangles, near_triangles, parts;
  // Of a surface: what touches each triangle, and the number of the manifold that it becomes part
  // of.
  struct Contact {
    TriangleContact contact;
    std::uint32_t triangle, cluster;
  };
  static constexpr std::uint32_t kNoTriangle = ~0u;
  std::vector<Contact> contacts;
  std::vector<ManifoldPoint> points;
  // Of each point, 1: a manifold has it, or points that stand for it.
  std::vector<std::uint8_t> converged;
  // For whoever wants to know: triangles, counted up; set, that there were more normals than
  // kMaxClusters, and that of a triangle CorePair::rough was set.
  std::uint32_t narrow_phase_pairs = 0;
  bool crowded = false, rough = false;

  // For more than one shape meets of a surface that is not far finer than the shape is big, so that
  // a step with more of it than any before takes nothing from the heap.
  void ensure_capacity() {
    triangles.reserve(512);
    near_triangles.reserve(512);
    contacts.reserve(128);
    points.reserve(256);
    converged.reserve(256);
  }
};

// How far apart [m] what is looked for may be: so far that what closes in until the next look has
// been found before.
struct SearchMargin {
  // The same wherever they meet.
  SearchMargin(double everywhere) : largest(everywhere), at_rest(everywhere) {}
  // b goes against a by displacement + turn x (point - about), world frame [m], [rad].
  SearchMargin(double largest_of_all, double at_rest_of_all, const Vec3& displacement_of_b,
               const Vec3& rotation_of_b, const Vec3& about_point)
      : largest(largest_of_all),
        at_rest(at_rest_of_all),
        displacement(displacement_of_b),
        rotation(rotation_of_b),
        about(about_point) {}

  // Where they meet within a ball, world frame.
  double within(const Vec3& centre, double radius) const {
    const double moved = norm(displacement + cross(rotation, centre - about)) +
                         radius * std::min(norm(rotation), 2.0);  // rotation keeps it in its ball
    return std::min(largest, at_rest + moved);
  }

  double largest, at_rest;
  Vec3 displacement, rotation, about;
};

// More normals than that are never told apart of a surface and one convex shape.
inline constexpr std::size_t kMaxClusters = 12;

// Appends the manifolds with points of a separation of at most margin, of a compound's parts each
// its own, in an order that depends on the shapes and poses alone. Those of triangles that lie in
// one plane, as far as 2 degrees allow, are one. Features have names that no two manifolds of the
// pair share unless by chance, one in 2^32. cache is used where both are convex, known, in any
// order, where they have parts. Two surfaces, or a surface and a half-space, have none.
void find_manifolds(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                    const SearchMargin& margin, PairCache& cache, std::span<const KnownPart> known,
                    ManifoldScratch& scratch, std::vector<SubManifold>& manifolds);

// No more than the distance of two shapes of which at least one has parts: that of the bounds of
// the nearest part from the bounds of the other shape [m]. 0 where that is not known cheaply.
double distance_of_parts(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                         CastScratch& scratch);

// Whether a pair has a manifold for each part, and not one.
inline bool has_parts(const Geometry& a, const Geometry& b) {
  return a.kind >= Kind::mesh || b.kind >= Kind::mesh;
}
// The kind of what touches: of a compound's part, or a triangle.
Kind kind_of_part(const Geometry& geometry, std::uint32_t sub);
// What any sub-shape's number is below.
std::uint32_t number_of_parts(const Geometry& geometry);

}  // namespace vp::collide
