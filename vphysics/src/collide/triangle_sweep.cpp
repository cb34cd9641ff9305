#include "collide/triangle_sweep.h"

#include <algorithm>
#include <optional>
#include <span>

#include "collide/support.h"

namespace vp::collide {
namespace {

constexpr int kMaxAdvances = 32;
// Fraction of the distance at which they touch, to which the shape advances.
constexpr double kTouching = 0.5;

class TriangleSweep {
 public:
  TriangleSweep(const SurfaceTriangle& t, const ShapeOnSurface& on, const SweptMargin& margin)
      : t_(t),
        on_(on),
        margin_(margin),
        separation_(separation_from_triangle(t, on, t.normal)),
        centre_(on.T_surface_shape * core_centre(on.shape)),
        T_end_(margin.displacement * on.T_surface_shape) {}

  // Along the triangle's normal, now.
  double separation() const { return separation_; }

  // The fraction of the motion at which they touch, not later; 0: now. Advances along the normal
  // of a separating plane, first that of the triangle, for as long as it separates them. If it does
  // so at the end too, they do not touch.
  std::optional<double> impact() const {
    const double touching = margin_.bounds.touching;
    double time = 0.0;
    TriangleDistance near{separation_, t_.normal};
    if (separation_ <= touching) near = distance_at(on_.T_surface_shape);
    for (int i = 0; i < kMaxAdvances; ++i) {
      if (near.distance <= touching) return time;
      const double at_end =
          separation_from_triangle(t_, {on_.shape, T_end_, on_.faces}, near.normal);
      if (at_end > touching) return std::nullopt;
      time += (1.0 - time) * (near.distance - kTouching * touching) / (near.distance - at_end);
      if (i == 0 && (t_.active & 7u) == 0) return time;
      near = distance_at(displacement(time) * on_.T_surface_shape);
    }
    return time;
  }

  SE3 displacement(double time) const { return margin_.part_of_displacement(time, centre_); }

 private:
  TriangleDistance distance_at(const SE3& T) const {
    return distance_from_triangle(t_, {on_.shape, T, on_.faces}, margin_.bounds.largest);
  }

  const SurfaceTriangle& t_;
  const ShapeOnSurface& on_;
  const SweptMargin& margin_;
  double separation_;
  Vec3 centre_;
  SE3 T_end_;
};

// Moves points that were found after a displacement back with the shape's centre. Their arms stay
// those of the impact, so that a ball that spins has none along the surface; their separations
// become those from which the solver's velocities close them.
void move_back(const Vec3& centre, const Vec3& shift, const Vec3& rotation, const Vec3& normal,
               std::span<ManifoldPoint> points) {
  for (ManifoldPoint& p : points) {
    const Vec3 here = p.position + 0.5 * p.separation * normal - shift;
    p.separation -= dot(normal, shift + cross(rotation, here - centre));
    p.position = here - 0.5 * p.separation * normal;
  }
}

}  // namespace

TriangleContact sweep_triangle(const Surface& surface, const SurfaceTriangle& t,
                               const ShapeOnSurface& on, const SweptMargin& margin,
                               std::vector<ManifoldPoint>& points) {
  const double largest = margin.bounds.largest, touching = margin.bounds.touching;
  if (!margin.moves) return collide_triangle(surface, t, on, largest, points);
  const std::size_t first = points.size();
  const TriangleSweep sweep(t, on, margin);
  // Where the contact of a shape that rotates far will be depends on more than its pose at the
  // impact.
  const bool rotates_far = margin.bounds.slack >= largest,
             may_touch_now = sweep.separation() <= touching;
  TriangleContact contact{{}, {}, 0.0, first, 0, 0};
  if (rotates_far || may_touch_now) contact = collide_triangle(surface, t, on, largest, points);
  if (rotates_far && contact.count > 0) return contact;
  const bool touches_now = may_touch_now && contact.count > 0 && contact.separation <= touching;
  if (!touches_now && !(may_touch_now && (t.active & 7u) == 0)) {
    points.resize(first);
    contact.count = 0;
    const std::optional<double> time = sweep.impact();
    if (!time) return contact;
    const SE3 displacement = sweep.displacement(*time), T = displacement * on.T_surface_shape;
    contact = collide_triangle(surface, t, {on.shape, T, on.faces}, largest, points);
    const Vec3 centre = on.T_surface_shape * core_centre(on.shape);
    move_back(centre, displacement * centre - centre, *time * margin.rotation, contact.normal,
              std::span(points).subspan(first));
    contact.separation += dot(contact.normal, on.T_surface_shape.position() - T.position());
  }
  const auto stays_away = [&](const ManifoldPoint& p) {
    return !margin.may_touch(p.separation, contact.normal,
                             p.position + 0.5 * p.separation * contact.normal);
  };
  points.erase(
      std::remove_if(points.begin() + static_cast<std::ptrdiff_t>(first), points.end(), stays_away),
      points.end());
  contact.count = points.size() - first;
  return contact;
}

}  // namespace vp::collide
