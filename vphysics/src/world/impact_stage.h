// Data of the impact stage, which handles continuous bodies and links in the order of time
// (step.cpp, contacts.cpp), and of links in the sub-steps (link_contacts.cpp).
#pragma once

#include <cstdint>
#include <vector>

#include "solve/contact_solver.h"
#include "solve/instant_scratch.h"
#include "world/impact_pairs.h"
#include "world/impact_queue.h"

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

// Whether the current impact affects a body (impacts.cpp).
enum class Concern : std::uint8_t { none, listed, searched };

struct ImpactStage {
  // State, sorted by key and part; next_records: of the current step.
  std::vector<PairRecord> records, next_records;
  // State: length of the step in which the impulses of records and of articulations' joints were
  // computed [s]; 0: none yet.
  double step = 0.0;
  // Bodies were added or removed: drift and forced of bodies outside the list may not be 0.
  bool scratch_is_dirty = true;
  SweptBodyPairs swept_body_pairs;
  DiscreteBodyPairs discrete_body_pairs;

  // --- of each body
  std::vector<SE3> start_poses;
  std::vector<collide::Motion> motions;     // for the rest of the step
  std::vector<collide::Bounds> bounds;      // swept bounds for the rest of the step
  std::vector<Velocity> drift;              // mean velocity over the step less that at its end
  std::vector<Velocity> forced;             // velocity change from the step's forces
  std::vector<std::uint8_t> stopped;        // at rest for the rest of the step
  std::vector<std::uint8_t> in_contact;     // in a swept contact of the last solve
  std::vector<std::uint8_t> moves_rigidly;  // moves to its next impact at the twist of its sweep
  // Of a free body: the time within the step of its pose. Links are at the last impact.
  std::vector<double> times;
  std::vector<std::uint8_t> brought;  // has advanced within the step
  std::vector<Concern> concerns;
  std::vector<double> first_impacts;  // of each body, among the pairs that are being queued [s]
  std::vector<solve::SolverBody> solver_bodies;

  // --- of an impact
  std::vector<std::uint32_t> concerned, moved;  // bodies
  std::vector<std::uint32_t> reached_sensors;   // pairs of the queue
  std::vector<ColliderPair> discrete_pairs;
  std::vector<SweptPair> swept_pairs;
  std::vector<solve::ContactConstraint> discrete_contacts, contacts;
  std::vector<solve::JointRow> joint_rows;
  std::vector<solve::JointPair> joint_pairs;
  std::vector<solve::SolverArticulation> solver_articulations;
  std::vector<double> link_rows;
  solve::InstantScratch instant;

  // --- of a step
  ImpactQueue queue;
  std::vector<std::uint32_t> row_joints;  // alive joints in rows (row_joints.h)
  std::vector<SE3> next_poses;            // of each body: next pose, of links in these joints

  // --- of the sub-steps
  std::vector<solve::ContactConstraint> link_contacts;
  std::vector<std::uint32_t> bodies_on_links;
};

}  // namespace vp
