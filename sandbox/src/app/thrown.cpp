#include "app/thrown.h"

#include <vector>

namespace sandbox {
namespace {

// A dodecahedron: the corners of a cube, and of three rectangles with sides in the ratio of the
// golden ratio squared.
vp::ConvexHull dodecahedron(double radius) {
  const double a = radius / 1.7320508075688772, g = 1.618033988749895;
  std::vector<vp::Vec3> points;
  for (const double s : {-a, a}) {
    for (const double t : {-a, a}) {
      points.insert(points.end(), {{s, t, a}, {s, t, -a}});
      points.insert(points.end(), {{0, s / g, t * g}, {s / g, t * g, 0}, {t * g, 0, s / g}});
    }
  }
  return vp::ConvexHull::of(points).value();
}

}  // namespace

vp::Shape thrown_shape(int index, double r) {
  switch (index) {
    case 0:
      return vp::Box{{0.8 * r, 0.8 * r, 0.8 * r}};
    case 1:
      return vp::Sphere{r};
    case 2:
      return vp::Capsule{0.6 * r, 0.6 * r};
    case 3:
      return vp::Cylinder{0.8 * r, 0.8 * r};
    case 4:
      return vp::Cone{r, r};
    default:
      return dodecahedron(r);
  }
}

}  // namespace sandbox
