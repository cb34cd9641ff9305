// What is asked of a shape and any other one, with all its parts: do they touch, how near are they,
// when do they meet?
//
// The first shape is convex or a compound; the second is any. Surfaces have no inside here: they
// are where their triangles are. The order in which parts are found has no say in any answer.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/bounding_tree.h"
#include "collide/distance.h"
#include "collide/time_of_impact.h"

namespace vp::collide {

// Kept by whoever asks. Between calls there is nothing in it.
struct PartsScratch {
  CastScratch cast;
  std::vector<std::uint32_t> triangles;
};

bool parts_touch(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                 PartsScratch& scratch);

// Parts of compounds and triangles of surfaces, 0 of others.
struct NearestParts {
  ClosestPoints points;
  std::uint32_t part_a = 0, part_b = 0;
};
// The two that are nearest or, where some overlap, deepest; of equals those with the lowest
// numbers. False: none are as near as limit [m].
bool nearest_parts(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   double limit, PartsScratch& scratch, NearestParts& found);

struct PartsImpact {
  double time;
  ClosestPoints points;  // then
  std::uint32_t part_a = 0, part_b = 0;
};
// The first time at which the separation of two parts has come down to target [m], 0 if it has from
// the start; of equals those with the lowest numbers. A one-sided triangle is met only by what has
// its middle in front of it then. False: not within the duration.
//
// Who follows something that touches a surface already has to give a target below the separation of
// all parts together: else it meets the next triangle wherever it slides. Of what is as near as the
// target at time 0, he may know better whether it is a contact: parts are then passed over.
enum class NearParts { met, passed };
bool first_impact(const ImpactQuery& query, double target, PartsScratch& scratch,
                  PartsImpact& found, NearParts near_at_start = NearParts::met);

}  // namespace vp::collide
