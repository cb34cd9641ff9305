#include "collide/hull_faces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

namespace vp::collide {
namespace {

// Faces at a larger angle (cosine) are never merged, however small they are.
constexpr double kSameSide = 0.95;

struct Piece {
  Loop loop;
  Loop members;  // all corners of the merged triangles: all must stay near its plane
  Vec3 normal;
  double width;  // twice the area over the longest edge
  bool alive = true;
};

Piece make_piece(std::span<const Vec3> points, Loop loop, Loop members) {
  Piece piece{std::move(loop), std::move(members), {}, 0.0};
  const Vec3 area = area_vector(points, piece.loop);
  double longest = 0.0;
  for (std::size_t i = 0; i < piece.loop.size(); ++i) {
    const Vec3 edge = points[piece.loop[(i + 1) % piece.loop.size()]] - points[piece.loop[i]];
    longest = std::max(longest, norm(edge));
  }
  piece.normal = unit(area);
  piece.width = longest > 0.0 ? norm(area) / longest : 0.0;
  return piece;
}

// The extent of the members along n.
double spread(std::span<const Vec3> points, const Loop& members, const Vec3& n) {
  double low = dot(n, points[members[0]]), high = low;
  for (const std::uint32_t i : members) {
    const double h = dot(n, points[i]);
    low = std::min(low, h);
    high = std::max(high, h);
  }
  return high - low;
}

// Merges a and b; empty if their common border is not one chain of edges.
std::optional<Loop> joined(const Loop& a, const Loop& b) {
  const std::size_t n = a.size(), m = b.size();
  const auto shared = [&](std::size_t i) {  // is a's edge from corner i an edge of b?
    for (std::size_t k = 0; k < m; ++k) {
      if (b[k] == a[(i + 1) % n] && b[(k + 1) % m] == a[i]) return true;
    }
    return false;
  };
  std::size_t first = n, count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!shared(i)) continue;
    ++count;
    if (!shared((i + n - 1) % n)) {
      if (first != n) return std::nullopt;  // a second chain
      first = i;
    }
  }
  if (first == n || count >= n || count >= m) return std::nullopt;
  Loop loop;
  for (std::size_t i = 0; i + count < n; ++i) loop.push_back(a[(first + count + i) % n]);
  const auto at = static_cast<std::size_t>(std::find(b.begin(), b.end(), a[first]) - b.begin());
  for (std::size_t i = 0; i + count < m; ++i) loop.push_back(b[(at + i) % m]);
  return loop;
}

// Whether the corner at i turns left, or is within tolerance of the line between its neighbours.
bool turns_left(std::span<const Vec3> points, const Loop& loop, std::size_t i, const Vec3& n,
                double tolerance) {
  const std::size_t count = loop.size();
  const Vec3 &before = points[loop[(i + count - 1) % count]], &here = points[loop[i]],
             &after = points[loop[(i + 1) % count]];
  const Vec3 chord = after - before;
  return dot(cross(here - before, chord), n) >= -tolerance * norm(chord);
}

class Merger {
 public:
  Merger(std::span<const Vec3> points, std::span<const Triangle> triangles, double tolerance)
      : points_(points), tolerance_(tolerance) {
    for (const Triangle& t : triangles) {
      pieces_.push_back(make_piece(points, {t.begin(), t.end()}, {t.begin(), t.end()}));
    }
  }

  bool merge_flattest();
  void drop_corners_on_edges();
  bool closed() const;
  std::vector<Loop> loops() const;

 private:
  using Border = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Border, std::size_t> borders() const;
  std::optional<std::pair<double, Piece>> attempt(const Piece& a, const Piece& b) const;
  std::vector<std::size_t> faces_around() const;

  std::span<const Vec3> points_;
  double tolerance_;
  std::vector<Piece> pieces_;
};

std::map<Merger::Border, std::size_t> Merger::borders() const {
  std::map<Border, std::size_t> found;
  for (std::size_t f = 0; f < pieces_.size(); ++f) {
    if (!pieces_[f].alive) continue;
    const Loop& loop = pieces_[f].loop;
    for (std::size_t i = 0; i < loop.size(); ++i) found[{loop[i], loop[(i + 1) % loop.size()]}] = f;
  }
  return found;
}

// The merged piece and its deviation from a plane, if the two may be merged.
std::optional<std::pair<double, Piece>> Merger::attempt(const Piece& a, const Piece& b) const {
  // A sliver's normal is meaningless.
  const bool slivers = a.width <= tolerance_ || b.width <= tolerance_;
  if (!slivers && dot(a.normal, b.normal) < kSameSide) return std::nullopt;
  std::optional<Loop> loop = joined(a.loop, b.loop);
  if (!loop || loop->size() < 3) return std::nullopt;
  Loop members = a.members;
  members.insert(members.end(), b.members.begin(), b.members.end());
  Piece piece = make_piece(points_, std::move(*loop), std::move(members));
  for (const Piece* part : {&a, &b}) {
    const bool agrees = dot(part->normal, piece.normal) >= kSameSide;
    if (!agrees && part->width > tolerance_) return std::nullopt;
  }
  const double flat = spread(points_, piece.members, piece.normal);
  if (!(flat <= tolerance_)) return std::nullopt;
  for (std::size_t i = 0; i < piece.loop.size(); ++i) {
    if (!turns_left(points_, piece.loop, i, piece.normal, tolerance_)) return std::nullopt;
  }
  return std::pair{flat, std::move(piece)};
}

bool Merger::merge_flattest() {
  const std::map<Border, std::size_t> found = borders();
  std::optional<std::pair<double, Piece>> best;
  std::pair<std::size_t, std::size_t> which;
  for (const auto& [border, f] : found) {
    const auto other = found.find({border.second, border.first});
    if (other == found.end() || other->second <= f) continue;
    auto candidate = attempt(pieces_[f], pieces_[other->second]);
    if (candidate && (!best || candidate->first < best->first)) {
      best = std::move(candidate);
      which = {f, other->second};
    }
  }
  if (!best) return false;
  pieces_[which.first] = std::move(best->second);
  pieces_[which.second].alive = false;
  return true;
}

std::vector<std::size_t> Merger::faces_around() const {
  std::vector<std::size_t> around(points_.size(), 0);
  for (const Piece& piece : pieces_) {
    if (!piece.alive) continue;
    for (const std::uint32_t i : piece.loop) ++around[i];
  }
  return around;
}

// A corner with only two faces is on the straight edge between them.
void Merger::drop_corners_on_edges() {
  const std::vector<std::size_t> around = faces_around();
  for (Piece& piece : pieces_) std::erase_if(piece.loop, [&](auto i) { return around[i] < 3; });
}

bool Merger::closed() const {
  const std::map<Border, std::size_t> found = borders();
  std::size_t faces = 0, corners = 0;
  for (const Piece& piece : pieces_) {
    if (!piece.alive) continue;
    if (piece.loop.size() < 3) return false;
    ++faces;
    corners += piece.loop.size();
  }
  const auto has_twin = [&](const auto& entry) {
    return found.contains({entry.first.second, entry.first.first});
  };
  if (found.size() != corners || !std::all_of(found.begin(), found.end(), has_twin)) return false;
  std::size_t vertices = 0;
  for (const std::size_t n : faces_around()) {
    if (n == 1 || n == 2) return false;
    vertices += n > 0 ? 1 : 0;
  }
  return vertices + faces == corners / 2 + 2;
}

std::vector<Loop> Merger::loops() const {
  std::vector<Loop> found;
  for (const Piece& piece : pieces_) {
    if (piece.alive) found.push_back(piece.loop);
  }
  return found;
}

}  // namespace

Vec3 area_vector(std::span<const Vec3> points, std::span<const std::uint32_t> loop) {
  Vec3 sum;
  for (std::size_t i = 2; i < loop.size(); ++i) {
    sum += cross(points[loop[i - 1]] - points[loop[0]], points[loop[i]] - points[loop[0]]);
  }
  return sum;
}

Vec3 unit(const Vec3& a) {
  const double n = norm(a);
  return n > 0.0 ? (1.0 / n) * a : Vec3{0, 0, 1};
}

std::vector<std::uint32_t> flat_corners(std::span<const Vec3> points,
                                        std::span<const Triangle> triangles, double tolerance) {
  std::vector<std::vector<Triangle>> fans(points.size());  // each triangle starts with its hub
  for (const Triangle& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i)
      fans[t[i]].push_back({t[i], t[(i + 1) % 3], t[(i + 2) % 3]});
  }
  std::vector<std::pair<double, std::uint32_t>> flat;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    Vec3 sum;
    Loop members{v};
    for (const Triangle& t : fans[v]) {
      sum += area_vector(points, t);
      members.push_back(t[1]);
    }
    if (fans[v].empty()) continue;
    const Vec3 n = unit(sum);
    const bool agree = std::all_of(fans[v].begin(), fans[v].end(), [&](const Triangle& t) {
      const Piece piece = make_piece(points, {t.begin(), t.end()}, {});
      return dot(piece.normal, n) >= kSameSide || piece.width <= tolerance;
    });
    const double height = spread(points, members, n);
    if (agree && height <= tolerance) flat.emplace_back(height, v);
  }
  std::sort(flat.begin(), flat.end());
  std::vector<std::uint32_t> chosen;
  std::vector<bool> taken(points.size(), false);
  for (const auto& [height, v] : flat) {
    if (taken[v]) continue;
    chosen.push_back(v);
    for (const Triangle& t : fans[v]) taken[t[1]] = true;
  }
  return chosen;
}

std::vector<Loop> faces_of(std::span<const Vec3> points, std::span<const Triangle> triangles,
                           double tolerance) {
  Merger merger(points, triangles, tolerance);
  while (merger.merge_flattest()) continue;
  merger.drop_corners_on_edges();
  if (merger.closed()) return merger.loops();
  // Removing corners would make slivers fold over: the triangles themselves are closed in any case.
  return Merger(points, triangles, tolerance).loops();
}

}  // namespace vp::collide
