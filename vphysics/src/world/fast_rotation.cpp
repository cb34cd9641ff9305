#include "world/fast_rotation.h"

#include <algorithm>
#include <cmath>

#include "solve/state_vector.h"
#include "world/step_context.h"
#include "world/validate.h"

namespace vp {
namespace {

// In half extents of the body: how far rotation moves the outermost point of a body that is swept;
// how far a body that others are swept against may move; how deep an overlap at the end of the step
// is left to the contacts of the next one.
constexpr double kFastRotation = 0.75, kSlowMotion = 0.5, kShallow = 0.5;
// Smaller rotations are not looked at [rad].
constexpr double kMinRotation = 0.005;
// Of two that touch at the start, poses at these angles [rad] and distances of one bounding radius
// are tested: a part of a body that enters another one is then still in it.
constexpr double kSample = 0.4, kMaxSamples = 20.0;
constexpr int kMaxAdvances = 64;

// Displacement of a body over the step.
struct Displacement {
  Vec3 v, w;
};

class FastRotation {
 public:
  explicit FastRotation(const Stores& stores) : on_(stores) {}

  bool rotates_fast(std::uint32_t index) const {
    const Displacement d = displacement_of(index);
    if (!(dot(d.w, d.w) > kMinRotation * kMinRotation)) return false;
    const Body& body = on_.bodies[index];
    if (body.contact_slots == 0 || body.motion != Motion::dynamic || !joins_sub_steps(body))
      return false;
    if (body.first_joint != kNone) return false;  // alone it would leave its joints
    return in_range(d.v) && in_range(d.w) && rotates_far(body, d.w);
  }

  // The fraction of its displacement at which it meets another body; 1 if it does not.
  double fraction_of(std::uint32_t index) const {
    double fraction = 1.0;
    on_.contact_store.for_each_of(on_.bodies[index], [&](std::uint32_t, const Contact& c) {
      if (c.sensor || c.of_link || c.parked || c.is_part()) return;
      if (c.slot.points == 0 && c.first_part == kNone) return;
      const bool is_a = on_.colliders[c.a].body == index;
      Collider& own = on_.colliders[is_a ? c.a : c.b];
      Collider& other = on_.colliders[is_a ? c.b : c.a];
      if (is_surface(own.geometry) || !moves_slowly(other.body)) return;
      pose_colliders(on_.bodies[index], on_.colliders);
      pose_colliders(on_.bodies[other.body], on_.colliders);
      const Pair pair{moving(own), moving(other), kShallow * smaller_size(own, other),
                      on_.bodies[index].bounding_radius};
      fraction = std::min(fraction, impact_of(pair));
    });
    return fraction;
  }

  void shorten(const ShortenedMotion& motion) const {
    float* displacement = on_.body_states[motion.body + 1].displacement;
    const float* start = on_.start_displacements[motion.body].displacement;
    for (int i = 0; i < 6; ++i)
      displacement[i] = start[i] + motion.fraction * (displacement[i] - start[i]);
    on_.bodies[motion.body].shortened = true;
  }

 private:
  Displacement displacement_of(std::uint32_t index) const {
    const float* at = on_.body_states[index + 1].displacement;
    const float* start = on_.start_displacements[index].displacement;
    return {vector_of(at) - vector_of(start), vector_of(at + 3) - vector_of(start + 3)};
  }

  bool moves_slowly(std::uint32_t index) const {
    const Body& body = on_.bodies[index];
    if (is_still(body)) return true;
    if (!joins_sub_steps(body)) return false;
    if (body.motion == Motion::kinematic) return true;  // it does not yield
    const Displacement d = displacement_of(index);
    return norm(d.v) + body.bounding_radius * norm(d.w) <= kSlowMotion * body.min_size;
  }

  collide::MovingShape moving(const Collider& collider) const {
    const Body& body = on_.bodies[collider.body];
    const Displacement d = is_still(body) ? Displacement{} : displacement_of(collider.body);
    return {&collider.geometry, collider.T, {reference_point(body), d.v, d.w}};
  }

  // Whether the rotation moves a corner of the body's bounds by more than a fraction of its
  // smallest half extent.
  static bool rotates_far(const Body& body, const Vec3& rotation) {
    const Vec3 extent = 0.5 * (body.local.upper - body.local.lower),
               centre = 0.5 * (body.local.upper + body.local.lower) - body.centre,
               w = transposed_times(body.T.rotation(), rotation);
    const double x = extent.x + std::fabs(centre.x), y = extent.y + std::fabs(centre.y),
                 z = extent.z + std::fabs(centre.z);
    const double wx = std::fabs(w.x), wy = std::fabs(w.y), wz = std::fabs(w.z);
    const Vec3 shift{wy * z + wz * y, wz * x + wx * z, wx * y + wy * x};
    return norm(shift) > kFastRotation * std::min({extent.x, extent.y, extent.z});
  }

  // Two colliders, their motions over the step, the depth of an overlap that is left to the
  // contacts and the distance of the own body's farthest point from its centre.
  struct Pair {
    collide::MovingShape own, other;
    double shallow, bounding_radius;
  };

  // The closest points at a fraction of the motion, if they are within the limit.
  bool nearest_at(double fraction, double limit, const Pair& pair,
                  collide::ClosestPoints& points) const {
    collide::NearestParts nearest;
    if (!nearest_parts(*pair.own.shape, pose_at(pair.own, fraction), *pair.other.shape,
                       pose_at(pair.other, fraction), limit, on_.shapes.parts_scratch, nearest))
      return false;
    points = nearest.points;
    return true;
  }
  bool overlaps_deeply(double fraction, double shallow, const Pair& pair) const {
    collide::ClosestPoints points;
    return nearest_at(fraction, 0.0, pair, points) && points.distance < -shallow;
  }

  double impact_of(const Pair& pair) const {
    // Stops within the slop, so that the next step has the contact.
    const double target = 0.5 * on_.desc.contact_slop, tolerance = 0.25 * on_.desc.contact_slop;
    collide::ClosestPoints start, end;
    if (nearest_at(0.0, target + tolerance, pair, start))
      return end_of_shallow(pair, pair.shallow + std::max(0.0, -start.distance));
    collide::PartsImpact impact{};
    if (!first_impact({pair.own, pair.other, 1.0, tolerance}, target, on_.shapes.parts_scratch,
                      impact))
      return 1.0;
    // A shallow overlap on the same side is left to the contacts.
    const bool left_to_contacts = nearest_at(1.0, on_.desc.contact_slop, pair, end) &&
                                  end.distance >= -pair.shallow &&
                                  dot(end.normal, impact.points.normal) > 0.0;
    return left_to_contacts ? 1.0 : impact.time;
  }

  // Of two that touch at the start: the fraction up to which they do not overlap deeply. Poses
  // along the motion are tested. If one overlaps deeply, the motion advances only as far as the
  // overlap cannot become deep at the speed of the fastest point. shallow: the depth at the start
  // and pair.shallow, so that a body that overlaps already is not stopped for good.
  double end_of_shallow(const Pair& pair, double shallow) const {
    const double rotation = norm(pair.own.motion.w),
                 shift = norm(pair.own.motion.v - pair.other.motion.v);
    const int samples = 1 + static_cast<int>(std::min(
                                rotation / kSample + shift / pair.bounding_radius, kMaxSamples));
    int k = 1;
    while (k <= samples && !overlaps_deeply(static_cast<double>(k) / samples, shallow, pair)) ++k;
    if (k > samples) return 1.0;
    const double speed = shift + (rotation + norm(pair.other.motion.w)) * pair.bounding_radius;
    double fraction = static_cast<double>(k - 1) / samples;
    for (int i = 0; i < kMaxAdvances; ++i) {
      collide::ClosestPoints points;
      const double distance =
          nearest_at(fraction, shallow, pair, points) ? points.distance : shallow;
      if (distance <= 0.5 * pair.shallow - shallow) break;
      fraction += (distance + shallow) / speed;
    }
    return std::min(fraction, static_cast<double>(k) / samples);
  }

  const Stores& on_;
};

}  // namespace

void stop_fast_rotating_bodies(const Stores& stores, FastRotationScratch& scratch) {
  const FastRotation fast(stores);
  const std::vector<std::uint32_t>& awake = stores.lists.awake_bodies;
  scratch.rotates_fast.resize(awake.size());
  stores.workers.in_parallel(awake.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      scratch.rotates_fast[k] = fast.rotates_fast(awake[k]) ? 1 : 0;
  });
  scratch.shortened.clear();
  for (std::size_t k = 0; k < awake.size(); ++k) {
    if (scratch.rotates_fast[k] == 0) continue;
    const double fraction = fast.fraction_of(awake[k]);
    if (fraction < 1.0) scratch.shortened.push_back({awake[k], static_cast<float>(fraction)});
  }
  for (const ShortenedMotion& motion : scratch.shortened) fast.shorten(motion);
}

}  // namespace vp
