// Tests each triangle near the shape on its own. Then removes contacts that the exit of another
// contact resolves too, and merges contacts with the same normal.
#include "collide/surface_manifolds.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "collide/bounds.h"
#include "collide/corner_over_face.h"
#include "collide/support.h"
#include "collide/triangle_cull.h"
#include "collide/triangle_sweep.h"

namespace vp::collide {
namespace {

using Contact = ManifoldScratch::Contact;

// Normals of one manifold: the cosine of 2 degrees.
constexpr double kSameNormal = 0.99939;
// Points closer than this [fraction of the shape's size] are one; a smaller depth counts as zero.
constexpr double kSamePoint = 1e-6;
// Contacts are close if their deepest points are at most this many depths apart.
constexpr double kNear = 4.0;
// The factor by which a point must be farther out to replace another.
constexpr double kClearly = 1.0 + 1e-6;
// A point less than this [fraction of the shape's size] deeper than the others is level with them.
constexpr double kLevel = 5e-4;
// The maximum number of manifolds of a cluster, with four points each.
constexpr int kMaxManifoldsOfCluster = 4;

// Every triangle at an active edge or corner finds it: the contact with the least depth is kept.
void add_contact(const Contact& contact, std::vector<Contact>& contacts) {
  if (contact.contact.active_part != TriangleContact::kFace) {
    for (Contact& c : contacts) {
      if (c.contact.active_part != contact.contact.active_part) continue;
      if (contact.contact.separation > c.contact.separation) c = contact;
      return;
    }
  }
  contacts.push_back(contact);
}

Bounds searched_bounds(const ShapeOnSurface& on, const SweptMargin& margin) {
  Bounds box = bounds_of(on.shape, on.T_surface_shape);
  if (margin.moves)
    box = merged(box, bounds_of(on.shape, margin.displacement * on.T_surface_shape));
  return grown(box, margin.bounds.slack);
}

void find_contacts(const Surface& surface, const ShapeOnSurface& on, const SweptMargin& margin,
                   ManifoldScratch& scratch) {
  const Geometry& shape = on.shape;
  const SE3& T = on.T_surface_shape;
  scratch.triangles.clear();
  scratch.near_triangles.clear();
  scratch.contacts.clear();
  scratch.points.clear();
  scratch.converged.clear();
  surface.overlapping(searched_bounds(on, margin),
                      [&](std::uint32_t id) { scratch.triangles.push_back(id); });
  if (scratch.triangles.empty()) return;
  scratch.triangles_tested += static_cast<std::uint32_t>(scratch.triangles.size());
  const TriangleCull cull(shape, T, margin);
  for (const std::uint32_t id : scratch.triangles) {
    Vec3 p[3];
    surface.corners(id, p);
    if (cull.may_overlap(p)) scratch.near_triangles.push_back(id);
  }
  std::sort(scratch.near_triangles.begin(), scratch.near_triangles.end());
  const Vec3 centre = T * core_centre(shape);
  for (const std::uint32_t id : scratch.near_triangles) {
    SurfaceTriangle t = surface.triangle(id);
    if (!face_towards(t, centre, surface.two_sided())) continue;
    const TriangleContact found = sweep_triangle(surface, t, on, margin, scratch.points);
    scratch.rough |= found.rough;
    if (found.count > 0) add_contact({found, id, 0}, scratch.contacts);
  }
}

// For overlaps, removes contacts that a shorter exit of a close contact resolves too: near an edge
// or a corner, triangles that do not contain it find only longer exits.
class Pruning {
 public:
  Pruning(const Surface& surface, const ShapeOnSurface& on, double size, ManifoldScratch& scratch)
      : surface_(surface), on_(on), same_(kSamePoint * size), scratch_(scratch) {
    scratch_.planes.clear();
  }

  void prune() {
    std::vector<Contact>& contacts = scratch_.contacts;
    for (Contact& longer : contacts) {
      if (!(longer.contact.separation < -same_)) continue;
      const bool resolved =
          std::any_of(contacts.begin(), contacts.end(),
                      [&](const Contact& shorter) { return resolves(shorter, longer); });
      if (resolved) longer.triangle = ManifoldScratch::kNoTriangle;
    }
    std::erase_if(contacts,
                  [](const Contact& c) { return c.triangle == ManifoldScratch::kNoTriangle; });
  }

 private:
  bool resolves(const Contact& shorter, const Contact& longer);
  void find_planes();
  const ManifoldPoint& deepest(const Contact& c) const;

  const Surface& surface_;
  const ShapeOnSurface& on_;
  double same_;
  ManifoldScratch& scratch_;
  std::optional<std::size_t> left_overlapping_;  // a triangle
};

const ManifoldPoint& Pruning::deepest(const Contact& c) const {
  const ManifoldPoint* p = &scratch_.points[c.contact.first_point];
  return *std::min_element(p, p + c.contact.count, [](const auto& a, const auto& b) {
    return a.separation < b.separation;
  });
}

// Of all triangles near the shape.
void Pruning::find_planes() {
  const SE3& T = on_.T_surface_shape;
  int hint = 0;
  for (const std::uint32_t id : scratch_.triangles) {
    const SurfaceTriangle t = surface_.triangle(id);
    const Vec3 nearest = core_support(on_.shape, -T.unrotate(t.normal), hint);
    const Vec3 from_corner = (T.position() - t.p[0]) + T.rotate(nearest);
    scratch_.planes.push_back({t.normal, dot(t.normal, from_corner) - core_radius(on_.shape)});
  }
}

bool Pruning::resolves(const Contact& shorter, const Contact& longer) {
  if (shorter.triangle == ManifoldScratch::kNoTriangle) return false;
  const TriangleContact &s = shorter.contact, &l = longer.contact;
  if (!(s.separation < -same_) || s.separation <= l.separation ||
      dot(s.normal, l.normal) > kSameNormal)
    return false;
  const Vec3 offset = deepest(shorter).position - deepest(longer).position;
  if (dot(offset, offset) > kNear * kNear * l.separation * l.separation) return false;
  const Vec3 exit = (same_ - s.separation) * s.normal;
  const SE3& T = on_.T_surface_shape;
  const SE3 T_moved(T.rotation(), T.position() + exit);
  const ShapeOnSurface moved{on_.shape, T_moved, on_.faces};
  if (l.active_part != TriangleContact::kFace) {
    return !overlaps_triangle(surface_.triangle(longer.triangle), moved);
  }
  // A face continues over inactive edges: none of the triangles along its normal may still
  // overlap. The planes of most separate them from the shape.
  if (scratch_.planes.empty()) find_planes();
  const auto still_overlaps = [&](std::size_t i) {
    const ManifoldScratch::Plane& plane = scratch_.planes[i];
    return std::fabs(dot(plane.normal, l.normal)) > kSameNormal &&
           plane.separation + dot(exit, plane.normal) <= 0.0 &&
           overlaps_triangle(surface_.triangle(scratch_.triangles[i]), moved);
  };
  // What the last exit has left overlapping, this one probably does too.
  if (left_overlapping_ && still_overlaps(*left_overlapping_)) return false;
  for (std::size_t i = 0; i < scratch_.planes.size(); ++i) {
    if (!still_overlaps(i)) continue;
    left_overlapping_ = i;
    return false;
  }
  return true;
}

// Assigns each contact to the first cluster with nearly its normal or, after the last cluster, to
// the one with the closest normal.
std::uint32_t find_clusters(std::vector<Contact>& contacts, bool& crowded) {
  Vec3 normals[kMaxClusters];
  std::uint32_t count = 0;
  for (Contact& c : contacts) {
    c.cluster = count;
    double largest = count < kMaxClusters ? kSameNormal : -2.0;
    for (std::uint32_t k = 0; k < count; ++k) {
      const double along = dot(normals[k], c.contact.normal);
      if (along <= largest) continue;
      largest = along;
      c.cluster = k;
    }
    if (c.cluster == count) normals[count++] = c.contact.normal;
    crowded |= largest < kSameNormal;
  }
  return count;
}

// The points of a cluster. A few of them represent all: points between them that are no deeper stay
// less deep, however the shape tilts. On a crest, whose facets are in one cluster, the points on
// the crest are deeper than those on its sides: a second manifold contains them.
class Cluster {
 public:
  Cluster(ManifoldScratch& scratch, std::uint32_t cluster, double size)
      : scratch_(scratch), cluster_(cluster), same_(kSamePoint * size), level_(kLevel * size) {
    scratch_.converged.resize(scratch_.points.size());
  }

  // Appends manifolds until all points are contained or represented.
  void reduce(std::vector<SubManifold>& manifolds);

 private:
  // Calls f for the remaining points.
  template <class F>
  void for_each(const F& f) const {
    for (const Contact& c : scratch_.contacts) {
      if (c.cluster != cluster_) continue;
      for (std::size_t i = 0; i < c.contact.count; ++i) {
        const std::size_t index = c.contact.first_point + i;
        if (scratch_.converged[index] == 0) f(scratch_.points[index], c);
      }
    }
  }
  // Four points of maximum span, including the deepest.
  SubManifold reduced() const;
  // Returns whether any point remains.
  bool settle(const Manifold& manifold);
  const ManifoldPoint* farthest_from(const Vec3& from) const;
  void span_farthest(const ManifoldPoint& deepest, const Vec3& normal,
                     const ManifoldPoint* (&chosen)[4]) const;

  ManifoldScratch& scratch_;
  std::uint32_t cluster_;
  double same_, level_;
};

void Cluster::reduce(std::vector<SubManifold>& manifolds) {
  bool left = true;
  for (int k = 0; k < kMaxManifoldsOfCluster && left; ++k) {
    manifolds.push_back(reduced());
    left = settle(manifolds.back().manifold);
  }
}

// The component perpendicular to the manifold's normal.
Vec3 tangential(const Manifold& m, const Vec3& v) {
  return v - dot(v, m.normal) * m.normal;
}

// The separation at a position in the plane of three of a manifold's points.
struct InPlane {
  bool between;  // the position is in their triangle
  double separation;
};
std::optional<InPlane> in_plane_of(const Manifold& m, const int (&corner)[3], const Vec3& at,
                                   double same) {
  double area[3], sum = 0.0;  // of the triangles that the position forms with two of them
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = m.points[corner[(k + 1) % 3]].position - at;
    const Vec3 b = m.points[corner[(k + 2) % 3]].position - at;
    area[k] = dot(m.normal, cross(a, b));
    sum += area[k];
  }
  if (std::fabs(sum) <= same * same) return std::nullopt;
  InPlane found{true, 0.0};
  for (int k = 0; k < 3; ++k) {
    const double weight = area[k] / sum;
    found.between = found.between && weight >= 0.0;
    found.separation += weight * m.points[corner[k]].separation;
  }
  return found;
}

// The separation at the closest position on the segments between a manifold's points.
double beside_all(const Manifold& m, const Vec3& at) {
  double separation = m.points[0].separation, smallest = kFar;
  for (int i = 0; i < m.count; ++i) {
    for (int j = i; j < m.count; ++j) {
      const Vec3 along = tangential(m, m.points[j].position - m.points[i].position);
      const Vec3 offset = tangential(m, at - m.points[i].position);
      const double length = dot(along, along);
      const double t = length > 0.0 ? std::clamp(dot(along, offset) / length, 0.0, 1.0) : 0.0;
      const Vec3 beside = offset - t * along;
      if (dot(beside, beside) >= smallest) continue;
      smallest = dot(beside, beside);
      separation = (1.0 - t) * m.points[i].separation + t * m.points[j].separation;
    }
  }
  return separation;
}

// The separation that a manifold's points represent at a position. Between them it is the lowest
// plane through three of them, since the shape is supported there; beside them it is the highest
// such plane.
double stood_for_at(const Manifold& m, const Vec3& at, double same) {
  constexpr int kTriangles[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  std::optional<double> between, beside;
  for (int k = 0; k < (m.count == 4 ? 4 : m.count == 3 ? 1 : 0); ++k) {
    const std::optional<InPlane> found = in_plane_of(m, kTriangles[k], at, same);
    if (!found) continue;
    if (found->between) between = std::min(found->separation, between.value_or(kFar));
    if (!found->between) beside = std::max(found->separation, beside.value_or(-kFar));
  }
  if (between) return *between;
  return beside ? *beside : beside_all(m, at);
}

bool Cluster::settle(const Manifold& manifold) {
  bool left = false;
  for (const Contact& c : scratch_.contacts) {
    if (c.cluster != cluster_) continue;
    for (std::size_t i = 0; i < c.contact.count; ++i) {
      const std::size_t index = c.contact.first_point + i;
      if (scratch_.converged[index] != 0) continue;
      const ManifoldPoint& p = scratch_.points[index];
      const bool deeper = p.separation < stood_for_at(manifold, p.position, same_) - level_;
      scratch_.converged[index] = deeper ? 0 : 1;
      left |= deeper;
    }
  }
  return left;
}

const ManifoldPoint* Cluster::farthest_from(const Vec3& from) const {
  const ManifoldPoint* best = nullptr;
  double largest = same_ * same_;
  for_each([&](const ManifoldPoint& p, const Contact&) {
    const Vec3 offset = p.position - from;
    if (dot(offset, offset) <= largest * kClearly) return;
    largest = dot(offset, offset);
    best = &p;
  });
  return best;
}

// The farthest from the deepest point, the farthest from that one, and the farthest on either side
// of the line between them.
void Cluster::span_farthest(const ManifoldPoint& deepest, const Vec3& normal,
                            const ManifoldPoint* (&chosen)[4]) const {
  chosen[0] = farthest_from(deepest.position);
  if (!chosen[0]) {
    chosen[0] = &deepest;
    return;
  }
  const Vec3 from = chosen[0]->position;
  chosen[1] = farthest_from(from);
  const Vec3 side = cross(normal, chosen[1]->position - from);
  double left = same_ * norm(side), right = -left;
  for_each([&](const ManifoldPoint& p, const Contact&) {
    const double s = dot(side, p.position - from);
    if (s > left * kClearly) left = s, chosen[2] = &p;
    if (s < right * kClearly) right = s, chosen[3] = &p;
  });
}

SubManifold Cluster::reduced() const {
  SubManifold found;
  const ManifoldPoint* deepest = nullptr;
  for_each([&](const ManifoldPoint& p, const Contact& c) {
    if (deepest && p.separation >= deepest->separation - same_) return;
    deepest = &p;
    found.sub_a = c.triangle;
    found.manifold.normal = c.contact.normal;
  });
  const ManifoldPoint* chosen[4] = {};
  span_farthest(*deepest, found.manifold.normal, chosen);
  const ManifoldPoint** nearest = nullptr;  // the closest to the deepest: replaced by it
  double smallest = 0.0;
  bool told = false;
  for (const ManifoldPoint*& p : chosen) {
    if (!p) continue;
    told = told || p->separation <= deepest->separation + same_;
    const Vec3 offset = p->position - deepest->position;
    if (nearest && dot(offset, offset) >= smallest) continue;
    nearest = &p;
    smallest = dot(offset, offset);
  }
  if (!told) *nearest = deepest;
  for (const ManifoldPoint* p : chosen) {
    if (p) found.manifold.points[found.manifold.count++] = *p;
  }
  return found;
}

}  // namespace

void collide_surface(const Surface& surface, const Geometry& shape, const SE3& T,
                     const SweptMargin& margin, ManifoldScratch& scratch,
                     std::vector<SubManifold>& manifolds) {
  const double size = core_extent(shape) + core_radius(shape);
  scratch.ensure_capacity();
  std::optional<PolytopeOf> polytope;
  if (has_few_flat_faces(shape)) polytope.emplace(shape);
  const ShapeOnSurface on{shape, T, polytope ? &polytope->view() : nullptr};
  find_contacts(surface, on, margin, scratch);
  if (scratch.contacts.size() > 1) Pruning(surface, on, size, scratch).prune();
  const std::uint32_t clusters = find_clusters(scratch.contacts, scratch.crowded);
  for (std::uint32_t c = 0; c < clusters; ++c) {
    Cluster(scratch, c, size).reduce(manifolds);
  }
}

}  // namespace vp::collide
