// Box against box: the separating axis theorem over six face normals and nine cross products of
// edges, the cached separating axis first.
//
// In a's frame b's axes are the columns of R, its centre is t. On the cross product of edge i of a
// and edge j of b, whose length is sqrt(1 - R_ij^2), all projections are sums of two products.
//
// Source: Gottschalk, Lin, Manocha, OBBTree, 1996, section 5.
#include <cmath>

#include "collide/convex_contact.h"
#include "collide/polytope.h"

namespace vp::collide {
namespace {

// The squared sine below which two edges are parallel and give no axis.
constexpr double kParallel = 1e-12;

struct Boxes {
  Vec3 ha, hb, t;
  double r[3][3], q[3][3];  // R and its magnitudes

  explicit Boxes(const CorePair& pair)
      : ha(pair.a.half), hb(pair.b.half), t(pair.T_a_b.position()) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        r[i][j] = pair.T_a_b.rotation()(i, j);
        q[i][j] = std::fabs(r[i][j]);
      }
    }
  }

  double towards_b(int j) const { return t.x * r[0][j] + t.y * r[1][j] + t.z * r[2][j]; }
  double separation_of_a(int i) const {
    return std::fabs(t[i]) - (ha[i] + q[i][0] * hb.x + q[i][1] * hb.y + q[i][2] * hb.z);
  }
  double separation_of_b(int j) const {
    return std::fabs(towards_b(j)) - (hb[j] + q[0][j] * ha.x + q[1][j] * ha.y + q[2][j] * ha.z);
  }
  double squared_sine(int i, int j) const { return 1.0 - r[i][j] * r[i][j]; }
  // The separation times the sine of the angle between the edges.
  double edge_separation(int i, int j) const {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    const double along = t[i2] * r[i1][j] - t[i1] * r[i2][j];
    return std::fabs(along) -
           (ha[i1] * q[i2][j] + ha[i2] * q[i1][j] + hb[j1] * q[i][j2] + hb[j2] * q[i][j1]);
  }
};

Vec3 axis_of(const Mat3& R, int i) {
  return i == 0 ? R.cx : i == 1 ? R.cy : R.cz;
}
int axis_from_face(int face) {
  return kBoxFaceAxis[static_cast<std::size_t>(face)];
}

Vec3 face_normal(const CorePair& pair, const Boxes& boxes, bool of_a, int axis) {
  if (of_a) {
    Vec3 n;
    n[axis] = boxes.t[axis] < 0.0 ? -1.0 : 1.0;
    return n;
  }
  const Vec3 n = axis_of(pair.T_a_b.rotation(), axis);
  return boxes.towards_b(axis) < 0.0 ? -n : n;
}

Vec3 edge_normal(const CorePair& pair, const Boxes& boxes, int i, int j) {
  Vec3 edge;
  edge[i] = 1.0;
  const Vec3 n = cross(edge, axis_of(pair.T_a_b.rotation(), j));
  return ((dot(n, boxes.t) < 0.0 ? -1.0 : 1.0) / norm(n)) * n;
}

// Whether they may touch by the cached separating axis. If not, the manifold has that axis.
bool may_touch_by_last(const ContactQuery& query, const PairMargin& margin, const Boxes& boxes,
                       const PairCache& cache, Manifold& m) {
  const auto are_apart = [&](double separation, const auto& normal) {
    if (separation <= margin.slack()) return false;
    const Vec3 n = normal();
    if (may_touch(query, margin, separation, n)) return false;
    m.normal = n;
    m.min_separation = separation;
    return true;
  };
  const CorePair& pair = query.pair;
  switch (cache.feature) {
    case PairCache::face_of_a: {
      if (cache.i >= 6) return true;
      const int i = axis_from_face(cache.i);
      return !are_apart(boxes.separation_of_a(i),
                        [&] { return face_normal(pair, boxes, true, i); });
    }
    case PairCache::face_of_b: {
      if (cache.i >= 6) return true;
      const int j = axis_from_face(cache.i);
      return !are_apart(boxes.separation_of_b(j),
                        [&] { return face_normal(pair, boxes, false, j); });
    }
    case PairCache::edges: {
      const int i = cache.i, j = cache.j;
      const double sine2 = i < 3 && j < 3 ? boxes.squared_sine(i, j) : 0.0;
      return !(sine2 > kParallel) || !are_apart(boxes.edge_separation(i, j) / std::sqrt(sine2),
                                                [&] { return edge_normal(pair, boxes, i, j); });
    }
    default: {
      const Vec3 n = first_direction(pair, cache);
      return !are_apart(separation_along(pair, n), [&] { return n; });
    }
  }
}

// The face whose outward normal points towards the other box.
int facing(const Boxes& boxes, bool of_a, int axis) {
  const bool positive = of_a ? !(boxes.t[axis] < 0.0) : boxes.towards_b(axis) < 0.0;
  return kBoxFace[axis][positive ? 1 : 0];
}

// Returns false as soon as a face has a separation of more than margin; that face is then `best`.
bool find_best_face(const ContactQuery& query, const Boxes& boxes, FaceAxis& best) {
  best = {boxes.separation_of_a(0), {}, true, 0};
  const auto consider = [&](bool of_a, int axis, double separation, double needed) {
    if (separation > needed) best = {separation, {}, of_a, axis};
    return separation <= query.margin;
  };
  if (best.separation > query.margin) return false;
  for (int i = 1; i < 3; ++i) {
    if (!consider(true, i, boxes.separation_of_a(i), best.separation)) return false;
  }
  double needed = best.separation + query.face_bias();
  for (int j = 0; j < 3; ++j) {
    if (!consider(false, j, boxes.separation_of_b(j), needed)) return false;
    needed = std::max(needed, best.of_a ? needed : best.separation);
  }
  return true;
}

// Finds the best pair of edges, if better than the face; stops as soon as a pair is separated by
// more than margin.
void find_better_edges(const Boxes& boxes, double margin, const FaceAxis& face, EdgeAxis& edge) {
  edge.axis.separation = face.separation;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      // A negative separation is at most its value along the unnormalized cross product.
      const double part = boxes.edge_separation(i, j);
      if (part <= edge.axis.separation) continue;
      const double sine2 = boxes.squared_sine(i, j);
      if (sine2 < kParallel) continue;
      const double separation = part / std::sqrt(sine2);
      if (separation <= edge.axis.separation) continue;
      edge.better = true;
      edge.axis.separation = separation;
      edge.i = i;
      edge.j = j;
      if (separation > margin) return;
    }
  }
}

// Finds the closest points of the edges along axis i of a and j of b that face each other. Returns
// false if they are beyond the edges' ends.
bool place_edges(const CorePair& pair, const Boxes& boxes, EdgeAxis& edge) {
  const SE3& T = pair.T_a_b;
  Vec3 da;
  da[edge.i] = 1.0;
  const Vec3 db = axis_of(T.rotation(), edge.j);
  const Vec3 n = edge_normal(pair, boxes, edge.i, edge.j);
  const Vec3 nb = T.unrotate(n);
  Vec3 pa, pb;  // the centres of the edges
  for (int k = 0; k < 3; ++k) {
    if (k != edge.i) pa[k] = std::copysign(boxes.ha[k], n[k]);
    if (k != edge.j) pb[k] = std::copysign(boxes.hb[k], -nb[k]);
  }
  pb = T * pb;
  const double k = dot(da, db);
  const Vec3 r = pa - pb;
  const double s = (k * dot(db, r) - dot(da, r)) / (1.0 - k * k);
  const double u = dot(db, r) + k * s;
  edge.axis.normal = n;
  edge.axis.on_a = pa + s * da;
  edge.axis.on_b = pb + u * db;
  return std::fabs(s) <= boxes.ha[edge.i] && std::fabs(u) <= boxes.hb[edge.j];
}

}  // namespace

void collide_boxes(const CorePair& pair, const PairMargin& margin, PairCache& cache, Manifold& m) {
  const Boxes boxes(pair);
  const ContactQuery query(pair, margin.largest());
  if (!may_touch_by_last(query, margin, boxes, cache, m)) return;
  FaceAxis face;
  const bool is_within_margin = find_best_face(query, boxes, face);
  face.normal = face_normal(pair, boxes, face.of_a, face.face);
  face.face = facing(boxes, face.of_a, face.face);
  EdgeAxis edge;
  if (face.separation <= 0.0) find_better_edges(boxes, query.margin, face, edge);
  const bool by_edges = edge.better && !query.face_suffices(face.separation, edge.axis.separation);
  if (!by_edges) {
    remember(cache, face.normal, face.of_a ? PairCache::face_of_a : PairCache::face_of_b,
             face.face);
    m.normal = face.normal;
    m.min_separation = face.separation;
    if (!is_within_margin || !may_touch(query, margin, face.separation, face.normal)) return;
    Feature feature;
    face_feature(face.of_a ? pair.a : pair.b, face.of_a ? SE3{} : pair.T_a_b, face.face, feature);
    // A point of the patch proves the separation.
    const double best = edge.better ? edge.axis.separation : face.separation;
    if (add_face_contact(query, face.of_a, feature, face.normal, best, m)) return;
  }
  if (edge.better) {
    const bool within = place_edges(pair, boxes, edge);
    if (edge.axis.separation > query.margin || edge.axis.separation <= 0.0 || within) {
      remember(cache, edge.axis.normal, PairCache::edges, edge.i, edge.j);
      m.normal = edge.axis.normal;
      m.min_separation = edge.axis.separation;
      if (!may_touch(query, margin, edge.axis.separation, edge.axis.normal)) return;
      return add_contact_along(query, edge.axis, m);
    }
  }
  // Separated, but neither along a face normal nor between two edges.
  const GjkResult found = gjk(pair, face.normal, query.margin);
  if (found.state != GjkResult::State::overlaps)
    return collide_separated(query, margin, found, cache, m);
  add_contact_along(query, axis_of_face(pair, face), m);  // separated by rounding error only
}

}  // namespace vp::collide
