#include "world/wires.h"

namespace vp {
namespace {

constexpr int kSegments = 24;  // of a circle; a multiple of 4
constexpr int kSquares = 10;   // along a half-space's side

class Wire {
 public:
  Wire(const SE3& T, double half_space_size, DebugCategory category, DebugDraw& draw)
      : T_(T), half_space_size_(half_space_size), category_(category), draw_(draw) {}

  void line(const Vec3& from, const Vec3& to) { draw_.line(T_ * from, T_ * to, category_); }

  void operator()(const Box& box) {
    const Vec3& h = box.half_extents;
    for (const double s : {-1.0, 1.0}) {
      for (const double t : {-1.0, 1.0}) {
        line({-h.x, s * h.y, t * h.z}, {h.x, s * h.y, t * h.z});
        line({s * h.x, -h.y, t * h.z}, {s * h.x, h.y, t * h.z});
        line({s * h.x, t * h.y, -h.z}, {s * h.x, t * h.y, h.z});
      }
    }
  }
  void operator()(const Sphere& sphere) {
    const Vec3 x{sphere.radius, 0, 0}, y{0, sphere.radius, 0}, z{0, 0, sphere.radius};
    arc({}, x, y, kSegments);
    arc({}, y, z, kSegments);
    arc({}, z, x, kSegments);
  }
  void operator()(const Capsule& capsule) {
    const double r = capsule.radius;
    for (const double end : {-1.0, 1.0}) {
      const Vec3 centre{0, 0, end * capsule.half_length}, z{0, 0, end * r};
      arc(centre, {r, 0, 0}, {0, r, 0}, kSegments);
      arc(centre, {r, 0, 0}, z, kSegments / 2);
      arc(centre, {0, r, 0}, z, kSegments / 2);
    }
    sides(r, r, capsule.half_length);
  }
  void operator()(const Cylinder& cylinder) {
    const double r = cylinder.radius, h = cylinder.half_length;
    arc({0, 0, -h}, {r, 0, 0}, {0, r, 0}, kSegments);
    arc({0, 0, h}, {r, 0, 0}, {0, r, 0}, kSegments);
    sides(r, r, h);
  }
  void operator()(const Cone& cone) {
    const double r = cone.radius, h = cone.half_height;
    arc({0, 0, -h}, {r, 0, 0}, {0, r, 0}, kSegments);
    sides(r, 0.0, h);
  }
  void operator()(const HalfSpace&) {
    const double size = half_space_size_;
    for (int i = 0; i <= kSquares; ++i) {
      const double at = size * (2.0 * i / kSquares - 1.0);
      line({at, -size, 0}, {at, size, 0});
      line({-size, at, 0}, {size, at, 0});
    }
  }
  // Each edge occurs in two faces, in opposite directions. It is drawn in the ascending one.
  void operator()(const ConvexHull& hull) {
    const auto corners = hull.vertices();
    for (const ConvexHull::Face& face : hull.faces()) {
      const std::size_t count = face.vertices.size();
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint16_t from = face.vertices[i], to = face.vertices[(i + 1) % count];
        if (from < to) line(corners[from], corners[to]);
      }
    }
  }
  // Inner edges are drawn twice, by both triangles.
  void operator()(const TriangleMesh& mesh) {
    const Vec3& s = mesh.scale();
    const auto corner = [&](std::uint32_t i) {
      const Vec3& v = mesh.vertices()[i];
      return Vec3{s.x * v.x, s.y * v.y, s.z * v.z};
    };
    for (const TriangleMesh::Triangle& t : mesh.triangles()) {
      line(corner(t[0]), corner(t[1]));
      line(corner(t[1]), corner(t[2]));
      line(corner(t[2]), corner(t[0]));
    }
  }
  void operator()(const HeightField& field) {
    for (std::uint32_t j = 0; j + 1 < field.rows(); ++j) {
      for (std::uint32_t i = 0; i + 1 < field.columns(); ++i) {
        if (field.is_hole(i, j)) continue;
        const Vec3 a = field.sample(i, j), b = field.sample(i + 1, j);
        const Vec3 c = field.sample(i + 1, j + 1), d = field.sample(i, j + 1);
        line(a, b);
        line(a, d);
        line(a, c);  // the diagonal of the two triangles
        line(b, c);
        line(d, c);
      }
    }
  }
  void operator()(const Compound& compound) {
    for (const CompoundPart& part : compound.parts()) {
      draw_wire(part.shape, T_ * part.T_compound_part, half_space_size_, category_, draw_);
    }
  }

 private:
  // Draws some segments of a circle, from x towards y.
  void arc(const Vec3& centre, const Vec3& x, const Vec3& y, int segments) {
    Vec3 from = centre + x;
    for (int i = 1; i <= segments; ++i) {
      const auto [s, c] = sin_cos(2.0 * kPi * i / kSegments);
      const Vec3 to = centre + c * x + s * y;
      line(from, to);
      from = to;
    }
  }
  // Four lines from a circle below to one above.
  void sides(double radius_below, double radius_above, double half) {
    for (const Vec3& out : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, -1, 0}}) {
      const Vec3 up{0, 0, half};
      line(radius_below * out - up, radius_above * out + up);
    }
  }

  SE3 T_;
  double half_space_size_;
  DebugCategory category_;
  DebugDraw& draw_;
};

}  // namespace

void draw_wire(const Shape& shape, const SE3& T, double half_space_size, DebugCategory category,
               DebugDraw& draw) {
  std::visit(Wire(T, half_space_size, category, draw), shape);
}

void draw_box(const SE3& T, const Vec3& half_extents, DebugCategory category, DebugDraw& draw) {
  Wire(T, 0.0, category, draw)(Box{half_extents});
}

}  // namespace vp
