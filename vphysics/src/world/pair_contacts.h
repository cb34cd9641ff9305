// Contacts of links and of continuous bodies: from a pair of colliders to constraints of the solver
// (solve/contact_solver.h), and from solved constraints to warm starts and events.
//
// Reads colliders and their poses. Owns the records of the pairs, the state that persists between
// steps. Writes events, step contacts and status. Used in the links' sub-steps and in the impact
// stage.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solve/contact_solver.h"
#include "world/step_context.h"

namespace vp {

struct PairPoint {
  std::uint32_t feature;
  double normal_impulse;
  Vec3 friction;  // world frame
  Vec3 position;  // world frame
};

// State of a pair of colliders that persists between steps.
struct PairRecord {
  std::uint64_t key = 0;  // serials of both
  std::uint32_t a = 0, b = 0;
  std::uint32_t part = 0;  // index of the manifold, for pairs with several
  std::uint32_t count = 0;
  bool touching = false;  // the pair touches; only of part 0
  Vec3 rolling;
  PairPoint points[collide::kMaxPoints]{};
};

class PairContacts {
 public:
  explicit PairContacts(const StepContext& context) : s_(context) {}

  // Reserves memory for a number of pairs.
  void begin_step(std::size_t pairs);
  // Appends the pair's contacts within the margin. Precondition: the colliders are posed. warm:
  // with the impulses of the last step.
  void add(const ColliderPair& pair, double margin, bool swept, bool warm,
           std::vector<solve::ContactConstraint>& out);
  // Sets the impulses of the last step again.
  void reload_warm_starts(std::span<solve::ContactConstraint> contacts) const;
  // The impulses that support a load at the start of the step are the best warm start of the next.
  // scale: from the impulses to those of a whole step.
  void remember(std::span<const solve::ContactConstraint> solved, double scale);
  // Reports begin and hit events of solved contacts, and their impulses.
  void report(std::span<const solve::ContactConstraint> solved, double time);
  void report_sensor(const ColliderPair& pair, const Vec3& point, const Vec3& normal, double time);
  // The same if the two overlap at their poses.
  void test_sensor(const ColliderPair& pair);
  // Ends the pairs that touched in the last step and no longer do. They may begin again in this
  // step.
  void report_ends();
  void end_step();

  // --- between steps
  // Ends all pairs of a collider. The next step reports their end events.
  void forget(std::uint32_t collider);
  // Scales all impulses, for a step of another length.
  void scale(double factor);
  // Sorted by key and part.
  const std::vector<PairRecord>& records() const { return records_; }
  void swap_records(std::vector<PairRecord>& records) { records_.swap(records); }

 private:
  PairRecord& record_of(const ColliderPair& pair, std::uint32_t part = 0);
  std::span<const collide::SubManifold> manifolds_of(const ColliderPair& pair, double margin);
  void fill(const ColliderPair& pair, const collide::Manifold& m, solve::ContactConstraint& c);
  void load_warm_start(std::uint64_t key, std::uint32_t part, bool warm,
                       solve::ContactConstraint& c) const;
  void note_contacts(std::span<const solve::ContactConstraint> solved);

  const StepContext s_;
  std::vector<PairRecord> records_, next_records_;  // of the last step, of the current one
};

}  // namespace vp
