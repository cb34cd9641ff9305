#include "collide/triangle_contact.h"

#include <optional>
#include <utility>

#include "collide/bounds.h"
#include "collide/convex_contact.h"
#include "collide/corner_over_face.h"
#include "collide/epa.h"
#include "collide/mixed_name.h"
#include "collide/triangle_axis.h"
#include "collide/triangle_clip.h"

namespace vp::collide {
namespace {

// Below this distance [m] to a triangle, the direction to a centre is rounding noise.
constexpr double kNoDirection = 1e-12;
// A centre at most this far beside a triangle [fraction of its size] is over it: at an inactive
// edge, rounding might otherwise put it beside both neighbours.
constexpr double kBeside = 1e-9;

std::uint64_t active_part(const SurfaceTriangle& t, const TrianglePart& part) {
  if (part.kind == TrianglePart::face) return TriangleContact::kFace;
  const std::uint64_t v = t.corners[part.index];
  const std::uint64_t w =
      part.kind == TrianglePart::edge ? t.corners[(part.index + 1) % 3] : t.corners[part.index];
  return std::min(v, w) << 32 | std::max(v, w);
}

std::uint32_t part_name(const SurfaceTriangle& t, const TrianglePart& part, std::uint32_t feature) {
  if (part.kind == TrianglePart::face) return mixed_name(t.id, kNoVertex, feature);
  const std::uint64_t active = active_part(t, part);
  return mixed_name(static_cast<std::uint32_t>(active >> 32), static_cast<std::uint32_t>(active),
                    feature);
}

// The part of a triangle that is closest to a sphere's centre.
struct NearSphere {
  Vec3 point, normal;
  double distance;
  TrianglePart part;
};
NearSphere near_sphere(const SurfaceTriangle& t, const Vec3& centre) {
  const NearestOnTriangle nearest = nearest_on_triangle(t.p, centre);
  const Vec3 offset = centre - nearest.point;
  const double distance = norm(offset), height = dot(t.normal, offset);
  const double beside = norm(offset - height * t.normal);
  const bool on_face = nearest.part.kind == TrianglePart::face || distance < kNoDirection ||
                       beside <= kBeside * norm(t.p[1] - t.p[0]);
  if (on_face) return {nearest.point, t.normal, height, {}};
  return {nearest.point, (1.0 / distance) * offset, distance, nearest.part};
}

void collide_sphere(const Surface& surface, const SurfaceTriangle& t, const Vec3& centre,
                    double radius, double margin, TriangleContact& contact,
                    std::vector<ManifoldPoint>& points) {
  const NearSphere near = near_sphere(t, centre);
  if (near.distance - radius > margin) return;
  contact.part = near.part;
  contact.normal = near.normal;
  if (near.part.kind != TrianglePart::face &&
      !may_touch_along(surface, t, near.part, near.normal)) {
    return;
  }
  contact.separation = near.distance - radius;
  points.push_back({near.point + 0.5 * contact.separation * contact.normal, contact.separation,
                    part_name(t, contact.part, 0)});
}

// The triangle's frame has the surface's axes, with the first corner as its origin, so that
// triangles far from the surface's origin lose no precision.
class TriangleCollider {
 public:
  TriangleCollider(const Surface& surface, const SurfaceTriangle& t, const ShapeOnSurface& on,
                   double margin, std::vector<ManifoldPoint>& points)
      : surface_(surface),
        t_(t),
        faces_(on.faces),
        p_{{}, t.p[1] - t.p[0], t.p[2] - t.p[0]},
        triangle_(triangle_geometry(p_)),
        pair_(triangle_, on.shape,
              SE3(on.T_surface_shape.rotation(), on.T_surface_shape.position() - t.p[0])),
        query_(pair_, margin),
        points_(points) {}

  void find(TriangleContact& contact);
  bool rough() const { return pair_.rough; }

 private:
  void along_face(double separation, TriangleContact& contact);
  void along(const BestAxis& axis, const TrianglePart& part, bool nearest_known,
             TriangleContact& contact);
  void finish(TriangleContact& contact, const TrianglePart& part, const Vec3& normal,
              double separation);
  bool tells(std::size_t first, double separation) const;
  bool find_witness(BestAxis& axis) const;

  const Surface& surface_;
  const SurfaceTriangle& t_;
  const Polytope* faces_;
  Vec3 p_[3];
  Geometry triangle_;
  CorePair pair_;
  ContactQuery query_;
  std::vector<ManifoldPoint>& points_;
};

void TriangleCollider::find(TriangleContact& contact) {
  const double separation = separation_along(pair_, t_.normal);
  if (separation - query_.radii > query_.margin) return;
  if ((t_.active & 7u) == 0) return along_face(separation, contact);
  const double limit = query_.margin + query_.radii;
  std::optional<GjkResult> nearest;
  if (faces_) nearest = corner_over_face(p_, *faces_, pair_.T_a_b, limit);
  const GjkResult found = nearest ? *nearest : gjk(pair_, t_.normal, limit);
  if (found.state == GjkResult::State::beyond) return;
  BestAxis best{found.distance, found.normal, found.on_a, found.on_b};
  if (found.state == GjkResult::State::overlaps) {
    const Penetration p = epa(pair_, found.simplex, 1e300);
    best = {-p.depth, p.normal, p.on_a, p.on_b};
  }
  bool nearest_known = true;
  TrianglePart part = foremost_part(p_, best.normal);
  bool allowed = may_touch_along(surface_, t_, part, best.normal);
  if (!allowed && found.state == GjkResult::State::overlaps) {
    const TriangleAxis out = best_exit_axis(surface_, t_, p_, pair_);
    best = {out.separation, out.normal, {}, {}};
    part = out.part;
    allowed = true;
    nearest_known = find_witness(best);
  }
  const std::size_t first = points_.size();
  if (part.kind == TrianglePart::face || !allowed ||
      query_.face_suffices(separation, best.separation)) {
    along_face(separation, contact);
    if (part.kind == TrianglePart::face || !allowed || tells(first, best.separation)) return;
    points_.resize(first);
  }
  along(best, part, nearest_known, contact);
}

// The points where the two touch once the shape has exited: the closest points after a slightly
// larger move. Returns false if its foremost point is beside the triangle.
bool TriangleCollider::find_witness(BestAxis& axis) const {
  constexpr double kFarther = 1e-3;  // fraction of the pair's size
  const double farther = kFarther * pair_.size;
  const SE3& T = pair_.T_a_b;
  const Vec3 shift = (farther - axis.separation) * axis.normal;
  const CorePair separated(triangle_, pair_.b, SE3(T.rotation(), T.position() + shift));
  const GjkResult near = gjk(separated, axis.normal, 2.0 * farther);
  if (near.state != GjkResult::State::separated) return false;
  axis.on_a = near.on_a;
  axis.on_b = near.on_a + axis.separation * axis.normal;
  return true;
}

// Whether the points from `first` on are as deep as the cores' separation.
bool TriangleCollider::tells(std::size_t first, double separation) const {
  Manifold deepest;
  for (std::size_t i = first; i < points_.size(); ++i) {
    if (deepest.count > 0 && points_[i].separation >= deepest.points[0].separation) continue;
    deepest.count = 0;
    deepest.add({}, points_[i].separation, 0);
  }
  return deepest.count > 0 && query_.tells(deepest, separation);
}

// Adds the part of the shape's feature over the triangle.
void TriangleCollider::along_face(double separation, TriangleContact& contact) {
  Feature other;
  find_feature(pair_.b, pair_.T_a_b, -pair_.T_a_b.unrotate(t_.normal), other);
  append_clipped({p_, t_.normal, other, query_.radii, query_.margin, pair_.size}, points_);
  finish(contact, {}, t_.normal, separation - query_.radii);
}

// Adds the contact of an edge, from the corner with the lower name, or of a corner.
void TriangleCollider::along(const BestAxis& axis, const TrianglePart& part, bool nearest_known,
                             TriangleContact& contact) {
  int i = part.index, k = (part.index + 1) % 3;
  if (part.kind == TrianglePart::edge && t_.corners[i] > t_.corners[k]) std::swap(i, k);
  Feature local, other;
  local.count = part.kind == TrianglePart::edge ? 2 : 1;
  local.corners[0] = {p_[i].x, p_[i].y, p_[i].z, 0, 0};
  local.corners[1] = {p_[k].x, p_[k].y, p_[k].z, 1, 0};
  find_feature(pair_.b, pair_.T_a_b, -pair_.T_a_b.unrotate(axis.normal), other);
  const PatchQuery patch{local,         other,      axis.normal, 0.0,       query_.radii,
                         query_.margin, pair_.size, axis.on_a,   axis.on_b, axis.separation};
  Manifold m;
  find_patch(patch, nearest_known, m);
  for (int j = 0; j < m.count; ++j) points_.push_back(m.points[j]);
  finish(contact, part, axis.normal, axis.separation - query_.radii);
}

void TriangleCollider::finish(TriangleContact& contact, const TrianglePart& part,
                              const Vec3& normal, double separation) {
  contact.part = part;
  contact.normal = normal;
  contact.separation = separation;
  for (std::size_t i = contact.first_point; i < points_.size(); ++i) {
    points_[i].position += t_.p[0];
    points_[i].feature = part_name(t_, part, points_[i].feature);
  }
}

}  // namespace

TriangleContact collide_triangle(const Surface& surface, const SurfaceTriangle& t,
                                 const ShapeOnSurface& on, double margin,
                                 std::vector<ManifoldPoint>& points) {
  TriangleContact contact{{}, {}, 0.0, points.size(), 0, 0};
  if (on.shape.kind == Kind::sphere) {
    collide_sphere(surface, t, on.T_surface_shape.position(), on.shape.radius, margin, contact,
                   points);
  } else {
    TriangleCollider collider(surface, t, on, margin, points);
    collider.find(contact);
    contact.rough = collider.rough();
  }
  contact.count = points.size() - contact.first_point;
  contact.active_part = active_part(t, contact.part);
  return contact;
}

TriangleDistance distance_from_triangle(const SurfaceTriangle& t, const ShapeOnSurface& on,
                                        double limit) {
  const Vec3 p[3] = {{}, t.p[1] - t.p[0], t.p[2] - t.p[0]};
  const SE3 T(on.T_surface_shape.rotation(), on.T_surface_shape.position() - t.p[0]);
  const double radius = core_radius(on.shape);
  std::optional<GjkResult> found;
  if (on.faces) found = corner_over_face(p, *on.faces, T, limit + radius);
  if (!found) {
    const Geometry local = triangle_geometry(p);
    found = gjk(CorePair(local, on.shape, T), t.normal, limit + radius);
  }
  if (found->state == GjkResult::State::overlaps) return {0.0, {}};
  return {std::max(0.0, found->distance - radius), found->normal};
}

double separation_from_triangle(const SurfaceTriangle& t, const ShapeOnSurface& on, const Vec3& n) {
  const SE3& T = on.T_surface_shape;
  int hint = 0;
  const Vec3 foremost = core_support(on.shape, -T.unrotate(n), hint);
  const Vec3 from_corner = (T.position() - t.p[0]) + T.rotate(foremost);
  const double farthest = std::max({0.0, dot(n, t.p[1] - t.p[0]), dot(n, t.p[2] - t.p[0])});
  return dot(n, from_corner) - farthest - core_radius(on.shape);
}

double active_distance(const Surface& surface, const SurfaceTriangle& t, const Vec3& centre) {
  const NearSphere near = near_sphere(t, centre);
  const bool active =
      near.part.kind == TrianglePart::face || may_touch_along(surface, t, near.part, near.normal);
  return active ? near.distance : kFar;
}

bool overlaps_triangle(const SurfaceTriangle& t, const ShapeOnSurface& on) {
  const Vec3 p[3] = {{}, t.p[1] - t.p[0], t.p[2] - t.p[0]};
  const SE3 T(on.T_surface_shape.rotation(), on.T_surface_shape.position() - t.p[0]);
  if (on.faces) {
    if (const auto known = corners_overlap(p, *on.faces, T)) return *known;
  }
  const Geometry local = triangle_geometry(p);
  const CorePair pair(local, on.shape, T);
  const double radius = core_radius(on.shape);
  const GjkResult found = gjk(pair, t.normal, radius);
  return found.state == GjkResult::State::overlaps ||
         (found.state == GjkResult::State::separated && found.distance < radius);
}

}  // namespace vp::collide
