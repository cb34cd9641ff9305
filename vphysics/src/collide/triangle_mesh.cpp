#include "vphysics/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "collide/mesh_data.h"

namespace vp {
namespace {

using collide::MeshData;

constexpr std::size_t kMaxTriangles = std::size_t{1} << 26, kMaxMeshVertices = kMaxTriangles;
constexpr double kFarthestVertex = 1e9;  // of a coordinate [m], the engine's limit
constexpr double kMinFactor = 1e-6, kMaxFactor = 1e6;
// Triangles with a smaller height, as a fraction of the longest edge, are degenerate: their normal
// is rounding noise.
constexpr double kNoHeight = 1e-10;

tl::unexpected<Error> invalid_mesh(std::string message) {
  return tl::make_unexpected(Error{Errc::invalid_argument, "triangle mesh: " + std::move(message)});
}

Expected<void> check(std::span<const Vec3> vertices,
                     std::span<const TriangleMesh::Triangle> triangles) {
  if (triangles.empty()) return invalid_mesh("there are no triangles; give at least one");
  if (triangles.size() > kMaxTriangles || vertices.size() > kMaxMeshVertices) {
    return invalid_mesh("more than 2^26 triangles or vertices; split the mesh into several");
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (const double x : {vertices[i].x, vertices[i].y, vertices[i].z}) {
      if (std::fabs(x) <= kFarthestVertex) continue;
      return invalid_mesh("vertex " + std::to_string(i) +
                          " is not finite or beyond 1e9 m; correct it");
    }
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t v : triangles[i]) {
      if (v < vertices.size()) continue;
      return invalid_mesh("triangle " + std::to_string(i) + " names vertex " + std::to_string(v) +
                          " of " + std::to_string(vertices.size()) + "; indices count from 0");
    }
  }
  return {};
}

// For each vertex, the first vertex at the same position.
std::vector<std::uint32_t> first_at_each_position(std::span<const Vec3> vertices) {
  std::vector<std::uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t k) {
    const Vec3 &a = vertices[i], &b = vertices[k];
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z != b.z ? a.z < b.z : i < k;
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

bool has_no_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const double longest = std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)});
  return !(norm(cross(ab, bc)) > kNoHeight * longest);
}

void set_tree(MeshData& mesh) {
  std::vector<collide::TreeItem> items;
  mesh.lower = {1e300, 1e300, 1e300};
  mesh.upper = -mesh.lower;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.degenerate[t] != 0) continue;
    collide::Bounds b;
    for (const std::uint32_t v : mesh.triangles[t]) {
      b = merged(b, {mesh.vertices[v], mesh.vertices[v]});
    }
    for (int i = 0; i < 3; ++i) {
      mesh.lower[i] = std::min(mesh.lower[i], b.lower[i]);
      mesh.upper[i] = std::max(mesh.upper[i], b.upper[i]);
    }
    items.push_back({collide::rounded_outward(b), t});
  }
  mesh.tree.build(items, collide::BoundingTree::Effort::careful);
}

// Adds tetrahedra from the centre to each triangle: of volume V, V S / 4 and V (S S^T + the sum of
// each corner's) / 20, S the sum of its corners.
void set_moments(MeshData& mesh) {
  mesh.centre = 0.5 * (mesh.lower + mesh.upper);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.degenerate[t] != 0) continue;
    const TriangleMesh::Triangle& i = mesh.triangles[t];
    const Vec3 a = mesh.vertices[i[0]] - mesh.centre, b = mesh.vertices[i[1]] - mesh.centre,
               c = mesh.vertices[i[2]] - mesh.centre;
    const double V = dot(a, cross(b, c)) / 6.0;
    const Vec3 S = a + b + c;
    const double k = 0.05 * V;
    mesh.volume += V;
    mesh.first_moment += (0.25 * V) * S;
    mesh.second_moment =
        mesh.second_moment + (outer(k, S) + outer(k, a)) + (outer(k, b) + outer(k, c));
  }
}

}  // namespace

Expected<TriangleMesh> TriangleMesh::of(std::span<const Vec3> vertices,
                                        std::span<const Triangle> triangles,
                                        const MeshOptions& options) {
  if (const Expected<void> checked = check(vertices, triangles); !checked) {
    return tl::make_unexpected(checked.error());
  }
  auto mesh = std::make_shared<MeshData>();
  mesh->two_sided = options.two_sided;
  mesh->vertices.assign(vertices.begin(), vertices.end());
  const std::vector<std::uint32_t> first = first_at_each_position(vertices);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle t{first[triangles[i][0]], first[triangles[i][1]], first[triangles[i][2]]};
    const bool degenerate = has_no_area(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
    if (degenerate && options.reject_degenerate) {
      return invalid_mesh("triangle " + std::to_string(i) +
                          " has no area; leave it out, or do not set reject_degenerate");
    }
    mesh->triangles.push_back(t);
    mesh->degenerate.push_back(degenerate ? 1 : 0);
    mesh->left_out += degenerate ? 1 : 0;
  }
  if (mesh->left_out == triangles.size()) {
    return invalid_mesh("no triangle has an area; check the vertices and their unit, the metre");
  }
  collide::set_topology(*mesh);
  set_tree(*mesh);
  set_moments(*mesh);
  return TriangleMesh(std::move(mesh));
}

Expected<TriangleMesh> TriangleMesh::scaled(const Vec3& factors) const {
  if (!data_) return invalid_mesh("it was moved from; scale the one that it was moved to");
  TriangleMesh made = *this;
  for (int i = 0; i < 3; ++i) {
    made.scale_[i] *= factors[i];
    for (const double s : {factors[i], made.scale_[i]}) {
      if (s >= kMinFactor && s <= kMaxFactor) continue;
      return invalid_mesh("every factor of a scale, and what it gives, must be from 1e-6 to 1e6");
    }
  }
  return made;
}

std::span<const Vec3> TriangleMesh::vertices() const {
  return data_->vertices;
}
std::span<const TriangleMesh::Triangle> TriangleMesh::triangles() const {
  return data_->triangles;
}
std::size_t TriangleMesh::left_out() const {
  return data_->left_out;
}
bool TriangleMesh::two_sided() const {
  return data_->two_sided;
}
bool TriangleMesh::closed() const {
  return data_->closed;
}

double TriangleMesh::volume() const {
  return scale_.x * scale_.y * scale_.z * data_->volume;
}

// The map x -> D x changes x x^T to D x x^T D, and volumes by the factor det D.
Expected<Inertia> TriangleMesh::inertia(double density) const {
  if (!data_) return invalid_mesh("it was moved from; ask the one that it was moved to");
  if (!(density > 0.0 && density <= 1e12)) {
    return invalid_mesh("the density must be positive and at most 1e12 kg/m^3");
  }
  if (!data_->closed || !(data_->volume > 0.0)) {
    return invalid_mesh(
        "only a closed mesh whose triangles face outwards has a mass; give the body's inertia");
  }
  const Vec3& D = scale_;
  const auto stretched = [&](const Vec3& a) { return Vec3{D.x * a.x, D.y * a.y, D.z * a.z}; };
  const double k = density * D.x * D.y * D.z;
  const Sym3& s = data_->second_moment;
  const double xx = k * D.x * D.x * s.xx, yy = k * D.y * D.y * s.yy, zz = k * D.z * D.z * s.zz;
  const Sym3 rotational{yy + zz,
                        zz + xx,
                        xx + yy,
                        -k * D.x * D.y * s.xy,
                        -k * D.y * D.z * s.yz,
                        -k * D.z * D.x * s.zx};
  const Inertia about_centre(k * data_->volume, k * stretched(data_->first_moment), rotational);
  return about_centre.about(-stretched(data_->centre));
}

}  // namespace vp
