#include "view/shape_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>

namespace sandbox {
namespace {

// Edges are rounded to catch light, by this fraction of the shape's smallest half extent; it hides
// nothing of how shapes touch.
constexpr float kBevel = 0.05f;

struct Builder {
  ShapeMesh mesh;

  std::uint32_t vertex(const glm::vec3& core, const glm::vec3& normal) {
    mesh.vertices.push_back({core, normal});
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.indices.insert(mesh.indices.end(), {a, b, c});
  }
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
};

// Three vertices per corner, one for each adjacent face: six faces, strips along the edges and a
// triangle at each corner, over which the normal changes.
ShapeMesh box_mesh() {
  Builder b;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 core{(corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                         (corner & 4) != 0 ? 1 : -1};
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 normal(0.0f);
      normal[axis] = core[axis];
      b.vertex(core, normal);
    }
  }
  const auto at = [](int corner, int axis) {
    return static_cast<std::uint32_t>(3 * corner + axis);
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int x = 1 << axis, y = 1 << (axis + 1) % 3, z = 1 << (axis + 2) % 3;
    b.quad(at(x, axis), at(x | y, axis), at(x | y | z, axis), at(x | z, axis));
    b.quad(at(0, axis), at(z, axis), at(y | z, axis), at(y, axis));
    // The four edges along x, between the faces of y and z.
    const int ay = (axis + 1) % 3, az = (axis + 2) % 3;
    b.quad(at(y | z, ay), at(y | z, az), at(x | y | z, az), at(x | y | z, ay));
    b.quad(at(0, ay), at(0, az), at(x, az), at(x, ay));
    b.quad(at(y, az), at(y, ay), at(x | y, ay), at(x | y, az));
    b.quad(at(z, az), at(z, ay), at(x | z, ay), at(x | z, az));
  }
  for (int corner = 0; corner < 8; ++corner) {
    const int signs = (corner & 1) + (corner >> 1 & 1) + (corner >> 2 & 1);
    if (signs % 2 == 1) {
      b.triangle(at(corner, 0), at(corner, 1), at(corner, 2));
    } else {
      b.triangle(at(corner, 0), at(corner, 2), at(corner, 1));
    }
  }
  return b.mesh;
}

struct ProfilePoint {
  glm::vec2 core, normal;  // from the axis, and along it
};

// A profile revolved about z, from the bottom to the top; it begins and ends on the axis.
ShapeMesh turned(const std::vector<ProfilePoint>& profile, int slices) {
  Builder b;
  for (int i = 0; i <= slices; ++i) {
    const float angle = glm::two_pi<float>() * static_cast<float>(i) / static_cast<float>(slices);
    const glm::vec2 out{std::cos(angle), std::sin(angle)};
    for (const ProfilePoint& p : profile) {
      b.vertex(glm::vec3(out * p.core.x, p.core.y), glm::vec3(out * p.normal.x, p.normal.y));
    }
  }
  const auto count = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(slices); ++i) {
    for (std::uint32_t k = 0; k + 1 < count; ++k) {
      const std::uint32_t a = i * count + k, c = a + count;
      if (k > 0) b.triangle(a, c, c + 1);
      if (k + 2 < count) b.triangle(a, c + 1, a + 1);
    }
  }
  return b.mesh;
}

// Semicircles about core points at -z and +z; z = 0 gives a sphere.
std::vector<ProfilePoint> round_profile(float z, int stacks) {
  std::vector<ProfilePoint> profile;
  const auto arc = [&](float from, float core) {
    for (int i = 0; i <= stacks; ++i) {
      const float angle =
          from + glm::half_pi<float>() * static_cast<float>(i) / static_cast<float>(stacks);
      profile.push_back({{0.0f, core}, {std::max(std::cos(angle), 0.0f), std::sin(angle)}});
    }
  };
  arc(-glm::half_pi<float>(), -z);
  if (z == 0.0f) profile.pop_back();
  arc(0.0f, z);
  profile.front().normal = {0.0f, -1.0f};
  profile.back().normal = {0.0f, 1.0f};
  return profile;
}

std::vector<ProfilePoint> cylinder_profile() {
  return {{{0, -1}, {0, -1}}, {{1, -1}, {0, -1}}, {{1, -1}, {1, 0}},
          {{1, 1}, {1, 0}},   {{1, 1}, {0, 1}},   {{0, 1}, {0, 1}}};
}

// Without rounding, so that the slant's normal follows its stretch.
std::vector<ProfilePoint> cone_profile() {
  const glm::vec2 slant = glm::normalize(glm::vec2(2, 1));
  return {{{0, -1}, {0, -1}}, {{1, -1}, {0, -1}}, {{1, -1}, slant}, {{0, 1}, slant}};
}

float narrow(double x) {
  return static_cast<float>(x);
}

struct Stretch {
  glm::vec4 operator()(const vp::Sphere& s) const { return {1, 1, 1, narrow(s.radius)}; }
  glm::vec4 operator()(const vp::Box& s) const {
    const glm::vec3 h{narrow(s.half_extents.x), narrow(s.half_extents.y), narrow(s.half_extents.z)};
    const float bevel = kBevel * std::min({h.x, h.y, h.z});
    return {h - bevel, bevel};
  }
  glm::vec4 operator()(const vp::Capsule& s) const {
    return {1, 1, narrow(s.half_length), narrow(s.radius)};
  }
  glm::vec4 operator()(const vp::Cylinder& s) const {
    const float r = narrow(s.radius), h = narrow(s.half_length);
    const float bevel = kBevel * std::min(r, h);
    return {r - bevel, r - bevel, h - bevel, bevel};
  }
  glm::vec4 operator()(const vp::Cone& s) const {
    return {narrow(s.radius), narrow(s.radius), narrow(s.half_height), 0};
  }
  template <class Other>
  glm::vec4 operator()(const Other&) const {
    return {1, 1, 1, 0};
  }
};

}  // namespace

ShapeMesh shape_mesh(ShapeKind kind, float detail) {
  const auto scaled = [&](int count) {
    return std::max(2, static_cast<int>(std::lround(static_cast<float>(count) * detail)));
  };
  const int slices = 4 * scaled(7);
  switch (kind) {
    case ShapeKind::box:
      return box_mesh();
    case ShapeKind::sphere:
      return turned(round_profile(0.0f, scaled(8)), slices);
    case ShapeKind::capsule:
      return turned(round_profile(1.0f, scaled(6)), slices);
    case ShapeKind::cylinder:
      return turned(cylinder_profile(), slices);
    case ShapeKind::cone:
      return turned(cone_profile(), slices);
  }
  return {};
}

ShapeMesh hull_mesh(const vp::ConvexHull& hull) {
  Builder b;
  for (const vp::ConvexHull::Face& face : hull.faces()) {
    const glm::vec3 normal{narrow(face.normal.x), narrow(face.normal.y), narrow(face.normal.z)};
    std::vector<std::uint32_t> ring;
    for (const std::uint16_t index : face.vertices) {
      const vp::Vec3& p = hull.vertices()[index];
      ring.push_back(b.vertex({narrow(p.x), narrow(p.y), narrow(p.z)}, normal));
    }
    for (std::size_t i = 2; i < ring.size(); ++i) b.triangle(ring[0], ring[i - 1], ring[i]);
  }
  return b.mesh;
}

namespace {

// Flat shading: each triangle has separate vertices. A triangle without area is omitted.
void add_flat(Builder& b, const vp::Vec3& p, const vp::Vec3& q, const vp::Vec3& r) {
  const vp::Vec3 across = cross(q - p, r - p);
  const double size = norm(across);
  if (!(size > 0.0)) return;
  const vp::Vec3 n = (1.0 / size) * across;
  const glm::vec3 normal{narrow(n.x), narrow(n.y), narrow(n.z)};
  const auto corner = [&](const vp::Vec3& v) {
    return b.vertex({narrow(v.x), narrow(v.y), narrow(v.z)}, normal);
  };
  const std::uint32_t first = corner(p), second = corner(q), third = corner(r);
  b.triangle(first, second, third);
}

}  // namespace

ShapeMesh surface_mesh(const vp::TriangleMesh& mesh) {
  Builder b;
  const vp::Vec3& s = mesh.scale();
  const auto at = [&](std::uint32_t v) {
    const vp::Vec3& p = mesh.vertices()[v];
    return vp::Vec3{s.x * p.x, s.y * p.y, s.z * p.z};
  };
  for (const auto& [i, j, k] : mesh.triangles()) {
    add_flat(b, at(i), at(j), at(k));
    if (mesh.two_sided()) add_flat(b, at(i), at(k), at(j));
  }
  return b.mesh;
}

ShapeMesh surface_mesh(const vp::HeightField& field) {
  Builder b;
  for (std::uint32_t j = 0; j + 1 < field.rows(); ++j) {
    for (std::uint32_t i = 0; i + 1 < field.columns(); ++i) {
      if (field.is_hole(i, j)) continue;
      const vp::Vec3 low = field.sample(i, j), high = field.sample(i + 1, j + 1);
      add_flat(b, low, field.sample(i + 1, j), high);
      add_flat(b, low, high, field.sample(i, j + 1));
    }
  }
  return b.mesh;
}

glm::vec4 stretch_of(const vp::Shape& shape) {
  return std::visit(Stretch{}, shape);
}

}  // namespace sandbox
