#include "collide/convex_contact.h"

#include <cmath>
#include <limits>

#include "collide/corner_over_face.h"
#include "collide/epa.h"
#include "collide/polytope.h"

namespace vp::collide {
namespace {

// The face normal with the larger separation, of the two features' normals.
bool find_face_axis(const ContactQuery& q, const Feature& a, const Feature& b, FaceAxis& best) {
  bool found = false;
  for (const bool of_a : {true, false}) {
    const Feature& f = of_a ? a : b;
    if (f.count < 3) continue;
    const Vec3 n = of_a ? f.normal() : -f.normal();
    const double separation = separation_along(q.pair, n);
    if (found && !(separation > best.separation + q.face_bias())) continue;
    best = {separation, n, of_a, 0};
    found = true;
  }
  return found;
}

void features_along(const ContactQuery& q, const Vec3& n, Feature& a, Feature& b) {
  find_feature(q.pair.a, SE3{}, n, a);
  find_feature(q.pair.b, q.pair.T_a_b, -q.pair.T_a_b.unrotate(n), b);
}

PatchQuery patch_query(const ContactQuery& q, const Feature& a, const Feature& b, const Vec3& n) {
  return {a,  b,  n,  core_radius(q.pair.a), core_radius(q.pair.b), q.margin, q.pair.size,
          {}, {}, 0.0};
}

void add_patch(const ContactQuery& q, const BestAxis& axis, const Feature& a, const Feature& b,
               Manifold& m) {
  PatchQuery patch = patch_query(q, a, b, axis.normal);
  patch.on_a = axis.on_a;
  patch.on_b = axis.on_b;
  patch.core_separation = axis.separation;
  m.normal = axis.normal;
  find_patch(patch, true, m);
}

// Adds a contact along the axis, or along the normal of a face there if that suffices.
void add_contact(const ContactQuery& q, const BestAxis& axis, Manifold& m) {
  Feature a, b;
  features_along(q, axis.normal, a, b);
  FaceAxis face;
  if (find_face_axis(q, a, b, face) && q.face_suffices(face.separation, axis.separation)) {
    if (add_face_contact(q, face.of_a, face.of_a ? a : b, face.normal, axis.separation, m)) return;
  }
  add_patch(q, axis, a, b, m);
}

// For overlapping cores that are not two polytopes. A face along the cached normal gives an upper
// bound of the depth: the search stops where nothing significantly better exists.
void collide_overlapping(const ContactQuery& q, const Simplex& simplex, const Vec3& last,
                         PairCache& cache, Manifold& m) {
  Feature a, b;
  features_along(q, last, a, b);
  FaceAxis face;
  const bool found = find_face_axis(q, a, b, face);
  if (found) {
    const double slack = kFaceAbsolute * q.pair.size + kFaceRelative * q.radii;
    const Penetration p = epa(q.pair, simplex, (-face.separation - slack) / (1.0 + kFaceRelative));
    if (q.face_suffices(face.separation, -p.at_least)) {
      remember(cache, face.normal);
      if (add_face_contact(q, face.of_a, face.of_a ? a : b, face.normal, -p.at_least, m)) return;
    }
  }
  const Penetration p = epa(q.pair, simplex, std::numeric_limits<double>::infinity());
  remember(cache, p.normal);
  add_contact(q, {-p.depth, p.normal, p.on_a, p.on_b}, m);
}

void collide_polytopes(const ContactQuery& q, PairCache& cache, Manifold& m) {
  FaceAxis face;
  EdgeAxis edge;
  find_overlap_axes(q.pair, q.face_bias(), cache, face, edge);
  const double best = edge.better ? edge.axis.separation : face.separation;
  if (q.face_suffices(face.separation, best)) {
    remember(cache, face.normal, face.of_a ? PairCache::face_of_a : PairCache::face_of_b,
             face.face);
    Feature feature;
    face_feature(face.of_a ? q.pair.a : q.pair.b, face.of_a ? SE3{} : q.pair.T_a_b, face.face,
                 feature);
    if (add_face_contact(q, face.of_a, feature, face.normal, best, m)) return;
  }
  if (edge.better) {
    remember(cache, edge.axis.normal, PairCache::edges, edge.i, edge.j);
    add_contact_along(q, edge.axis, m);
  } else {
    add_contact_along(q, axis_of_face(q.pair, face), m);
  }
}

// Whether p is in the polytope; false for hulls of many or merged faces.
bool holds(const Geometry& polytope, const Vec3& p) {
  if (polytope.kind == Kind::box) {
    const Vec3& half = polytope.half;
    return std::fabs(p.x) <= half.x && std::fabs(p.y) <= half.y && std::fabs(p.z) <= half.z;
  }
  return has_few_flat_faces(polytope) &&
         planes_behind(polytope.hull->scanned_faces, 0, p, p, 0.0) == 0;
}
// Proves that two overlap. p: a corner of each.
bool one_has_corner_of_other(const CorePair& pair, const CorePoint& p) {
  return holds(pair.a, p.b()) || holds(pair.b, inverse_times(pair.T_a_b, p.a));
}

bool is_direction(const Vec3& v) {
  const double n2 = dot(v, v);
  return n2 > 0.5 && n2 < 2.0;  // false for NaN
}

}  // namespace

bool add_face_contact(const ContactQuery& q, bool face_of_a, const Feature& face,
                      const Vec3& normal, double best_separation, Manifold& m) {
  Feature other;
  if (face_of_a) {
    find_feature(q.pair.b, q.pair.T_a_b, -q.pair.T_a_b.unrotate(normal), other);
  } else {
    find_feature(q.pair.a, SE3{}, normal, other);
  }
  m.normal = normal;
  find_patch(patch_query(q, face_of_a ? face : other, face_of_a ? other : face, normal), false, m);
  if (q.tells(m, best_separation)) return true;
  m.count = 0;
  return false;
}

BestAxis axis_of_face(const CorePair& pair, const FaceAxis& face) {
  const CorePoint p = support_of(pair, face.normal);
  return face.of_a
             ? BestAxis{face.separation, face.normal, p.b() - face.separation * face.normal, p.b()}
             : BestAxis{face.separation, face.normal, p.a, p.a + face.separation * face.normal};
}

void add_contact_along(const ContactQuery& q, const BestAxis& axis, Manifold& m) {
  if (axis.separation - q.radii > q.margin) return;
  Feature a, b;
  features_along(q, axis.normal, a, b);
  add_patch(q, axis, a, b, m);
}

Vec3 first_direction(const CorePair& pair, const PairCache& cache) {
  const Vec3 last{cache.normal[0], cache.normal[1], cache.normal[2]};
  if (is_direction(last)) return (1.0 / norm(last)) * last;
  const Vec3 v = pair.T_a_b * core_centre(pair.b) - core_centre(pair.a);
  const double length = norm(v);
  return length > 0.0 ? (1.0 / length) * v : Vec3{0, 0, 1};
}

void remember(PairCache& cache, const Vec3& normal, PairCache::Feature feature, int i, int j) {
  cache = {};
  for (int k = 0; k < 3; ++k) cache.normal[k] = static_cast<float>(normal[k]);
  cache.feature = feature;
  cache.i = static_cast<std::uint16_t>(i);
  cache.j = static_cast<std::uint16_t>(j);
}

void collide_separated(const ContactQuery& q, const PairMargin& margin, const GjkResult& found,
                       PairCache& cache, Manifold& m) {
  remember(cache, found.normal);
  m.normal = found.normal;
  m.min_separation = found.distance - q.radii;
  if (found.state == GjkResult::State::beyond) return;
  if (!may_touch(q, margin, found.distance, found.normal)) return;
  add_contact(q, {found.distance, found.normal, found.on_a, found.on_b}, m);
}

void collide_convex(const CorePair& pair, const PairMargin& margin, PairCache& cache, Manifold& m) {
  const ContactQuery q(pair, margin.largest());
  const Vec3 last = first_direction(pair, cache);
  const CorePoint first = support_of(pair, last);
  const double separation = -dot(last, first.w);
  if (!may_touch(q, margin, separation, last)) {
    m.normal = last;
    m.min_separation = separation - q.radii;
    return;
  }
  if (is_polytope(pair.a) && is_polytope(pair.b) && separation <= 0.0 &&
      one_has_corner_of_other(pair, first)) {
    return collide_polytopes(q, cache, m);
  }
  const GjkResult found = gjk(pair, last, first, q.margin + q.radii);
  if (found.state != GjkResult::State::overlaps) {
    collide_separated(q, margin, found, cache, m);
  } else if (is_polytope(pair.a) && is_polytope(pair.b)) {
    collide_polytopes(q, cache, m);
  } else {
    collide_overlapping(q, found.simplex, last, cache, m);
  }
}

}  // namespace vp::collide
