// Queries between a shape and any other one, including all parts: overlap, closest points, time of
// impact.
//
// The first shape is convex or a compound; the second is any. Surfaces have no interior here, only
// their triangles. No result depends on the order in which parts are found.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/bounding_tree.h"
#include "collide/distance.h"
#include "collide/time_of_impact.h"

namespace vp::collide {

// Scratch memory, owned by the caller. It holds no data between calls.
struct PartsScratch {
  CastScratch cast;
  std::vector<std::uint32_t> triangles;
};

bool parts_touch(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                 PartsScratch& scratch);

// Part numbers in compounds and triangle numbers in surfaces; 0 for other shapes.
struct NearestParts {
  ClosestPoints points;
  std::uint32_t part_a = 0, part_b = 0;
};
// Finds the closest two parts or, if some overlap, the deepest; of equals those with the lowest
// numbers. Returns false if none are within limit [m].
bool nearest_parts(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   double limit, PartsScratch& scratch, NearestParts& found);

struct PartsImpact {
  double time;
  ClosestPoints points;  // at that time
  std::uint32_t part_a = 0, part_b = 0;
};
// Finds the first time at which the separation of two parts has decreased to target [m], 0 if it is
// at most target from the start; of equals those with the lowest numbers. A one-sided triangle is
// hit only if the other part's centre is then in front of it. Returns false if there is none within
// the duration.
//
// If the shape already touches a surface, target must be below the separation of all parts
// together: otherwise the shape hits the next triangle as it slides. Parts within target at time 0
// are ignored with NearParts::passed: the caller may know better whether they are contacts.
enum class NearParts { met, passed };
bool first_impact(const ImpactQuery& query, double target, PartsScratch& scratch,
                  PartsImpact& found, NearParts near_at_start = NearParts::met);

}  // namespace vp::collide
