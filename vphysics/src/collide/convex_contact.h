// Manifolds of convex shapes without a special routine: boxes, hulls, cylinders, cones and capsules
// in any pair. All in the frame of a.
#pragma once

#include "collide/gjk.h"
#include "collide/manifold.h"
#include "collide/patch.h"

namespace vp::collide {

// A face's normal replaces the best axis if its separation is at most this much smaller.
inline constexpr double kFaceRelative = 0.05;  // of the separation
inline constexpr double kFaceAbsolute = 1e-5;  // of the smaller shape's size

struct ContactQuery {
  const CorePair& pair;
  double margin;  // the largest search distance
  double radii;   // sum of both cores' radii

  ContactQuery(const CorePair& p, double m)
      : pair(p), margin(m), radii(core_radius(p.a) + core_radius(p.b)) {}

  // Whether the separation of the cores along a face's normal is close enough to the best one.
  bool face_suffices(double separation, double best) const {
    return separation >= best - kFaceRelative * std::fabs(best - radii) - kFaceAbsolute * pair.size;
  }
  // Whether the manifold's deepest point represents the best separation: it is close enough above
  // it.
  bool tells(const Manifold& m, double best) const {
    double deepest = 1e300;
    for (int i = 0; i < m.count; ++i) deepest = std::min(deepest, m.points[i].separation);
    const double separation = best - radii;
    return deepest <=
           separation + kFaceRelative * std::fabs(separation) + kFaceAbsolute * pair.size;
  }
  // How much larger the separation along a face of b must be than along one of a.
  double face_bias() const { return kFaceAbsolute * pair.size; }
};

// The axis of maximum separation of the cores, or of minimum penetration, and points on them.
struct BestAxis {
  double separation;  // of the cores; negative: penetration
  Vec3 normal;        // unit, from a to b
  Vec3 on_a, on_b;
};

// For two overlapping polytopes: the best face of both, and the best pair of edges if it is better.
struct FaceAxis {
  double separation = 0.0;
  Vec3 normal;  // unit, from a to b
  bool of_a = true;
  int face = 0;
};
struct EdgeAxis {
  bool better = false;  // than the best face
  int i = 0, j = 0;     // edges of a and of b
  BestAxis axis{};
};
void find_overlap_axes(const CorePair& pair, double bias, const PairCache& cache, FaceAxis& face,
                       EdgeAxis& edge);

// Adds the patch over a face of a or of b; normal is from a to b. Returns false and adds nothing if
// the patch is less deep than the cores' separation along the best axis.
bool add_face_contact(const ContactQuery& query, bool face_of_a, const Feature& face,
                      const Vec3& normal, double best_separation, Manifold& manifold);
// The foremost point of the other shape, and its projection on the face.
BestAxis axis_of_face(const CorePair& pair, const FaceAxis& face);
// Adds the patch around the closest points, if these are within the margin.
void add_contact_along(const ContactQuery& query, const BestAxis& axis, Manifold& manifold);

// As find_manifold. Precondition: neither is a half-space.
void collide_convex(const CorePair& pair, const PairMargin& margin, PairCache& cache,
                    Manifold& manifold);
// Adds the contact of cores that GJK has found separated, if they may touch.
void collide_separated(const ContactQuery& query, const PairMargin& margin, const GjkResult& found,
                       PairCache& cache, Manifold& manifold);
// Whether the cores may touch, though n separates them by so much.
inline bool may_touch(const ContactQuery& q, const PairMargin& margin, double separation,
                      const Vec3& n) {
  const SE3 T_a;
  return margin.may_touch(separation - q.radii, n, {q.pair.a, T_a}, {q.pair.b, q.pair.T_a_b});
}
// Two boxes (box_box.cpp).
void collide_boxes(const CorePair& pair, const PairMargin& margin, PairCache& cache,
                   Manifold& manifold);

// The initial search direction from a to b: the cached one, or between the centres.
Vec3 first_direction(const CorePair& pair, const PairCache& cache);
void remember(PairCache& cache, const Vec3& normal, PairCache::Feature feature = PairCache::none,
              int i = 0, int j = 0);

}  // namespace vp::collide
