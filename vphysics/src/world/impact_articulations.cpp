// Impact stage: articulations at an instant and between two.
#include "world/impact_stage.h"

namespace vp {
namespace {

void integrate_forces_of(const StepContext& s, Articulation& art, double dt) {
  bool changed = false;
  if (!art.integrate_forces(dt, changed)) {
    s.status.non_finite = true;
    art.return_to_start();
  }
  if (changed) follow_velocities(art, s.bodies);
}

}  // namespace

void ImpactStage::integrate_articulations(double dt) {
  for (Articulation& art : s_.articulations) {
    if (!art.alive || art.sub_stepped) continue;  // integrated in the sub-steps
    art.mark_start();
    if (art.remote) continue;  // balanced: only its motors exert forces
    integrate_forces_of(s_, art, dt);
  }
}

// Whether a motor exceeds its limit that was predicted to stay below it: it is a row now, the
// forces of its articulation are integrated again, and the instant must be solved again.
bool ImpactStage::integrate_saturated_again(double dt, bool solved, bool all_become_rows) {
  bool again = false;
  for (Articulation& art : s_.articulations) {
    if (!art.alive || art.remote || art.sub_stepped ||
        !art.find_saturated_motors(solved, all_become_rows))
      continue;
    again = true;
    art.restart_forces();
    follow_velocities(art, s_.bodies);
    const auto note = [&](const auto& forced) {
      for (const std::uint32_t b : art.bodies) {
        if (s_.bodies[b].first_collider != kNone) forced_[b] = forced(s_.bodies[b], forced_[b]);
      }
    };
    note([](const Body& body, const Velocity&) { return Velocity{body.w, body.v}; });
    integrate_forces_of(s_, art, dt);
    note([](const Body& body, const Velocity& before) {
      return Velocity{body.w - before.w, body.v - before.v};
    });
  }
  if (!again) return false;
  // What the instant gave is no warm start, since its motors were too strong.
  for (const solve::JointRow& row : rows_.rows()) {
    if (row.remember) *row.remember = row.warm_start;
  }
  pair_contacts_.reload_warm_starts(contacts_);
  return true;
}

void ImpactStage::begin_solve_articulations(bool first) {
  for (std::uint32_t a = 0; a < s_.articulations.size(); ++a) {
    const Articulation& art = s_.articulations[a];
    if (art.alive && !art.remote) rows_.load_articulation(a, first);
  }
}

void ImpactStage::end_solve_articulations(bool first) {
  for (const solve::JointRow& row : rows_.rows()) {
    if (row.remember) {
      *row.remember = row.impulse;
    } else if (row.pair == solve::kNoPair) {
      s_.articulations[row.articulation].add_effort(row.dof, row.impulse);
    }
  }
  for (Articulation& art : s_.articulations) {
    if (!art.alive || art.remote) continue;
    const Articulation::Change change = art.end_solve();
    if (change == Articulation::Change::none || stop_if_out_of_range(s_, art)) continue;
    follow_velocities(art, s_.bodies, [&](std::uint32_t b, const se3& now) {
      if (first && !(forced_[b] == Velocity{}))
        remove_cancelled_forces(b, now.w - s_.bodies[b].w, now.v - s_.bodies[b].v);
    });
    if (change == Articulation::Change::of_coordinates_too) follow(art, s_.bodies, s_.lists);
  }
}

void ImpactStage::store_implicit_impulses() {
  for (Articulation& art : s_.articulations) {
    if (art.alive && !art.remote && !art.sub_stepped) art.store_implicit_impulses();
  }
}

void ImpactStage::advance_articulations(double h) {
  for (Articulation& art : s_.articulations) {
    if (!art.alive || stopped_[art.bodies.front()]) continue;
    art.advance(h);
    if (stop_if_out_of_range(s_, art)) {
      stop_body(art.bodies.front());
    } else if (art.remote) {
      // its links wait
    } else if (art.keeps_twists() && !art.sub_stepped) {
      follow_poses(art, s_.bodies);
    } else {
      follow(art, s_.bodies, s_.lists);
    }
  }
}

// A link stops together with its whole articulation.
void ImpactStage::stop_body(std::uint32_t index) {
  const auto stop = [&](std::uint32_t b) {
    stopped_[b] = 1;
    motions_[b].v = motions_[b].w = {};
  };
  if (!s_.bodies[index].is_link) return stop(index);
  for (const std::uint32_t b : s_.articulations[s_.bodies[index].articulation].bodies) stop(b);
}

}  // namespace vp
