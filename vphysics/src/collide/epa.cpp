// A polytope inside A - B that contains the origin grows by the support point in the direction of
// its face closest to the origin, until that face is one of A - B itself. The distance of the
// closest face is a lower bound of the depth; that of each support plane is an upper bound.
//
// Source: van den Bergen, Proximity Queries and Penetration Depth Computation on 3D Game Objects,
// 2001.
#include "collide/epa.h"

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

namespace vp::collide {
namespace {

constexpr int kEpaVertices = 96;
constexpr int kEpaFaces = 2 * kEpaVertices;
constexpr int kEpaHorizon = kEpaVertices;
// Convergence: the maximum difference of the bounds [fraction of the pair's extent].
constexpr double kEpaClosed = 1e-9;
// A point less than this above a face [fraction of the pair's extent] is on it.
constexpr double kEpaCoplanar = 1e-14;

struct EpaFace {
  std::array<std::uint8_t, 3> v;        // counter-clockwise from outside
  std::array<std::uint16_t, 3> beside;  // across the edge from v[i] to the next
  bool alive, seen;
  Vec3 n;
  double d;  // offset of its plane from the origin, along n
};

struct EpaHorizon {
  std::uint8_t from, to;
  std::uint16_t beyond;
};

class ExpandingPolytope {
 public:
  explicit ExpandingPolytope(const CorePair& pair) : pair_(pair) {}

  bool start(const Simplex& simplex);
  Penetration expand(double enough);

 private:
  bool complete_to_tetrahedron(const Simplex& simplex);
  int add_face(int a, int b, int c);
  bool link(int f, int g);
  int nearest() const;
  bool add_vertex(const CorePoint& p, int face);
  bool see(int face, const Vec3& w);

  const CorePair& pair_;
  CorePoint vertices_[kEpaVertices];
  int vertex_count_ = 0;
  EpaFace faces_[kEpaFaces];
  int face_count_ = 0;
  std::uint16_t free_[kEpaFaces];
  int free_count_ = 0;
  std::uint16_t seen_[kEpaFaces];
  int seen_count_ = 0;
  EpaHorizon horizon_[kEpaHorizon];
  int horizon_count_ = 0;
};

// If the simplex has fewer than four points, it contains the origin: support points complete it to
// a tetrahedron.
bool ExpandingPolytope::complete_to_tetrahedron(const Simplex& simplex) {
  vertex_count_ = simplex.count;
  for (int i = 0; i < simplex.count; ++i) vertices_[i] = simplex.p[i];
  const double smallest = kEpaCoplanar * pair_.extent;
  const auto farthest = [&](auto&& measure, std::span<const Vec3> directions) {
    double largest = smallest;
    CorePoint best{};
    for (const Vec3& d : directions) {
      for (const double sign : {1.0, -1.0}) {
        const CorePoint p = support_of(pair_, sign * d);
        const double m = measure(p.w);
        if (m > largest) {
          largest = m;
          best = p;
        }
      }
    }
    if (largest > smallest) vertices_[vertex_count_++] = best;
    return largest > smallest;
  };
  const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Vec3 &p = vertices_[0].w, &q = vertices_[1].w, &r = vertices_[2].w;
  if (vertex_count_ < 2 && !farthest([&](const Vec3& w) { return norm(w - p); }, axes))
    return false;
  if (vertex_count_ < 3) {
    const Vec3 line = (1.0 / norm(q - p)) * (q - p);
    const Vec3 sides[] = {cross(line, axes[0]), cross(line, axes[1]), cross(line, axes[2])};
    if (!farthest([&](const Vec3& w) { return norm(cross(line, w - p)); }, sides)) return false;
  }
  if (vertex_count_ < 4) {
    const Vec3 c = cross(q - p, r - p);
    const Vec3 n[] = {(1.0 / norm(c)) * c};
    if (!farthest([&](const Vec3& w) { return std::fabs(dot(n[0], w - p)); }, n)) return false;
  }
  return true;
}

bool ExpandingPolytope::start(const Simplex& simplex) {
  if (!complete_to_tetrahedron(simplex)) return false;
  const Vec3 &a = vertices_[0].w, &b = vertices_[1].w, &c = vertices_[2].w, &d = vertices_[3].w;
  const double volume = dot(cross(b - a, c - a), d - a);
  if (volume > 0.0) std::swap(vertices_[1], vertices_[2]);  // d below a, b, c
  if (!(std::fabs(volume) > 0.0)) return false;
  const int f[] = {add_face(0, 1, 2), add_face(1, 0, 3), add_face(2, 1, 3), add_face(0, 2, 3)};
  for (const int face : f) {
    if (face < 0) return false;
  }
  bool linked = true;
  for (int i = 0; i < 4; ++i) {
    for (int k = i + 1; k < 4; ++k) linked &= link(f[i], f[k]);
  }
  return linked;
}

// Returns -1 if the capacity is reached, or the face has no area.
int ExpandingPolytope::add_face(int a, int b, int c) {
  int index = face_count_;
  if (free_count_ > 0) {
    index = free_[free_count_ - 1];
  } else if (face_count_ == kEpaFaces) {
    return -1;
  }
  EpaFace& f = faces_[index];
  const Vec3 &p = vertices_[a].w, &q = vertices_[b].w, &r = vertices_[c].w;
  const Vec3 n = cross(q - p, r - p);
  const double length = norm(n);
  if (!(length > std::numeric_limits<double>::min())) return -1;
  f.v = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b), static_cast<std::uint8_t>(c)};
  f.n = (1.0 / length) * n;
  f.d = dot(f.n, p);
  f.alive = true;
  f.seen = false;
  free_count_ > 0 ? --free_count_ : ++face_count_;
  return index;
}

bool ExpandingPolytope::link(int f, int g) {
  EpaFace &a = faces_[f], &b = faces_[g];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (a.v[i] != b.v[(k + 1) % 3] || a.v[(i + 1) % 3] != b.v[k]) continue;
      a.beside[i] = static_cast<std::uint16_t>(g);
      b.beside[k] = static_cast<std::uint16_t>(f);
      return true;
    }
  }
  return false;
}

int ExpandingPolytope::nearest() const {
  int best = -1;
  for (int i = 0; i < face_count_; ++i) {
    if (faces_[i].alive && (best < 0 || faces_[i].d < faces_[best].d)) best = i;
  }
  return best;
}

// Finds the faces that w is above, and the edge loop around them.
bool ExpandingPolytope::see(int face, const Vec3& w) {
  seen_count_ = horizon_count_ = 0;
  seen_[seen_count_++] = static_cast<std::uint16_t>(face);
  faces_[face].seen = true;
  const double above = kEpaCoplanar * pair_.extent;
  for (int i = 0; i < seen_count_; ++i) {
    const EpaFace& f = faces_[seen_[i]];
    for (std::size_t k = 0; k < 3; ++k) {
      EpaFace& next = faces_[f.beside[k]];
      if (next.seen) continue;
      if (dot(next.n, w) - next.d > above) {
        next.seen = true;
        seen_[seen_count_++] = f.beside[k];
      } else if (horizon_count_ < kEpaHorizon) {
        horizon_[horizon_count_++] = {f.v[k], f.v[(k + 1) % 3], f.beside[k]};
      } else {
        return false;
      }
    }
  }
  return true;
}

// Returns false if rounding errors or the capacity prevent it; the polytope is then unusable.
bool ExpandingPolytope::add_vertex(const CorePoint& p, int face) {
  if (vertex_count_ == kEpaVertices) return false;
  const int v = vertex_count_++;
  vertices_[v] = p;
  if (!see(face, p.w)) return false;
  for (int i = 0; i < seen_count_; ++i) {
    faces_[seen_[i]].alive = false;
    free_[free_count_++] = seen_[i];
  }
  int starts_at[kEpaVertices];
  int fresh[kEpaHorizon];
  for (int i = 0; i < vertex_count_; ++i) starts_at[i] = -1;
  for (int i = 0; i < horizon_count_; ++i) {
    const EpaHorizon& e = horizon_[i];
    fresh[i] = add_face(e.from, e.to, v);
    if (fresh[i] < 0 || starts_at[e.from] >= 0 || !link(fresh[i], e.beyond)) return false;
    starts_at[e.from] = fresh[i];
  }
  for (int i = 0; i < horizon_count_; ++i) {
    const int next = starts_at[horizon_[i].to];
    if (next < 0 || !link(fresh[i], next)) return false;
  }
  return true;
}

// A direction near n that a shape prefers, in the frame of a: the normals of flat caps and faces,
// or of its side.
int preferred_near(const Geometry& g, const SE3& T, const Vec3& n, Vec3 (&found)[2]) {
  const Vec3 d = T.unrotate(n);
  const double radial = std::sqrt(d.x * d.x + d.y * d.y);
  int count = 0;
  if (g.kind == Kind::cone) {
    const double h = 2.0 * g.half.z, length = std::sqrt(h * h + g.radius * g.radius);
    const Vec3 side = (h / length) * rim_direction(d) + Vec3{0, 0, g.radius / length};
    found[count++] = T.rotate(side);
    if (d.z < 0.0) found[count++] = -T.rotation().cz;
  } else if (g.kind == Kind::cylinder || g.kind == Kind::capsule) {
    if (radial > 0.0) found[count++] = T.rotate(rim_direction(d));
    if (g.kind == Kind::cylinder) found[count++] = std::copysign(1.0, d.z) * T.rotation().cz;
  }
  return count;
}

// Curved surfaces are approached from many directions, and slowly if many of them have the same
// depth. Directions that the shapes themselves suggest are better, or as good and more stable.
void polish(const CorePair& pair, Penetration& best) {
  const double as_good = kEpaClosed * pair.extent;
  const auto consider = [&](const Vec3& n) {
    constexpr double kNear = 0.99;
    if (!(dot(n, best.normal) > kNear)) return;
    const CorePoint p = support_of(pair, n);
    const double depth = dot(n, p.w);
    if (!(depth <= best.depth + as_good)) return;
    best.depth = depth;
    best.normal = n;
    best.on_a = p.a;
    best.on_b = p.b();
  };
  for (int iteration = 0; iteration < 2; ++iteration) {
    Vec3 found[2];
    for (const bool of_a : {true, false}) {
      const SE3 T = of_a ? SE3{} : pair.T_a_b;
      const Vec3 n = of_a ? best.normal : -best.normal;
      const int count = preferred_near(of_a ? pair.a : pair.b, T, n, found);
      for (int i = 0; i < count; ++i) consider(of_a ? found[i] : -found[i]);
    }
    const Vec3 radial = cross(Vec3{0, 0, 1}, pair.T_a_b.rotation().cz);
    const double sine = norm(radial);
    if (sine > 1e-6) consider((dot(radial, best.normal) < 0.0 ? -1.0 / sine : 1.0 / sine) * radial);
  }
}

// Sets the points where the cores touch once b is moved along the normal: the closest points after
// a slightly larger move.
void set_witness(const CorePair& pair, Penetration& found) {
  constexpr double kFarther = 1e-3;  // fraction of the pair's extent
  const Vec3 shift = (found.depth + kFarther * pair.extent) * found.normal;
  const SE3& T = pair.T_a_b;
  const CorePair separated(pair.a, pair.b, SE3(T.rotation(), T.position() + shift));
  const GjkResult near = gjk(separated, found.normal, std::numeric_limits<double>::infinity());
  if (near.state != GjkResult::State::separated) return;
  found.on_a = near.on_a;
  found.on_b = near.on_a - found.depth * found.normal;
}

Penetration ExpandingPolytope::expand(double enough) {
  Penetration best{std::numeric_limits<double>::infinity(), 0.0, {}, {}, {}};
  const double closed = kEpaClosed * pair_.extent;
  for (;;) {
    const int f = nearest();
    const EpaFace face = faces_[f];
    const CorePoint p = support_of(pair_, face.n);
    const double upper = dot(face.n, p.w);
    if (upper < best.depth) {
      best.depth = upper;
      best.normal = face.n;
      best.on_a = p.a;
      best.on_b = p.b();
    }
    best.at_least = std::min(face.d, best.depth);
    if (best.depth - face.d <= closed || face.d >= enough) return best;
    if (!add_vertex(p, f)) return best;
  }
}

}  // namespace

Penetration epa(const CorePair& pair, const Simplex& simplex, double enough) {
  ExpandingPolytope polytope(pair);
  if (polytope.start(simplex)) {
    Penetration found = polytope.expand(enough);
    if (found.at_least >= enough) return found;
    polish(pair, found);
    pair.rough |= found.depth - found.at_least > kRough * pair.size;
    set_witness(pair, found);
    return found;
  }
  // Their overlap has no volume: up to rounding, they touch in a point, a line or a plane.
  Vec3 n = pair.T_a_b * core_centre(pair.b) - core_centre(pair.a);
  const double length = norm(n);
  n = length > 0.0 ? (1.0 / length) * n : Vec3{0, 0, 1};
  const CorePoint p = support_of(pair, n);
  return {dot(n, p.w), 0.0, n, p.a, p.b()};
}

}  // namespace vp::collide
