#include "collide/triangle_sweep.h"

#include <algorithm>
#include <optional>

#include "collide/support.h"

namespace vp::collide {
namespace {

constexpr int kMaxAdvances = 32;
// Fraction of the distance at which they touch, to which the shape advances.
constexpr double kTouching = 0.5;

class TriangleSweep {
 public:
  TriangleSweep(const Surface& surface, const SurfaceTriangle& t, const ShapeOnSurface& on,
                const SweptMargin& margin, std::vector<ManifoldPoint>& points)
      : surface_(surface),
        t_(t),
        on_(on),
        margin_(margin),
        centre_(on.T_surface_shape * core_centre(on.shape)),
        T_end_(margin.displacement * on.T_surface_shape),
        has_active_edges_((t.active & 7u) != 0),
        first_(points.size()),
        points_(points) {}

  TriangleContact contact() const {
    const double touching = margin_.bounds.touching;
    const double separation = separation_from_triangle(t_, on_, t_.normal);
    const bool is_in_plane = separation <= touching;
    if (margin_.bounds.rotates_far || is_in_plane) {
      const TriangleContact now = contact_at(on_.T_surface_shape);
      // Where a shape that rotates far will touch depends on more than its pose at the impact.
      if (margin_.bounds.rotates_far && now.count > 0) return now;
      const bool touches = now.count > 0 && now.separation <= touching;
      if (is_in_plane && (touches || !has_active_edges_)) return without_distant_points(now);
      points_.resize(first_);
    }
    const std::optional<double> time = impact(separation);
    if (!time) return {{}, {}, 0.0, first_, 0, 0};
    return without_distant_points(contact_of_impact(*time));
  }

 private:
  TriangleContact contact_at(const SE3& T) const {
    return collide_triangle(surface_, t_, {on_.shape, T, on_.faces}, margin_.bounds.largest,
                            points_);
  }
  TriangleDistance distance_at(const SE3& T) const {
    return distance_from_triangle(t_, {on_.shape, T, on_.faces}, margin_.bounds.largest);
  }
  SE3 displacement(double time) const { return margin_.part_of_displacement(time, centre_); }

  std::optional<double> impact(double separation) const;
  TriangleContact contact_of_impact(double time) const;
  TriangleContact without_distant_points(TriangleContact contact) const;

  const Surface& surface_;
  const SurfaceTriangle& t_;
  const ShapeOnSurface& on_;
  const SweptMargin& margin_;
  Vec3 centre_;
  SE3 T_end_;
  bool has_active_edges_;
  std::size_t first_;  // point of the contact
  std::vector<ManifoldPoint>& points_;
};

// The fraction of the motion at which they touch, not later; 0: now. Advances along the normal of a
// separating plane, first that of the triangle, for as long as it separates them. If it does so at
// the end too, they do not touch. separation: along the triangle's normal, now.
std::optional<double> TriangleSweep::impact(double separation) const {
  const double touching = margin_.bounds.touching;
  double time = 0.0;
  TriangleDistance near{separation, t_.normal};
  if (separation <= touching) near = distance_at(on_.T_surface_shape);
  for (int i = 0; i < kMaxAdvances; ++i) {
    if (near.distance <= touching) return time;
    const double at_end = separation_from_triangle(t_, {on_.shape, T_end_, on_.faces}, near.normal);
    if (at_end > touching) return std::nullopt;
    time += (1.0 - time) * (near.distance - kTouching * touching) / (near.distance - at_end);
    if (!has_active_edges_) return time;  // only its face can be touched
    near = distance_at(displacement(time) * on_.T_surface_shape);
  }
  return time;
}

// Moves the points back with the shape's centre. Their arms stay those of the impact, so that a
// ball that spins has none along the surface; their separations become those from which the
// solver's velocities close them.
TriangleContact TriangleSweep::contact_of_impact(double time) const {
  const SE3 displaced = displacement(time);
  const Vec3 shift = displaced * centre_ - centre_, rotation = time * margin_.rotation;
  TriangleContact contact = contact_at(displaced * on_.T_surface_shape);
  const Vec3& n = contact.normal;
  contact.separation -= dot(n, shift);
  for (std::size_t i = first_; i < points_.size(); ++i) {
    ManifoldPoint& p = points_[i];
    const Vec3 here = p.position + 0.5 * p.separation * n - shift;
    p.separation -= dot(n, shift + cross(rotation, here - centre_));
    p.position = here - 0.5 * p.separation * n;
  }
  return contact;
}

TriangleContact TriangleSweep::without_distant_points(TriangleContact contact) const {
  const auto stays_away = [&](const ManifoldPoint& p) {
    return !margin_.may_touch(p.separation, contact.normal,
                              p.position + 0.5 * p.separation * contact.normal);
  };
  const auto begin = points_.begin() + static_cast<std::ptrdiff_t>(first_);
  points_.erase(std::remove_if(begin, points_.end(), stays_away), points_.end());
  contact.count = points_.size() - first_;
  return contact;
}

}  // namespace

TriangleContact sweep_triangle(const Surface& surface, const SurfaceTriangle& t,
                               const ShapeOnSurface& on, const SweptMargin& margin,
                               std::vector<ManifoldPoint>& points) {
  if (!margin.moves) return collide_triangle(surface, t, on, margin.bounds.largest, points);
  return TriangleSweep(surface, t, on, margin, points).contact();
}

}  // namespace vp::collide
