// Two overlapping polytopes: the separating axis theorem over faces and pairs of edges.
//
// Only edges whose arcs on the Gauss map cross form a face of A - B; the others are skipped. If the
// best face has a depth of D, two edges with less depth have closest points less than D apart. So
// along the face's normal neither is more than 2 D behind the foremost vertex: for touching shapes,
// few edges remain.
//
// Source: Gregorius, The Separating Axis Test between Convex Polyhedra, GDC 2013; the bound is
// derived here.
#include <cmath>

#include "collide/convex_contact.h"
#include "collide/polytope.h"

namespace vp::collide {
namespace {

constexpr int kMaxCornersOf = 256;
constexpr int kMaxEdgesOf = 3 * kMaxCornersOf;
// The squared sine below which edges are parallel and give no axis.
constexpr double kParallelEdges = 1e-16;

struct View {
  const CorePair& pair;
  const Polytope& a;
  const Polytope& b;
};

class FaceSearch {
 public:
  explicit FaceSearch(const View& view) : v_(view) {
    centre_a_ = witness_a_ = core_centre(v_.pair.a);
    centre_b_ = witness_b_ = v_.pair.T_a_b * core_centre(v_.pair.b);
  }

  // Along the normal every point of the other is at least as far as its closest one. Its centre
  // rules out the faces on the far side; the closest point of the best face so far, which is where
  // the shapes meet, nearly all others.
  void try_face(bool of_a, int f) {
    const ConvexHull::Face& face = (of_a ? v_.a : v_.b).faces[static_cast<std::size_t>(f)];
    const SE3& T = v_.pair.T_a_b;
    const Vec3 n = of_a ? face.normal : T.rotate(face.normal);
    const double offset = of_a ? face.offset : face.offset + dot(n, T.position());
    FaceAxis& best = of_a ? best_a : best_b;
    bool& found = of_a ? found_a : found_b;
    Vec3& witness = of_a ? witness_b_ : witness_a_;
    if (found && (dot(n, of_a ? centre_b_ : centre_a_) - offset <= best.separation ||
                  dot(n, witness) - offset <= best.separation))
      return;
    const Vec3 nearest = of_a ? v_.pair.support_b(-n) : v_.pair.support_a(-n);
    const double separation = dot(n, nearest) - offset;
    if (found && !(separation > best.separation)) return;
    found = true;
    witness = nearest;
    best = {separation, of_a ? n : -n, of_a, f};
  }

  FaceAxis best_a, best_b;

 private:
  const View& v_;
  Vec3 centre_a_, centre_b_, witness_a_, witness_b_;
  bool found_a = false, found_b = false;
};

FaceAxis best_face(const View& v, double bias, const PairCache& cache) {
  FaceSearch search(v);
  const int faces_a = static_cast<int>(v.a.faces.size()),
            faces_b = static_cast<int>(v.b.faces.size());
  if (cache.feature == PairCache::face_of_a && cache.i < faces_a) search.try_face(true, cache.i);
  if (cache.feature == PairCache::face_of_b && cache.i < faces_b) search.try_face(false, cache.i);
  for (int f = 0; f < faces_a; ++f) search.try_face(true, f);
  for (int f = 0; f < faces_b; ++f) search.try_face(false, f);
  return search.best_b.separation > search.best_a.separation + bias ? search.best_b : search.best_a;
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

void find_edge_axis(const View& v, const FaceAxis& face, EdgeAxis& best) {
  const double depth = 2.0 * std::fabs(face.separation) + 1e-9 * v.pair.extent;
  EdgeList near_a, near_b;
  find_near_edges(v.a, face.normal, depth, near_a);
  find_near_edges(v.b, -v.pair.T_a_b.unrotate(face.normal), depth, near_b);
  double largest = face.separation;
  for (int k = 0; k < near_b.count; ++k) {
    const EdgeLine b = line_of(v.b, near_b.edges[k], &v.pair.T_a_b);
    for (int i = 0; i < near_a.count; ++i) {
      const EdgeLine a = line_of(v.a, near_a.edges[i], nullptr);
      if (!arcs_cross(a, b)) continue;
      const Vec3 c = cross(a.d, b.d);
      const double c2 = dot(c, c);
      if (!(c2 > kParallelEdges * dot(a.d, a.d) * dot(b.d, b.d))) continue;
      const double sign = dot(c, a.left + a.right) < 0.0 ? -1.0 : 1.0;
      const Vec3 n = (sign / std::sqrt(c2)) * c;
      if (!(dot(n, b.p - a.p) > largest)) continue;
      const double separation =
          separation_along(v.pair, n);  // computed again, in case the arcs cross by rounding only
      if (!(separation > largest)) continue;
      largest = separation;
      best = {true, near_a.edges[i], near_b.edges[k], {separation, n, {}, {}}};
      set_nearest_points(a, b, best.axis);
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
