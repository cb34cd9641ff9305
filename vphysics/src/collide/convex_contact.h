// Manifolds of what has no routine of its own: boxes, hulls, cylinders, cones and capsules in any
// pair. All in the frame of a.
#pragma once

#include "collide/gjk.h"
#include "collide/manifold.h"
#include "collide/patch.h"

namespace vp::collide {

// A face's normal is as good as the best axis found if its gap is this little less.
inline constexpr double kFaceRelative = 0.05;  // of the separation
inline constexpr double kFaceAbsolute = 1e-5;  // of the smaller shape's size

struct ContactQuery {
  const CorePair& pair;
  double margin;
  double radii;  // of both cores together

  ContactQuery(const CorePair& p, double m)
      : pair(p), margin(m), radii(core_radius(p.a) + core_radius(p.b)) {}

  // Of the cores' gap along a face's normal, where the best is best.
  bool face_suffices(double separation, double best) const {
    return separation >= best - kFaceRelative * std::fabs(best - radii) - kFaceAbsolute * pair.size;
  }
  // A manifold tells the separation if its deepest point is as little above it.
  bool tells(const Manifold& m, double best) const {
    double deepest = 1e300;
    for (int i = 0; i < m.count; ++i) deepest = std::min(deepest, m.points[i].separation);
    const double separation = best - radii;
    return deepest <=
           separation + kFaceRelative * std::fabs(separation) + kFaceAbsolute * pair.size;
  }
  // How much wider the gap along a face of b must be than that along one of a.
  double face_bias() const { return kFaceAbsolute * pair.size; }
};

// The axis along which the cores are farthest apart, or overlap least, and points of them there.
struct BestAxis {
  double separation;  // of the cores; less than 0: penetration
  Vec3 normal;        // unit, from a to b
  Vec3 on_a, on_b;
};

// Two polytopes that overlap: the best face of both, and the best two edges, if better than it.
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

// The patch over a face of a or of b; normal is from a to b. False, and nothing added, if what lies
// over it is not as deep as the cores' gap along the best axis.
bool add_face_contact(const ContactQuery& query, bool face_of_a, const Feature& face,
                      const Vec3& normal, double best_separation, Manifold& manifold);
// The foremost point of the other shape, and where it lies over the face.
BestAxis axis_of_face(const CorePair& pair, const FaceAxis& face);
// The patch around the nearest points, if these are within the margin.
void add_contact_along(const ContactQuery& query, const BestAxis& axis, Manifold& manifold);

// As find_manifold. Precondition: neither is a half-space.
void collide_convex(const CorePair& pair, double margin, PairCache& cache, Manifold& manifold);
// What to do about cores that gjk finds apart.
void collide_separated(const ContactQuery& query, const GjkResult& found, PairCache& cache,
                       Manifold& manifold);
// Two boxes (box_box.cpp).
void collide_boxes(const CorePair& pair, double margin, PairCache& cache, Manifold& manifold);

// A direction from a to b to begin with: the last one, or between their middles.
Vec3 first_direction(const CorePair& pair, const PairCache& cache);
void remember(PairCache& cache, const Vec3& normal, PairCache::Feature feature = PairCache::none,
              int i = 0, int j = 0);

}  // namespace vp::collide
