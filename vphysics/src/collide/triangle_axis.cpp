// All exit directions across an edge are perpendicular to it. In that plane the edge is a point and
// the shape a convex figure. The separation along a direction d is d . s minus the point's
// projection, with s the shape's support point against d. Between two directions with support
// points s1 and s2 it is at most the smaller of d . s1 and d . s2, hence at most the value along
// the d perpendicular to s1 - s2. The arc is divided there until that bound is reached or not worth
// a division.
#include "collide/triangle_axis.h"

#include <cmath>

namespace vp::collide {
namespace {

// Convergence: the maximum difference of the bounds [fraction of the pair's extent].
constexpr double kClosed = 1e-9;
constexpr int kMaxCuts = 64;

// In the plane perpendicular to an edge: outward from the triangle, and up along its normal.
struct Flat {
  double out, up;
};
double dot(const Flat& a, const Flat& b) {
  return a.out * b.out + a.up * b.up;
}

class ArcSearch {
 public:
  // at: a point of the edge; outward, up: unit vectors.
  ArcSearch(const CorePair& pair, const Vec3& at, const Vec3& outward, const Vec3& up)
      : pair_(pair), at_(at), outward_(outward), up_(up), closed_(kClosed * pair.extent) {}

  // Searches the directions from one to the other, less than 180 degrees apart.
  void search(const Flat& from, const Flat& to);

  double best_separation = -1e300;
  Flat best{0.0, 1.0};

 private:
  struct Arc {
    Flat from, to, s_from, s_to;
  };
  Flat support(const Flat& d) {
    const Vec3 s = pair_.support_b(-(d.out * outward_ + d.up * up_)) - at_;
    const Flat flat{vp::dot(outward_, s), vp::dot(up_, s)};
    const double separation = dot(d, flat);
    if (separation > best_separation) {
      best_separation = separation;
      best = d;
    }
    return flat;
  }

  const CorePair& pair_;
  Vec3 at_, outward_, up_;
  double closed_;
};

void ArcSearch::search(const Flat& from, const Flat& to) {
  Arc waiting[kMaxCuts];
  int count = 0;
  waiting[count++] = {from, to, support(from), support(to)};
  for (int cut = 0; cut < kMaxCuts && count > 0; ++cut) {
    const Arc arc = waiting[--count];
    const Flat chord{arc.s_to.out - arc.s_from.out, arc.s_to.up - arc.s_from.up};
    const double length = std::sqrt(dot(chord, chord));
    if (length <= closed_) continue;
    // Perpendicular to the chord, on the side of the arc.
    Flat d{chord.up / length, -chord.out / length};
    if (dot(d, arc.from) + dot(d, arc.to) < 0.0) d = {-d.out, -d.up};
    const auto cross_2d = [](const Flat& a, const Flat& b) { return a.out * b.up - a.up * b.out; };
    const double offset = cross_2d(arc.from, arc.to);
    if (cross_2d(arc.from, d) * offset <= 0.0 || cross_2d(d, arc.to) * offset <= 0.0) continue;
    const double bound = dot(d, arc.s_from);
    if (bound <= best_separation + closed_) continue;
    const Flat s = support(d);
    if (bound - dot(d, s) <= closed_ || count + 2 > kMaxCuts) continue;
    waiting[count++] = {arc.from, d, arc.s_from, s};
    waiting[count++] = {d, arc.to, s, arc.s_to};
  }
  pair_.rough |= count > 0;
}

void try_edge(const SurfaceTriangle& t, const Vec3 p[3], const CorePair& pair, int e,
              TriangleAxis& best) {
  const Vec3 along = p[(e + 1) % 3] - p[e];
  const Vec3 c = cross(along, t.normal), outward = (1.0 / norm(c)) * c;
  Flat last{1.0, 0.0};  // of a border
  if (t.has_opposite[e]) {
    const Vec3 offset = t.opposite[e] - t.p[e];
    const double out = vp::dot(outward, offset), up = vp::dot(t.normal, offset);
    const double length = std::sqrt(out * out + up * up);
    last = {-up / length, out / length};
  }
  ArcSearch arc(pair, p[e], outward, t.normal);
  arc.search({0.0, 1.0}, last);
  if (!(arc.best_separation > best.separation)) return;
  best = {arc.best_separation,
          arc.best.out * outward + arc.best.up * t.normal,
          {TrianglePart::edge, e}};
}

// The exit of a corner inside the shape is towards the closest point of the shape's surface.
void try_corner(const Surface& surface, const SurfaceTriangle& t, const Vec3 p[3],
                const CorePair& pair, int i, TriangleAxis& best) {
  if (!is_active_edge(t, i) && !is_active_edge(t, (i + 2) % 3)) return;
  const SignedDistance inside = signed_distance(pair.b, inverse_times(pair.T_a_b, p[i]));
  if (!(inside.distance < 0.0)) return;
  const Vec3 d = -pair.T_a_b.rotate(inside.normal);
  const double separation = separation_along(pair, d);
  if (!(separation > best.separation)) return;
  const TrianglePart part = foremost_part(p, d);
  if (may_touch_along(surface, t, part, d)) best = {separation, d, part};
}

}  // namespace

TriangleAxis best_exit_axis(const Surface& surface, const SurfaceTriangle& t, const Vec3 p[3],
                            const CorePair& pair) {
  TriangleAxis best{separation_along(pair, t.normal), t.normal, {}};
  for (int e = 0; e < 3; ++e) {
    if (is_active_edge(t, e)) try_edge(t, p, pair, e, best);
  }
  for (int i = 0; i < 3; ++i) try_corner(surface, t, p, pair, i, best);
  return best;
}

}  // namespace vp::collide
