#include "world/fast_rotation.h"

#include <algorithm>
#include <cmath>

#include "solve/row_vector.h"
#include "world/validate.h"

namespace vp {
namespace {

// In half extents: how far a body that others are swept against may move in the step, and how deep
// an overlap at the end of the step is left to the contacts of the next one.
constexpr double kSlowMotion = 0.5, kShallow = 0.5;
// Of two that touch at the start, poses at these angles [rad] and distances of one reach are
// tested: a part of a body that enters another one is then still in it.
constexpr double kSample = 0.4, kMaxSamples = 20.0;
constexpr int kMaxAdvances = 64;

// Displacement of a body over the step.
struct Displacement {
  Vec3 v, w;
};

class FastRotation {
 public:
  explicit FastRotation(const FastRotationContext& context) : on_(context) {}

  bool rotates_fast(std::uint32_t index) const {
    const Body& body = on_.bodies[index];
    if (body.lanes == 0 || body.motion != Motion::dynamic || !joins_sub_steps(body)) return false;
    const Displacement d = displacement_of(index);
    return dot(d.w, d.w) > square(static_cast<double>(on_.searched[index].angle)) &&
           in_range(d.v) && in_range(d.w);
  }

  // The fraction of its displacement at which it meets another body; 1 if it does not.
  double fraction_of(std::uint32_t index) const {
    double fraction = 1.0;
    on_.contacts.for_each_of(on_.bodies[index], [&](std::uint32_t, const Contact& c) {
      if (c.sensor || c.of_link || c.parked || c.is_part()) return;
      if (c.slot.points == 0 && c.first_part == kNone) return;
      const bool is_a = on_.colliders[c.a].body == index;
      Collider& own = on_.colliders[is_a ? c.a : c.b];
      Collider& other = on_.colliders[is_a ? c.b : c.a];
      if (is_surface(own.geometry) || !moves_slowly(other.body)) return;
      pose_colliders(on_.bodies[index], on_.colliders);
      pose_colliders(on_.bodies[other.body], on_.colliders);
      fraction = std::min(fraction, impact_of(moving(own), moving(other), shallow(own, other),
                                              on_.bodies[index].bounding_radius));
    });
    return fraction;
  }

  void shorten(const ShortenedMotion& motion) const {
    float* displacement = on_.rows[motion.body + 1].displacement;
    const float* start = on_.start_displacements[motion.body].data();
    for (int i = 0; i < 6; ++i)
      displacement[i] = start[i] + motion.fraction * (displacement[i] - start[i]);
    on_.bodies[motion.body].shortened = true;
  }

 private:
  static double square(double x) { return x * x; }

  Displacement displacement_of(std::uint32_t index) const {
    const float* at = on_.rows[index + 1].displacement;
    const float* start = on_.start_displacements[index].data();
    return {vector_of(at) - vector_of(start), vector_of(at + 3) - vector_of(start + 3)};
  }

  bool moves_slowly(std::uint32_t index) const {
    const Body& body = on_.bodies[index];
    if (is_still(body)) return true;
    if (!joins_sub_steps(body)) return false;
    const Displacement d = displacement_of(index);
    return norm(d.v) + body.bounding_radius * norm(d.w) <= kSlowMotion * body.min_size;
  }

  collide::MovingShape moving(const Collider& collider) const {
    const Body& body = on_.bodies[collider.body];
    const Displacement d = is_still(body) ? Displacement{} : displacement_of(collider.body);
    return {&collider.geometry, collider.T, {reference_point(body), d.v, d.w}};
  }

  static double shallow(const Collider& own, const Collider& other) {
    return kShallow * smaller_size(own, other);
  }

  // The closest points at a fraction of the motion, if they are within the limit.
  bool nearest_at(double fraction, double limit, const collide::MovingShape& own,
                  const collide::MovingShape& other, collide::ClosestPoints& points) const {
    collide::NearestParts nearest;
    if (!nearest_parts(*own.shape, pose_at(own, fraction), *other.shape, pose_at(other, fraction),
                       limit, on_.scratch, nearest))
      return false;
    points = nearest.points;
    return true;
  }
  bool overlaps_deeply(double fraction, double shallow, const collide::MovingShape& own,
                       const collide::MovingShape& other) const {
    collide::ClosestPoints points;
    return nearest_at(fraction, 0.0, own, other, points) && points.distance < -shallow;
  }

  double impact_of(const collide::MovingShape& own, const collide::MovingShape& other,
                   double shallow, double reach) const {
    // Stops within the slop, so that the next step has the contact.
    const double target = 0.5 * on_.slop, tolerance = 0.25 * on_.slop;
    collide::ClosestPoints start, end;
    if (nearest_at(0.0, target + tolerance, own, other, start))
      return end_of_shallow(own, other, shallow + std::max(0.0, -start.distance), reach);
    collide::PartsImpact impact{};
    if (!first_impact({own, other, 1.0, tolerance}, target, on_.scratch, impact)) return 1.0;
    // A shallow overlap on the same side is left to the contacts.
    const bool left_to_contacts = nearest_at(1.0, on_.slop, own, other, end) &&
                                  end.distance >= -shallow &&
                                  dot(end.normal, impact.points.normal) > 0.0;
    return left_to_contacts ? 1.0 : impact.time;
  }

  // Of two that touch at the start: the fraction up to which they do not overlap deeply. Poses
  // along the motion are tested. If one overlaps deeply, the motion advances only as far as the
  // overlap cannot become deep at the speed of the fastest point.
  double end_of_shallow(const collide::MovingShape& own, const collide::MovingShape& other,
                        double shallow, double reach) const {
    const double rotation = norm(own.motion.w), shift = norm(own.motion.v - other.motion.v);
    const int samples =
        1 + static_cast<int>(std::min(rotation / kSample + shift / reach, kMaxSamples));
    int k = 1;
    while (k <= samples && !overlaps_deeply(static_cast<double>(k) / samples, shallow, own, other))
      ++k;
    if (k > samples) return 1.0;
    const double end = static_cast<double>(k) / samples;
    const double speed = shift + (rotation + norm(other.motion.w)) * reach;
    double fraction = static_cast<double>(k - 1) / samples;
    for (int i = 0; i < kMaxAdvances; ++i) {
      collide::ClosestPoints points;
      const double distance =
          nearest_at(fraction, shallow, own, other, points) ? points.distance : shallow;
      if (distance <= -0.5 * shallow) break;
      fraction += (distance + shallow) / speed;
      if (fraction >= end) return end;
    }
    return fraction;
  }

  const FastRotationContext& on_;
};

}  // namespace

void stop_fast_rotating_bodies(const FastRotationContext& context,
                               std::vector<ShortenedMotion>& found) {
  const FastRotation fast(context);
  found.clear();
  for (const std::uint32_t i : context.awake_bodies) {
    if (!fast.rotates_fast(i)) continue;
    const double fraction = fast.fraction_of(i);
    if (fraction < 1.0) found.push_back({i, static_cast<float>(fraction)});
  }
  for (const ShortenedMotion& motion : found) fast.shorten(motion);
}

}  // namespace vp
