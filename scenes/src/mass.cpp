// Masses and moments of inertia of solids of uniform density.
//
// A polyhedron is a sum of tetrahedra from a point inside it to the triangles (a, b, c) of its
// faces. With that point as origin and d = det(a, b, c), the volume is d/6, the first moments are
// d/24 (a + b + c), and the second moments, the integral of x x^T, are
//   d/120 (s s^T + a a^T + b b^T + c c^T),  s = a + b + c.
// (Tonon, Explicit exact formulas for the 3-D tetrahedron inertia tensor, 2004.)
//
// The principal axes are the eigenvectors of the second moments, by Jacobi rotations (Golub, Van
// Loan, Matrix Computations, section 8.5).
#include <algorithm>
#include <cmath>

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

// A cylinder and two hemispheres, whose centres of mass are 3/8 r beyond its ends.
Mass capsule_mass(const Capsule& c, double density) {
  const double r = c.radius, h = c.half_length;
  const double cylinder = density * 2.0 * vp::kPi * r * r * h;
  const double ball = density * 4.0 / 3.0 * vp::kPi * r * r * r;
  const double along = 0.5 * cylinder * r * r + 0.4 * ball * r * r;
  const double across =
      cylinder * (0.25 * r * r + h * h / 3.0) + ball * (0.4 * r * r + h * h + 0.75 * h * r);
  return {cylinder + ball, {across, across, along}};
}

using vp::Mat3;
using vp::Sym3;

// Integrals over a solid about the origin of its frame.
struct Integrals {
  double mass = 0.0;  // [kg]
  Vec3 first;         // of x [kg m]
  Sym3 second;        // of x x^T [kg m^2]

  Vec3 centre() const { return (1.0 / mass) * first; }
  Sym3 central() const { return second - outer(mass, centre()); }
  // The same integrals in the frame in which this frame has the pose T.
  Integrals moved(const SE3& T) const {
    const Vec3 f = T.rotate(first), &p = T.position();
    Sym3 C = rotated(T.rotation(), second) + outer(mass, p);
    C.xx += 2.0 * f.x * p.x, C.yy += 2.0 * f.y * p.y, C.zz += 2.0 * f.z * p.z;
    C.xy += f.x * p.y + f.y * p.x;
    C.yz += f.y * p.z + f.z * p.y;
    C.zx += f.z * p.x + f.x * p.z;
    return {mass, f + mass * p, C};
  }
};
Integrals operator+(const Integrals& a, const Integrals& b) {
  return {a.mass + b.mass, a.first + b.first, a.second + b.second};
}
Vec3 moments_of(const Sym3& second) {
  return {second.yy + second.zz, second.zz + second.xx, second.xx + second.yy};
}

Integrals hull_integrals(const Polyhedron& hull, double density) {
  Vec3 inside;
  for (const Vec3& p : hull.points) inside += p;
  inside = (1.0 / static_cast<double>(hull.points.size())) * inside;
  Integrals sum;
  for (const Polyhedron::Face& face : hull.faces) {
    const auto at = [&](std::size_t k) {
      return hull.points[static_cast<std::size_t>(face.corners[k])] - inside;
    };
    const Vec3 a = at(0);
    for (std::size_t k = 2; k < face.corners.size(); ++k) {
      const Vec3 b = at(k - 1), c = at(k), s = a + b + c;
      const double d = density * dot(a, cross(b, c));
      sum.mass += d / 6.0;
      sum.first += (d / 24.0) * s;
      sum.second = sum.second +
                   (d / 120.0) * (outer(1.0, s) + outer(1.0, a) + outer(1.0, b) + outer(1.0, c));
    }
  }
  return sum.moved(SE3(inside));
}

Integrals integrals_of(const Shape& shape, double density) {
  if (const auto* hull = std::get_if<Hull>(&shape)) return hull_integrals(*hull->data, density);
  const Mass own = mass_of(shape, density);  // symmetric about its frame's planes
  const Vec3& I = own.moments;
  const double half = 0.5 * (I.x + I.y + I.z);
  return {own.mass, {}, {half - I.x, half - I.y, half - I.z, 0.0, 0.0, 0.0}};
}

// Columns: unit eigenvectors, right-handed. A product of Jacobi rotations, one for each pair of
// axes in turn, each of which makes that pair's entry zero. 12 sweeps reduce the off-diagonal
// entries below rounding.
Mat3 eigenvectors(const Sym3& A) {
  double a[3][3] = {{A.xx, A.xy, A.zx}, {A.xy, A.yy, A.yz}, {A.zx, A.yz, A.zz}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const double scale = std::max({std::fabs(A.xx), std::fabs(A.yy), std::fabs(A.zz)});
  for (int iteration = 0; iteration < 12; ++iteration) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (std::fabs(a[p][q]) <= 1e-17 * scale) continue;
        const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        const double t =
            (theta >= 0.0 ? 1.0 : -1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq, a[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < 3; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk, a[q][k] = s * pk + c * qk;
        }
        for (int k = 0; k < 3; ++k) {
          const double kp = v[k][p], kq = v[k][q];
          v[k][p] = c * kp - s * kq, v[k][q] = s * kp + c * kq;
        }
      }
    }
  }
  return {{v[0][0], v[1][0], v[2][0]}, {v[0][1], v[1][1], v[2][1]}, {v[0][2], v[1][2], v[2][2]}};
}

Integrals integrals_of(const Body& body) {
  Integrals sum;
  for (const Part& part : body.parts) {
    sum = sum + integrals_of(part.shape, part.density).moved(part.T_body_shape);
  }
  return sum;
}

}  // namespace

Mass mass_of(const Shape& shape, double density) {
  if (const auto* h = std::get_if<Hull>(&shape)) {
    const Integrals own = hull_integrals(*h->data, density);
    return {own.mass, moments_of(own.central())};
  }
  if (const auto* s = std::get_if<Sphere>(&shape)) return sphere_mass(*s, density);
  if (const auto* b = std::get_if<Box>(&shape)) return box_mass(*b, density);
  if (const auto* c = std::get_if<Capsule>(&shape)) return capsule_mass(*c, density);
  return {0.0, {}};
}

Mass mass_of(const Body& body) {
  Mass sum{0.0, {}};
  for (const Part& part : body.parts) {
    if (std::holds_alternative<Hull>(part.shape)) {
      const Integrals own = integrals_of(part.shape, part.density).moved(part.T_body_shape);
      sum.mass += own.mass;
      sum.moments += moments_of(own.second);
      continue;
    }
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

void make_principal(Body& body) {
  const Integrals sum = integrals_of(body);
  const SE3 T(eigenvectors(sum.central()), sum.centre());
  for (Part& part : body.parts) {
    const auto* hull = std::get_if<Hull>(&part.shape);
    const bool in_body_frame =
        part.T_body_shape.rotation() == Mat3::identity() && part.T_body_shape.position() == Vec3{};
    part.T_body_shape = Inv(T) * part.T_body_shape;
    if (!hull || !in_body_frame) continue;
    std::vector<Vec3> points = hull->data->points;
    for (Vec3& p : points) p = part.T_body_shape * p;
    part.shape = hull_of(std::move(points));
    part.T_body_shape = SE3{};
  }
  body.T_world_body = body.T_world_body * T;
}

}  // namespace scenes
