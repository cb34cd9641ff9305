// Quickhull with outside sets: each iteration adds the point farthest outside all facets. A cone
// from their horizon replaces the facets that it sees. On a grid of 41 bits per coordinate every
// decision is exact in 128 bits (a height is a sum of six products of three differences, below
// 2^123). So the facets always close, for any points.
//
// Source: Barber, Dobkin, Huhdanpaa, The Quickhull Algorithm for Convex Hulls, 1996.
#include "collide/quickhull.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace vp::collide {
namespace {

__extension__ using Wide = __int128;

struct WideVector {
  Wide x, y, z;
};

GridPoint difference(const GridPoint& a, const GridPoint& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
WideVector wide_cross(const GridPoint& a, const GridPoint& b) {
  return {Wide{a.y} * b.z - Wide{a.z} * b.y, Wide{a.z} * b.x - Wide{a.x} * b.z,
          Wide{a.x} * b.y - Wide{a.y} * b.x};
}
Wide wide_dot(const WideVector& a, const GridPoint& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
double length(double x, double y, double z) {
  return std::sqrt(x * x + y * y + z * z);
}
double length(const WideVector& a) {
  return length(static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z));
}
double length(const GridPoint& a) {
  return length(static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z));
}

constexpr std::uint32_t kNoFacet = 0xffffffffu;

struct Facet {
  Triangle v;
  std::array<std::uint32_t, 3> beside;  // across the edge from v[i] to the next
  WideVector normal;
  double normal_length;
  std::vector<std::uint32_t> outside;  // points above; each is in one facet's set
  double farthest_distance = 0.0;
  std::uint32_t farthest = 0;
  bool alive = true;
  bool visible = false;
};

struct HorizonEdge {
  std::uint32_t from, to;  // counter-clockwise around the visible facets
  std::uint32_t beyond;    // the facet that remains
};

class QuickhullBuilder {
 public:
  QuickhullBuilder(std::span<const GridPoint> points, double tolerance)
      : points_(points), tolerance_(tolerance), starts_at_(points.size(), kNoFacet) {}

  Quickhull::Result start(double thinnest);
  bool grow();
  std::uint32_t vertices() const { return alive_ / 2 + 2; }  // Euler's formula for triangles
  std::vector<Triangle> triangles() const;
  double tolerance() const { return tolerance_; }

 private:
  Wide height(const Facet& f, std::uint32_t p) const {
    return wide_dot(f.normal, difference(points_[p], points_[f.v[0]]));
  }
  double distance(const Facet& f, std::uint32_t p) const {
    return static_cast<double>(height(f, p)) / f.normal_length;
  }
  std::uint32_t add_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void link(std::uint32_t f, std::uint32_t g);
  void see(std::uint32_t first, std::uint32_t p);
  void add_cone(std::uint32_t p);
  void assign(std::uint32_t p, std::span<const std::uint32_t> candidates);
  void assign_to_any(std::uint32_t p);
  void put(std::uint32_t p, Facet& f, double d);

  std::span<const GridPoint> points_;
  double tolerance_;
  std::vector<Facet> facets_;
  std::uint32_t alive_ = 0;
  std::vector<std::uint32_t> starts_at_;  // by vertex: the new facet whose first edge starts there
  std::vector<std::uint32_t> seen_, fresh_, loose_;
  std::vector<HorizonEdge> horizon_;
};

std::uint32_t QuickhullBuilder::add_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  Facet f;
  f.v = {a, b, c};
  f.beside = {kNoFacet, kNoFacet, kNoFacet};
  f.normal = wide_cross(difference(points_[b], points_[a]), difference(points_[c], points_[a]));
  f.normal_length = length(f.normal);
  facets_.push_back(std::move(f));
  ++alive_;
  return static_cast<std::uint32_t>(facets_.size() - 1);
}

// Links two facets that share an edge.
void QuickhullBuilder::link(std::uint32_t f, std::uint32_t g) {
  Facet &a = facets_[f], &b = facets_[g];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (a.v[i] != b.v[(k + 1) % 3] || a.v[(i + 1) % 3] != b.v[k]) continue;
      a.beside[i] = g;
      b.beside[k] = f;
    }
  }
}

void QuickhullBuilder::put(std::uint32_t p, Facet& f, double d) {
  f.outside.push_back(p);
  if (d > f.farthest_distance || (d == f.farthest_distance && p < f.farthest)) {
    f.farthest_distance = d;
    f.farthest = p;
  }
}

// Assigns a point to the candidate facet that it is highest above. Another facet may see a point
// that is not far enough above any candidate; otherwise it is within tolerance of the hull and is
// dropped.
void QuickhullBuilder::assign(std::uint32_t p, std::span<const std::uint32_t> candidates) {
  std::uint32_t best = kNoFacet;
  double largest = 0.0;
  for (const std::uint32_t f : candidates) {
    const double d = distance(facets_[f], p);
    if (d > largest) {
      largest = d;
      best = f;
    }
  }
  if (best == kNoFacet) return;
  if (largest > tolerance_) {
    put(p, facets_[best], largest);
  } else {
    assign_to_any(p);
  }
}

void QuickhullBuilder::assign_to_any(std::uint32_t p) {
  for (Facet& f : facets_) {
    const double d = f.alive ? distance(f, p) : 0.0;
    if (d > tolerance_) return put(p, f, d);
  }
}

// Chooses four points that are far apart, at low cost.
Quickhull::Result QuickhullBuilder::start(double thinnest) {
  using Result = Quickhull::Result;
  const auto n = static_cast<std::uint32_t>(points_.size());
  // The longest of the three segments between the extremes along the axes; ties go to the lowest
  // index.
  std::uint32_t a = 0, b = 0;
  double longest = 0.0;
  for (std::int64_t GridPoint::*axis : {&GridPoint::x, &GridPoint::y, &GridPoint::z}) {
    std::uint32_t low = 0, high = 0;
    for (std::uint32_t i = 1; i < n; ++i) {
      if (points_[i].*axis < points_[low].*axis) low = i;
      if (points_[i].*axis > points_[high].*axis) high = i;
    }
    const double d = length(difference(points_[high], points_[low]));
    if (d > longest) {
      longest = d;
      a = low;
      b = high;
    }
  }
  if (longest <= thinnest) return Result::point;
  const auto farthest = [&](auto&& measure, double& largest) {
    std::uint32_t best = 0;
    largest = 0.0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const double d = measure(i);
      if (d > largest) {
        largest = d;
        best = i;
      }
    }
    return best;
  };
  double off_line = 0.0, off_plane = 0.0;
  const GridPoint ab = difference(points_[b], points_[a]);
  const std::uint32_t c = farthest(
      [&](std::uint32_t i) {
        return length(wide_cross(ab, difference(points_[i], points_[a]))) / longest;
      },
      off_line);
  if (off_line <= thinnest) return Result::line;
  const WideVector normal = wide_cross(ab, difference(points_[c], points_[a]));
  const auto above = [&](std::uint32_t i) {
    return wide_dot(normal, difference(points_[i], points_[a]));
  };
  const double scale = length(normal);
  const std::uint32_t d = farthest(
      [&](std::uint32_t i) { return std::fabs(static_cast<double>(above(i))) / scale; }, off_plane);
  if (off_plane <= thinnest) return Result::plane;
  tolerance_ = std::min(tolerance_, 0.01 * off_plane);
  if (above(d) > 0) std::swap(b, a);  // so that d is below a, b, c
  const std::uint32_t f[] = {add_facet(a, b, c), add_facet(b, a, d), add_facet(c, b, d),
                             add_facet(a, c, d)};
  for (int i = 0; i < 4; ++i) {
    for (int k = i + 1; k < 4; ++k) link(f[i], f[k]);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    if (i != a && i != b && i != c && i != d) assign(i, f);
  }
  return Result::hull;
}

// Marks the facets that p is above, and collects the edges around them.
void QuickhullBuilder::see(std::uint32_t first, std::uint32_t p) {
  seen_.assign(1, first);
  horizon_.clear();
  facets_[first].visible = true;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t next = facets_[seen_[i]].beside[k];
      if (facets_[next].visible) continue;
      if (height(facets_[next], p) > 0) {
        facets_[next].visible = true;
        seen_.push_back(next);
      } else {
        const Triangle& v = facets_[seen_[i]].v;
        horizon_.push_back({v[k], v[(k + 1) % 3], next});
      }
    }
  }
}

void QuickhullBuilder::add_cone(std::uint32_t p) {
  fresh_.clear();
  for (const HorizonEdge& e : horizon_) {
    const std::uint32_t f = add_facet(e.from, e.to, p);
    link(f, e.beyond);
    starts_at_[e.from] = f;
    fresh_.push_back(f);
  }
  for (const std::uint32_t f : fresh_) link(f, starts_at_[facets_[f].v[1]]);
}

// Adds the point that is farthest outside; returns false if there is none.
bool QuickhullBuilder::grow() {
  std::uint32_t best = kNoFacet;
  for (std::uint32_t f = 0; f < facets_.size(); ++f) {
    if (!facets_[f].alive || facets_[f].outside.empty()) continue;
    if (best == kNoFacet || facets_[f].farthest_distance > facets_[best].farthest_distance)
      best = f;
  }
  if (best == kNoFacet) return false;
  const std::uint32_t p = facets_[best].farthest;
  see(best, p);
  add_cone(p);
  loose_.clear();
  for (const std::uint32_t f : seen_) {
    Facet& gone = facets_[f];
    for (const std::uint32_t i : gone.outside) {
      if (i != p) loose_.push_back(i);
    }
    gone.outside = {};
    gone.alive = false;
    --alive_;
  }
  std::sort(loose_.begin(), loose_.end());
  for (const std::uint32_t i : loose_) assign(i, fresh_);
  return true;
}

std::vector<Triangle> QuickhullBuilder::triangles() const {
  std::vector<Triangle> found;
  for (const Facet& f : facets_) {
    if (f.alive) found.push_back(f.v);
  }
  return found;
}

}  // namespace

Quickhull quickhull(std::span<const GridPoint> points, int max_vertices, double tolerance,
                    double thinnest) {
  QuickhullBuilder builder(points, tolerance);
  Quickhull hull;
  hull.result = builder.start(thinnest);
  if (hull.result != Quickhull::Result::hull) return hull;
  while (builder.vertices() < static_cast<std::uint32_t>(max_vertices) && builder.grow()) continue;
  hull.triangles = builder.triangles();
  hull.tolerance = builder.tolerance();
  return hull;
}

}  // namespace vp::collide
