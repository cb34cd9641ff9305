#include "collide/manifolds.h"

#include <algorithm>
#include <span>

#include "collide/compound_data.h"
#include "collide/gjk.h"
#include "collide/height_data.h"
#include "collide/mesh_data.h"
#include "collide/mixed_name.h"
#include "collide/support.h"
#include "collide/surface_manifolds.h"

namespace vp::collide {
namespace {

void to_world(const SE3& T, Manifold& m) {
  m.normal = T.rotate(m.normal);
  for (int k = 0; k < m.count; ++k) m.points[k].position = T * m.points[k].position;
}

class Finder {
 public:
  Finder(const SearchMargin& margin, std::span<const KnownPart> known, ManifoldScratch& scratch,
         std::vector<SubManifold>& out)
      : search_(margin), bounds_(margin.all()), known_(known), scratch_(scratch), out_(out) {}

  // Restricts the search to where a convex shape of the pair is.
  void restrict_to(const Geometry& shape, const SE3& T, bool is_b) {
    if (!is_convex_body(shape)) return;
    const ApproachBounds there = search_.approach_of(shape, T, is_b);
    if (there.largest <= bounds_.largest) bounds_ = there;
  }

  // Precondition: neither a nor b is a compound.
  void find(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
            PairCache& cache) {
    if (is_surface(a) || is_surface(b)) {
      if (is_convex_body(a)) find_on_surface(b, T_b, a, T_a, true);
      if (is_convex_body(b)) find_on_surface(a, T_a, b, T_b, false);
      return;
    }
    SubManifold found;
    found.sub_a = sub_a_;
    found.sub_b = sub_b_;
    find_manifold(a, T_a, b, T_b, search_.of_convex(bounds_.largest, {a, T_a}, {b, T_b}), cache,
                  found.manifold);
    found.cache = cache;
    if (found.manifold.count == 0) return;
    if (search_.motion() != nullptr)
      found.to_impact =
          move_to_impact(a, T_a, b, T_b, *search_.motion(), bounds_.largest, found.manifold);
    out_.push_back(found);
  }

  // of: the compound whose parts are tested against the other shape.
  void find_of_parts(const Geometry& of, const SE3& T_of, const Geometry& other, const SE3& T_other,
                     bool swapped) {
    const CompoundData& compound = *of.compound;
    const Bounds near = grown(bounds_of(other, relative_pose(T_of, T_other)), bounds_.largest);
    const std::size_t begin = scratch_.parts.size();
    compound.tree.overlapping(rounded_outward(near),
                              [&](std::uint32_t i) { scratch_.parts.push_back(i); });
    std::sort(scratch_.parts.begin() + static_cast<std::ptrdiff_t>(begin), scratch_.parts.end());
    const std::size_t end = scratch_.parts.size();
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t i = scratch_.parts[k];
      const std::size_t first = out_.size();
      const SE3 T = T_of * compound.parts[i].T_compound_part;
      const Geometry& part = compound.geometries[i];
      const ApproachBounds bounds_of_all = bounds_;
      restrict_to(part, T, swapped);
      (swapped ? sub_b_ : sub_a_) = i;
      PairCache cache = known_cache();
      if (other.kind == Kind::compound) {
        find_of_parts(other, T_other, part, T, !swapped);
      } else if (swapped) {
        find(other, T_other, part, T, cache);
      } else {
        find(part, T, other, T_other, cache);
      }
      bounds_ = bounds_of_all;
      for (std::size_t m = first; m < out_.size(); ++m) {
        (swapped ? out_[m].sub_b : out_[m].sub_a) = i;
        for (ManifoldPoint& p : std::span(out_[m].manifold.points)
                                    .first(static_cast<std::size_t>(out_[m].manifold.count))) {
          p.feature = mixed_name(i, 0, p.feature);
        }
      }
    }
    scratch_.parts.resize(begin);
  }

 private:
  PairCache known_cache() const {
    const auto at = std::find_if(known_.begin(), known_.end(), [this](const KnownPart& k) {
      return k.sub_a == sub_a_ && k.sub_b == sub_b_;
    });
    return at == known_.end() ? PairCache{} : at->cache;
  }
  void find_on_surface(const Geometry& surface, const SE3& T_surface, const Geometry& shape,
                       const SE3& T_shape, bool surface_is_b) {
    const std::size_t first = out_.size();
    collide_surface(surface_of(surface), shape, relative_pose(T_surface, T_shape),
                    search_.swept(bounds_, !surface_is_b, T_surface), scratch_, out_);
    for (std::size_t i = first; i < out_.size(); ++i) {
      to_world(T_surface, out_[i].manifold);
      if (!surface_is_b) continue;
      out_[i].manifold.normal = -out_[i].manifold.normal;
      std::swap(out_[i].sub_a, out_[i].sub_b);
    }
  }

  const SearchMargin& search_;
  ApproachBounds bounds_;  // of the current parts
  std::span<const KnownPart> known_;
  ManifoldScratch& scratch_;
  std::vector<SubManifold>& out_;
  std::uint32_t sub_a_ = 0, sub_b_ = 0;  // current parts of the compounds
};

}  // namespace

void find_manifolds(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                    const SearchMargin& margin, PairCache& cache, std::span<const KnownPart> known,
                    ManifoldScratch& scratch, std::vector<SubManifold>& manifolds) {
  Finder finder(margin, known, scratch, manifolds);
  finder.restrict_to(a, T_a, false);
  finder.restrict_to(b, T_b, true);
  if (a.kind == Kind::compound) {
    finder.find_of_parts(a, T_a, b, T_b, false);
  } else if (b.kind == Kind::compound) {
    finder.find_of_parts(b, T_b, a, T_a, true);
  } else {
    finder.find(a, T_a, b, T_b, cache);
  }
}

double distance_of_parts(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                         CastScratch& scratch) {
  const bool of_a = a.kind == Kind::compound || is_surface(a);
  const Geometry &parts = of_a ? a : b, &other = of_a ? b : a;
  if (other.kind == Kind::half_space) return 0.0;
  const Bounds box = bounds_of(other, of_a ? relative_pose(T_a, T_b) : relative_pose(T_b, T_a));
  double distance = 0.0;
  const auto first = [&](std::uint32_t, float near) {
    distance = static_cast<double>(near);
    return -1.0;
  };
  if (parts.kind == Kind::compound) {
    parts.compound->tree.nearest(box, {1.0, 1.0, 1.0}, kFar, scratch, first);
  } else if (parts.kind == Kind::mesh) {
    const Vec3& scale = parts.half;
    const auto unscaled = [&](const Vec3& p) {
      return Vec3{p.x / scale.x, p.y / scale.y, p.z / scale.z};
    };
    parts.mesh->tree.nearest({unscaled(box.lower), unscaled(box.upper)}, scale, kFar, scratch,
                             first);
  }
  return distance;
}

Kind kind_of_part(const Geometry& g, std::uint32_t sub) {
  if (is_surface(g)) return Kind::triangle;
  return g.kind == Kind::compound ? g.compound->geometries[sub].kind : g.kind;
}

std::uint32_t number_of_parts(const Geometry& g) {
  if (g.kind == Kind::mesh) return static_cast<std::uint32_t>(g.mesh->triangles.size());
  if (g.kind == Kind::height_field) return 2 * (g.field->columns - 1) * (g.field->rows - 1);
  return g.kind == Kind::compound ? static_cast<std::uint32_t>(g.compound->parts.size()) : 1;
}

}  // namespace vp::collide
