// Mass properties of shapes, and scaled shapes.
#include <cmath>
#include <vector>

#include "vphysics/shapes.h"

namespace vp {

Inertia solid_inertia(const Shape& shape, double density) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    const double r = sphere->radius;
    const double m = density * (4.0 / 3.0) * kPi * r * r * r;
    const double I = 0.4 * m * r * r;
    return {m, Vec3{I, I, I}};
  }
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vec3 h = box->half_extents;
    const double m = density * 8.0 * h.x * h.y * h.z;
    const double x = h.x * h.x, y = h.y * h.y, z = h.z * h.z;
    return {m, (m / 3.0) * Vec3{y + z, z + x, x + y}};
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    // A cylinder of length 2 l and two hemispheres, whose centres of mass are 3/8 r beyond its
    // ends.
    const double r = capsule->radius, l = capsule->half_length;
    const double cylinder = density * kPi * r * r * 2.0 * l;
    const double ball = density * (4.0 / 3.0) * kPi * r * r * r;
    const double axial = 0.5 * cylinder * r * r + 0.4 * ball * r * r;
    const double radial =
        cylinder * (r * r / 4.0 + l * l / 3.0) + ball * (0.4 * r * r + l * l + 0.75 * l * r);
    return {cylinder + ball, Vec3{radial, radial, axial}};
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    const double r = cylinder->radius, l = cylinder->half_length;
    const double m = density * kPi * r * r * 2.0 * l;
    const double radial = m * (r * r / 4.0 + l * l / 3.0);
    return {m, Vec3{radial, radial, 0.5 * m * r * r}};
  }
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    // Height 2 h, the centre of mass h / 2 above the base; about it, perpendicular to the axis,
    // 3/20 m r^2 + 3/80 m (2 h)^2.
    const double r = cone->radius, h = cone->half_height;
    const double m = density * kPi * r * r * 2.0 * h / 3.0;
    const double radial = m * (0.15 * r * r + 0.15 * h * h);
    return Inertia(m, Vec3{radial, radial, 0.3 * m * r * r}).about({0, 0, 0.5 * h});
  }
  if (const auto* hull = std::get_if<ConvexHull>(&shape)) return hull->inertia(density);
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
    return mesh->data() ? mesh->inertia(density).value_or(Inertia{}) : Inertia{};
  }
  if (const auto* compound = std::get_if<Compound>(&shape)) return compound->inertia(density);
  return {};
}

namespace {

constexpr double kMinScale = 1e-6, kMaxScale = 1e6;

tl::unexpected<Error> invalid_scale(const char* message) {
  return tl::make_unexpected(Error{Errc::invalid_argument, message});
}

template <class T>
Expected<Shape> as_shape(Expected<T> made) {
  if (!made) return tl::make_unexpected(made.error());
  return Shape(*std::move(made));
}

// Unequal factors would shear rotated parts.
Expected<Shape> scaled_compound(const Compound& compound, const Vec3& scale) {
  if (!compound.data()) return invalid_scale("scaled: the compound was moved from");
  if (scale.x != scale.y || scale.y != scale.z) {
    return invalid_scale("scaled: a compound takes equal factors only; scale its parts");
  }
  std::vector<CompoundPart> parts;
  for (const CompoundPart& part : compound.parts()) {
    Expected<Shape> made = scaled(part.shape, scale);
    if (!made) return made;
    const SE3& T = part.T_compound_part;
    parts.push_back({*std::move(made), SE3(T.rotation(), scale.x * T.position())});
  }
  return as_shape(Compound::of(parts));
}

}  // namespace

Expected<Shape> scaled(const Shape& shape, const Vec3& scale) {
  for (const double s : {scale.x, scale.y, scale.z}) {
    if (!(s >= kMinScale && s <= kMaxScale)) {
      return invalid_scale("scaled: every factor must be from 1e-6 to 1e6");
    }
  }
  const bool circular = scale.x == scale.y, uniform = circular && scale.y == scale.z;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    if (!uniform) {
      return invalid_scale(
          "scaled: a sphere keeps its shape by equal factors only; use a convex hull");
    }
    return Sphere{scale.x * sphere->radius};
  }
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vec3& h = box->half_extents;
    return Box{{scale.x * h.x, scale.y * h.y, scale.z * h.z}};
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    if (!uniform) {
      return invalid_scale(
          "scaled: a capsule keeps its shape by equal factors only; use a convex hull");
    }
    return Capsule{scale.x * capsule->radius, scale.x * capsule->half_length};
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    if (!circular) {
      return invalid_scale("scaled: a cylinder needs equal factors of x and y; use a convex hull");
    }
    return Cylinder{scale.x * cylinder->radius, scale.z * cylinder->half_length};
  }
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    if (!circular)
      return invalid_scale("scaled: a cone needs equal factors of x and y; use a convex hull");
    return Cone{scale.x * cone->radius, scale.z * cone->half_height};
  }
  if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
    if (!hull->data()) return invalid_scale("scaled: the convex hull was moved from");
    std::vector<Vec3> points(hull->vertices().begin(), hull->vertices().end());
    for (Vec3& p : points) p = {scale.x * p.x, scale.y * p.y, scale.z * p.z};
    HullOptions all;
    all.max_vertices = 256;
    Expected<ConvexHull> made = ConvexHull::of(points, all);
    if (!made) return tl::make_unexpected(made.error());
    return *std::move(made);
  }
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return as_shape(mesh->scaled(scale));
  if (const auto* field = std::get_if<HeightField>(&shape)) return as_shape(field->scaled(scale));
  if (const auto* compound = std::get_if<Compound>(&shape))
    return scaled_compound(*compound, scale);
  return shape;  // a half-space does not change with scale
}

}  // namespace vp
