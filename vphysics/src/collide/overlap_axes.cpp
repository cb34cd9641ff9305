// Two overlapping polytopes: the separating axis theorem over faces and pairs of edges.
//
// Only edges whose arcs on the Gauss map cross form a face of A - B; the others are skipped. If the
// best face has a depth of D, two edges with less depth have closest points less than D apart. So
// along the face's normal neither is more than 2 D behind the foremost vertex: for touching shapes,
// few edges remain.
//
// Source: Gregorius, The Separating Axis Test between Convex Polyhedra, GDC 2013; the bound is
// derived here.
#include <algorithm>
#include <bit>
#include <cmath>

#include "collide/convex_contact.h"
#include "collide/polytope.h"

namespace vp::collide {
namespace {

constexpr int kMaxCornersOf = 256;
constexpr int kMaxEdgesOf = 3 * kMaxCornersOf;
static_assert(kMaxEdgesOf % kScanLanes == 0);
// The squared sine below which edges are parallel and give no axis.
constexpr double kParallelEdges = 1e-16;

struct View {
  const CorePair& pair;
  const Polytope& a;
  const Polytope& b;
};

// The face of one of the two that separates them farthest. Along its normal every point of the
// other is at least as far as its closest one. So its centre rules out the faces on the far side;
// the closest point of the best face so far, which is where the shapes meet, nearly all others.
class FaceSearch {
 public:
  // towards: the other, in A's frame. The face that points there is tried first.
  FaceSearch(const View& view, bool of_a, const Vec3& towards)
      : v_(view), of_a_(of_a), own_(of_a ? view.a : view.b) {
    const Vec3 centre =
        of_a ? v_.pair.T_a_b * core_centre(v_.pair.b) : in_b(core_centre(v_.pair.a));
    try_face(face_towards(own_, of_a ? towards : v_.pair.T_a_b.unrotate(towards)));
    for (std::size_t first = 0; first < own_.faces.size(); first += kScanBits) {
      std::uint64_t left = faces_behind(own_, first, centre, witness_, best.separation);
      for (; left != 0; left &= left - 1) {
        const std::size_t f = first + static_cast<std::size_t>(std::countr_zero(left));
        // Again: a face tried since may have changed the closest point.
        if (is_behind(own_.faces[f], centre, witness_, best.separation))
          try_face(static_cast<int>(f));
      }
    }
  }

  FaceAxis best;

 private:
  Vec3 in_b(const Vec3& p) const { return inverse_times(v_.pair.T_a_b, p); }
  void try_face(int f) {
    const ConvexHull::Face& face = own_.faces[static_cast<std::size_t>(f)];
    const SE3& T = v_.pair.T_a_b;
    const Vec3 n = of_a_ ? face.normal : T.rotate(face.normal);
    const double offset = of_a_ ? face.offset : face.offset + dot(n, T.position());
    const Vec3 nearest = of_a_ ? v_.pair.support_b(-n) : v_.pair.support_a(-n);
    const double separation = dot(n, nearest) - offset;
    if (found_ && !(separation > best.separation)) return;
    found_ = true;
    witness_ = of_a_ ? nearest : in_b(nearest);
    best = {separation, of_a_ ? n : -n, of_a_, f};
  }

  const View& v_;
  bool of_a_, found_ = false;
  const Polytope& own_;
  Vec3 witness_;  // in the frame of own_
};

FaceAxis best_face(const View& v, double bias, const PairCache& cache) {
  const Vec3 last{cache.normal[0], cache.normal[1], cache.normal[2]};
  const Vec3 between = v.pair.T_a_b * core_centre(v.pair.b) - core_centre(v.pair.a);
  const FaceSearch of_a(v, true, dot(last, last) > 0.0 ? last : between);
  const FaceSearch of_b(v, false, -of_a.best.normal);
  return of_b.best.separation > of_a.best.separation + bias ? of_b.best : of_a.best;
}

struct EdgeList {
  int count = 0;
  std::uint16_t edges[kMaxEdgesOf];
};

// Edges with a point within depth of the foremost corner along n.
void find_near_edges(const Polytope& p, const Vec3& n, double depth, EdgeList& list) {
  double height[kMaxCornersOf];
  double foremost = -1e300;
  for (std::size_t i = 0; i < p.vertices.size(); ++i) {
    height[i] = dot(n, p.vertices[i]);
    foremost = std::max(foremost, height[i]);
  }
  for (std::size_t e = 0; e < p.edges.size(); ++e) {
    if (std::max(height[p.edges[e].v0], height[p.edges[e].v1]) < foremost - depth) continue;
    list.edges[list.count++] = static_cast<std::uint16_t>(e);
  }
}

struct EdgeLine {
  Vec3 p, d, left, right;  // the edge is from p to p + d; left, right: the normals of its faces
};
EdgeLine line_of(const Polytope& p, int edge, const SE3* T) {
  const HullEdge& e = p.edges[static_cast<std::size_t>(edge)];
  const Vec3 &from = p.vertices[e.v0], &to = p.vertices[e.v1];
  const EdgeLine line{from, to - from, p.faces[e.left].normal, p.faces[e.right].normal};
  if (!T) return line;
  return {*T * line.p, T->rotate(line.d), T->rotate(line.left), T->rotate(line.right)};
}

// Whether the arc from left to right of a crosses that from -left to -right of b.
bool arcs_cross(const EdgeLine& a, const EdgeLine& b) {
  const double bl = dot(b.left, a.d), br = dot(b.right, a.d);
  if (!(bl * br < 0.0)) return false;
  const double al = dot(a.left, b.d), ar = dot(a.right, b.d);
  return al * ar < 0.0 && bl * ar < 0.0;
}

// The closest points of the two lines, clamped to the edges.
void set_nearest_points(const EdgeLine& a, const EdgeLine& b, BestAxis& axis) {
  const double aa = dot(a.d, a.d), bb = dot(b.d, b.d), ab = dot(a.d, b.d);
  const Vec3 r = a.p - b.p;
  const double ra = dot(a.d, r), rb = dot(b.d, r);
  const double s = std::clamp((ab * rb - bb * ra) / (aa * bb - ab * ab), 0.0, 1.0);
  axis.on_a = a.p + s * a.d;
  axis.on_b = b.p + std::clamp((ab * s + rb) / bb, 0.0, 1.0) * b.d;
}

// The directions of edges, padded with zero to a multiple of kScanLanes.
struct EdgeDirections {
  EdgeDirections(const Polytope& p, const EdgeList& list) {
    for (int i = 0; i < list.count; ++i) {
      const HullEdge& e = p.edges[list.edges[i]];
      put(static_cast<std::size_t>(i), p.vertices[e.v1] - p.vertices[e.v0]);
    }
    count = static_cast<std::size_t>(list.count);
    for (; count % kScanLanes != 0; ++count) put(count, {});
  }
  // Of the kScanBits edges from index `first` on: a bit for each whose plane on the Gauss map the
  // arc of b crosses.
  std::uint64_t across(std::size_t first, const EdgeLine& b) const {
    return vectors_between(x + first, y + first, z + first, std::min(kScanBits, count - first),
                           b.left, b.right);
  }
  std::size_t count;

 private:
  void put(std::size_t i, const Vec3& d) {
    x[i] = d.x;
    y[i] = d.y;
    z[i] = d.z;
  }
  double x[kMaxEdgesOf], y[kMaxEdgesOf], z[kMaxEdgesOf];
};

void find_edge_axis(const View& v, const FaceAxis& face, EdgeAxis& best) {
  const double depth = 2.0 * std::fabs(face.separation) + 1e-9 * v.pair.extent;
  EdgeList near_a, near_b;
  find_near_edges(v.a, face.normal, depth, near_a);
  find_near_edges(v.b, -v.pair.T_a_b.unrotate(face.normal), depth, near_b);
  const EdgeDirections directions(v.a, near_a);
  double largest = face.separation;
  const auto try_edges = [&](int i, int k, const EdgeLine& b) {
    const EdgeLine a = line_of(v.a, i, nullptr);
    if (!arcs_cross(a, b)) return;
    const Vec3 c = cross(a.d, b.d);
    const double c2 = dot(c, c);
    if (!(c2 > kParallelEdges * dot(a.d, a.d) * dot(b.d, b.d))) return;
    const double sign = dot(c, a.left + a.right) < 0.0 ? -1.0 : 1.0;
    const Vec3 n = (sign / std::sqrt(c2)) * c;
    if (!(dot(n, b.p - a.p) > largest)) return;
    const double separation =
        separation_along(v.pair, n);  // computed again, in case the arcs cross by rounding only
    if (!(separation > largest)) return;
    largest = separation;
    best = {true, i, k, {separation, n, {}, {}}};
    set_nearest_points(a, b, best.axis);
  };
  for (int k = 0; k < near_b.count; ++k) {
    const EdgeLine b = line_of(v.b, near_b.edges[k], &v.pair.T_a_b);
    for (std::size_t first = 0; first < directions.count; first += kScanBits) {
      std::uint64_t left = directions.across(first, b);
      for (; left != 0; left &= left - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(left));
        try_edges(near_a.edges[i], near_b.edges[k], b);
      }
    }
  }
}

}  // namespace

void find_overlap_axes(const CorePair& pair, double bias, const PairCache& cache, FaceAxis& face,
                       EdgeAxis& edge) {
  const PolytopeOf a(pair.a), b(pair.b);
  const View view{pair, a.view(), b.view()};
  face = best_face(view, bias, cache);
  find_edge_axis(view, face, edge);
}

}  // namespace vp::collide
