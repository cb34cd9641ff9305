// Each triangle near the shape is asked for itself; then those contacts are left out that another
// one's way out takes away as well, and those of one normal are put together.
#include "collide/surface_manifolds.h"

#include <algorithm>
#include <cmath>

#include "collide/bounds.h"
#include "collide/support.h"

namespace vp::collide {
namespace {

using Contact = ManifoldScratch::Contact;

// Normals of one manifold: within 2 degrees.
constexpr double kSameNormal = 0.99939;
// Points nearer than that [share of the shape's size] are one, and as little is no depth.
constexpr double kSamePoint = 1e-6;
// Contacts are close by whose deepest points are no farther apart than so many depths.
constexpr double kNear = 4.0;
// How much farther a point must lie out [share] to be taken for another.
constexpr double kClearly = 1.0 + 1e-6;

// An edge or a corner that is felt is found by each triangle that has it: the one that needs less
// counts.
void add_contact(const Contact& contact, std::vector<Contact>& contacts) {
  if (contact.contact.felt_part != TriangleContact::kFace) {
    for (Contact& c : contacts) {
      if (c.contact.felt_part != contact.contact.felt_part) continue;
      if (contact.contact.gap > c.contact.gap) c = contact;
      return;
    }
  }
  contacts.push_back(contact);
}

void find_contacts(const Surface& surface, const Geometry& shape, const SE3& T, double margin,
                   ManifoldScratch& scratch) {
  scratch.triangles.clear();
  scratch.contacts.clear();
  scratch.points.clear();
  surface.append_overlapping(grown(bounds_of(shape, T), margin), scratch.triangles);
  scratch.looked_at += static_cast<std::uint32_t>(scratch.triangles.size());
  const Vec3 middle = T * core_middle(shape);
  for (const std::uint32_t id : scratch.triangles) {
    SurfaceTriangle t = surface.triangle(id);
    if (!face_towards(t, middle, surface.two_sided())) continue;
    const TriangleContact found = collide_triangle(surface, t, shape, T, margin, scratch.points);
    scratch.rough |= found.rough;
    if (found.count > 0) add_contact({found, id, 0}, scratch.contacts);
  }
}

// Of what overlaps, leaves out those contacts that a shorter way out, told by another contact close
// by, takes away as well: near an edge or a corner, triangles that do not have it know of longer
// ways only.
class Pruning {
 public:
  Pruning(const Surface& surface, const Geometry& shape, const SE3& T, double size,
          ManifoldScratch& scratch)
      : surface_(surface), shape_(shape), T_(T), same_(kSamePoint * size), scratch_(scratch) {}

  void prune() {
    std::vector<Contact>& contacts = scratch_.contacts;
    for (Contact& longer : contacts) {
      if (!(longer.contact.gap < -same_)) continue;
      const bool resolved =
          std::any_of(contacts.begin(), contacts.end(),
                      [&](const Contact& shorter) { return resolves(shorter, longer); });
      if (resolved) longer.triangle = ManifoldScratch::kNoTriangle;
    }
    std::erase_if(contacts,
                  [](const Contact& c) { return c.triangle == ManifoldScratch::kNoTriangle; });
  }

 private:
  bool resolves(const Contact& shorter, const Contact& longer) const;
  const ManifoldPoint& deepest(const Contact& c) const;

  const Surface& surface_;
  const Geometry& shape_;
  const SE3& T_;
  double same_;
  ManifoldScratch& scratch_;
};

const ManifoldPoint& Pruning::deepest(const Contact& c) const {
  const ManifoldPoint* p = &scratch_.points[c.contact.first_point];
  return *std::min_element(p, p + c.contact.count, [](const auto& a, const auto& b) {
    return a.separation < b.separation;
  });
}

bool Pruning::resolves(const Contact& shorter, const Contact& longer) const {
  if (shorter.triangle == ManifoldScratch::kNoTriangle) return false;
  const TriangleContact &s = shorter.contact, &l = longer.contact;
  if (!(s.gap < -same_) || s.gap <= l.gap || dot(s.normal, l.normal) > kSameNormal) return false;
  const Vec3 way = deepest(shorter).position - deepest(longer).position;
  if (dot(way, way) > kNear * kNear * l.gap * l.gap) return false;
  const SE3 moved(T_.rotation(), T_.position() + (same_ - s.gap) * s.normal);
  if (l.felt_part != TriangleContact::kFace) {
    return !overlaps_triangle(surface_.triangle(longer.triangle), shape_, moved);
  }
  // A face goes on over the edges that are not felt: none of its triangles may be left.
  return std::none_of(scratch_.triangles.begin(), scratch_.triangles.end(), [&](std::uint32_t id) {
    SurfaceTriangle t = surface_.triangle(id);
    return std::fabs(dot(t.normal, l.normal)) > kSameNormal && overlaps_triangle(t, shape_, moved);
  });
}

// Each contact to the first cluster with nearly its normal; past the last cluster, to that which
// comes nearest.
std::uint32_t find_clusters(std::vector<Contact>& contacts, bool& crowded) {
  Vec3 normals[kMostClusters];
  std::uint32_t count = 0;
  for (Contact& c : contacts) {
    c.cluster = count;
    double most = count < kMostClusters ? kSameNormal : -2.0;
    for (std::uint32_t k = 0; k < count; ++k) {
      const double along = dot(normals[k], c.contact.normal);
      if (along <= most) continue;
      most = along;
      c.cluster = k;
    }
    if (c.cluster == count) normals[count++] = c.contact.normal;
    crowded |= most < kSameNormal;
  }
  return count;
}

// The points of a cluster.
class Cluster {
 public:
  Cluster(const ManifoldScratch& scratch, std::uint32_t cluster, double size)
      : scratch_(scratch), cluster_(cluster), same_(kSamePoint * size) {}

  // Four that span the most, and the deepest.
  SubManifold reduced() const;

 private:
  template <class F>
  void for_each(const F& f) const {
    for (const Contact& c : scratch_.contacts) {
      if (c.cluster != cluster_) continue;
      for (std::size_t i = 0; i < c.contact.count; ++i) {
        f(scratch_.points[c.contact.first_point + i], c);
      }
    }
  }
  const ManifoldPoint* farthest_from(const Vec3& from) const;
  void span_most(const ManifoldPoint& deepest, const Vec3& normal,
                 const ManifoldPoint* (&chosen)[4]) const;

  const ManifoldScratch& scratch_;
  std::uint32_t cluster_;
  double same_;
};

const ManifoldPoint* Cluster::farthest_from(const Vec3& from) const {
  const ManifoldPoint* best = nullptr;
  double most = same_ * same_;
  for_each([&](const ManifoldPoint& p, const Contact&) {
    const Vec3 way = p.position - from;
    if (dot(way, way) <= most * kClearly) return;
    most = dot(way, way);
    best = &p;
  });
  return best;
}

// The farthest from the deepest, the farthest from that, and the farthest to either side of the
// line between these.
void Cluster::span_most(const ManifoldPoint& deepest, const Vec3& normal,
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
  span_most(*deepest, found.manifold.normal, chosen);
  const ManifoldPoint** nearest = nullptr;  // to the deepest: gives way to it
  double least = 0.0;
  bool told = false;
  for (const ManifoldPoint*& p : chosen) {
    if (!p) continue;
    told = told || p->separation <= deepest->separation + same_;
    const Vec3 way = p->position - deepest->position;
    if (nearest && dot(way, way) >= least) continue;
    nearest = &p;
    least = dot(way, way);
  }
  if (!told) *nearest = deepest;
  for (const ManifoldPoint* p : chosen) {
    if (p) found.manifold.points[found.manifold.count++] = *p;
  }
  return found;
}

}  // namespace

void collide_surface(const Surface& surface, const Geometry& shape, const SE3& T, double margin,
                     ManifoldScratch& scratch, std::vector<SubManifold>& manifolds) {
  const double size = core_reach(shape) + core_radius(shape);
  scratch.make_room();
  find_contacts(surface, shape, T, margin, scratch);
  if (scratch.contacts.size() > 1) {
    Pruning(surface, shape, T, size, scratch).prune();
  }
  const std::uint32_t clusters = find_clusters(scratch.contacts, scratch.crowded);
  for (std::uint32_t c = 0; c < clusters; ++c) {
    manifolds.push_back(Cluster(scratch, c, size).reduced());
  }
}

}  // namespace vp::collide
