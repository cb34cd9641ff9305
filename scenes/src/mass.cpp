// Masses and moments of inertia of the solids, of uniform density.
#include "scenes/scene.h"

namespace scenes {
namespace {

Mass sphere_mass(const Sphere& s, double density) {
  const double m = density * 4.0 / 3.0 * vp::kPi * s.radius * s.radius * s.radius;
  const double i = 0.4 * m * s.radius * s.radius;
  return {m, {i, i, i}};
}

Mass box_mass(const Box& b, double density) {
  const Vec3& h = b.half_extents;
  const double m = density * 8.0 * h.x * h.y * h.z;
  const double s = m / 3.0;
  return {m,
          {s * (h.y * h.y + h.z * h.z), s * (h.z * h.z + h.x * h.x), s * (h.x * h.x + h.y * h.y)}};
}

// A cylinder and two half balls, whose centres of mass are 3/8 r beyond its ends.
Mass capsule_mass(const Capsule& c, double density) {
  const double r = c.radius, h = c.half_length;
  const double cylinder = density * 2.0 * vp::kPi * r * r * h;
  const double ball = density * 4.0 / 3.0 * vp::kPi * r * r * r;
  const double along = 0.5 * cylinder * r * r + 0.4 * ball * r * r;
  const double across =
      cylinder * (0.25 * r * r + h * h / 3.0) + ball * (0.4 * r * r + h * h + 0.75 * h * r);
  return {cylinder + ball, {across, across, along}};
}

}  // namespace

Mass mass_of(const Shape& shape, double density) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return sphere_mass(*s, density);
  if (const auto* b = std::get_if<Box>(&shape)) return box_mass(*b, density);
  if (const auto* c = std::get_if<Capsule>(&shape)) return capsule_mass(*c, density);
  return {0.0, {}};
}

Mass mass_of(const Body& body) {
  Mass sum{0.0, {}};
  for (const Part& part : body.parts) {
    const Mass own = mass_of(part.shape, part.density);
    const vp::Mat3& R = part.T_body_shape.rotation();
    const Vec3& p = part.T_body_shape.position();
    const double p2 = dot(p, p);
    sum.mass += own.mass;
    for (int i = 0; i < 3; ++i) {
      double turned = 0.0;  // (R I R^T)_ii
      for (int k = 0; k < 3; ++k) turned += R(i, k) * R(i, k) * own.moments[k];
      sum.moments[i] += turned + own.mass * (p2 - p[i] * p[i]);
    }
  }
  return sum;
}

}  // namespace scenes
