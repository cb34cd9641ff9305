#include "collide/corner_over_face.h"

#include <algorithm>

#include "collide/bounds.h"

namespace vp::collide {

bool has_few_flat_faces(const Geometry& shape) {
  constexpr std::size_t kFew = kScanBits;
  constexpr double kFlat = 1e-6;  // fraction of the radius
  if (shape.kind == Kind::box) return true;
  return shape.kind == Kind::hull && shape.hull->faces.size() <= kFew &&
         shape.hull->max_face_depth <= kFlat * shape.hull->radius;
}

std::optional<GjkResult> corner_over_face(const Vec3 p[3], const Polytope& b, const SE3& T_a_b,
                                          double limit) {
  const Vec3 corners[3] = {inverse_times(T_a_b, p[0]), inverse_times(T_a_b, p[1]),
                           inverse_times(T_a_b, p[2])};
  const ConvexHull::Face* face = nullptr;
  double largest = 0.0;
  for (const ConvexHull::Face& f : b.faces) {
    const double separation = std::min({dot(f.normal, corners[0]), dot(f.normal, corners[1]),
                                        dot(f.normal, corners[2])}) -
                              f.offset;
    if (!(separation > largest)) continue;
    largest = separation;
    face = &f;
  }
  if (!face) return std::nullopt;
  GjkResult found;
  found.state = largest > limit ? GjkResult::State::beyond : GjkResult::State::separated;
  found.distance = largest;
  found.normal = -T_a_b.rotate(face->normal);
  if (found.state == GjkResult::State::beyond) return found;
  const auto nearest = std::min_element(corners, corners + 3, [&](const Vec3& u, const Vec3& v) {
    return dot(face->normal, u) < dot(face->normal, v);
  });
  const Vec3 on_face = *nearest - largest * face->normal;
  const bool is_over = std::all_of(b.faces.begin(), b.faces.end(), [&](const auto& f) {
    return &f == face || dot(f.normal, on_face) <= f.offset;
  });
  if (!is_over) return std::nullopt;
  found.on_a = p[nearest - corners];
  found.on_b = found.on_a + largest * found.normal;
  return found;
}

std::optional<bool> corners_overlap(const Vec3 p[3], const Polytope& b, const SE3& T_a_b) {
  const Vec3 corners[3] = {inverse_times(T_a_b, p[0]), inverse_times(T_a_b, p[1]),
                           inverse_times(T_a_b, p[2])};
  double outside[3] = {-kFar, -kFar, -kFar};  // of each corner: largest distance from a face
  for (const ConvexHull::Face& f : b.faces) {
    double nearest = kFar;
    for (int i = 0; i < 3; ++i) {
      const double distance = dot(f.normal, corners[i]) - f.offset;
      outside[i] = std::max(outside[i], distance);
      nearest = std::min(nearest, distance);
    }
    if (nearest >= 0.0) return false;
  }
  if (std::min({outside[0], outside[1], outside[2]}) < 0.0) return true;
  return std::nullopt;
}

}  // namespace vp::collide
