// The impact stage: solves the contacts at the start of a step, then impacts in the order of time.
//
// An impact affects the bodies of its pair, the dynamic bodies that touch these, and so on
// (ImpactStage::concerned). Only the contacts of affected bodies are solved; then their motions and
// pairs are computed again. Every other body keeps its motion, and its pose keeps its own time
// (ImpactStage::times); a body that may collide with an affected one is advanced to the impact.
// Every impact affects the links whose motion has changed, and the bodies in contacts with links
// and in row joints.
#include <algorithm>
#include <iterator>
#include <utility>

#include "world/impl.h"

namespace vp {
namespace {

// The separation at which a pair has its impact. For a pair that touches already, this is deeper
// than the slop and than its current penetration: a ball that rests, rolls or is pinched has no
// impacts.
double separation_at_impact(const SweptPair& swept, double slop) {
  return swept.separation > slop ? 0.5 * slop : std::min(-slop, swept.separation - 0.1 * slop);
}

bool is_free(const Body& body) {
  return !body.is_link && body.motion == Motion::dynamic;
}

}  // namespace

// --- the queue -----------------------------------------------------------------------------------

// Queues impacts.swept_pairs. Precondition: all their bodies are at `now`, h before the end of the
// step.
void World::Impl::queue_swept_pairs(double now, double h) {
  using Kind = ImpactQueue::Kind;
  const auto body_of = [&](std::uint32_t collider) { return colliders[collider].body; };
  for (const SweptPair& swept : impacts.swept_pairs) {
    for (const std::uint32_t b : {body_of(swept.pair.a), body_of(swept.pair.b)}) {
      impacts.moves_rigidly[b] = 1;
      impacts.first_impacts[b] = h;
    }
  }
  const auto queue = [&](const SweptPair& swept) {
    const std::uint32_t a = body_of(swept.pair.a), b = body_of(swept.pair.b);
    double until = h;
    for (const std::uint32_t body : {a, b}) {
      if (is_free(bodies[body])) until = std::min(until, impacts.first_impacts[body]);
    }
    const double t = time_of(swept, until);
    if (t < 0.0 && !(until < h)) return;
    QueuedPair pair{swept, a, b, 0, 0, now, t < 0.0 ? until : t};
    const Kind kind = t < 0.0 ? Kind::waiting : swept.sensor ? Kind::sensor : Kind::impact;
    impacts.queue.wait(impacts.queue.add(pair), kind);
    if (kind != Kind::impact) return;
    for (const std::uint32_t body : {a, b}) impacts.first_impacts[body] = t;
  };
  for (const bool sensor : {false, true}) {
    for (const SweptPair& swept : impacts.swept_pairs) {
      if (swept.sensor == sensor) queue(swept);
    }
  }
}

// The time until the impact, from the current poses of both bodies; negative: not within h.
double World::Impl::time_of(const SweptPair& swept, double h) {
  const ImpactTimes times = impact_times();
  if (!swept.sensor) return times.until(swept, separation_at_impact(swept, desc.contact_slop), h);
  return swept.separation <= times.tolerance() ? 0.0 : times.until(swept, 0.0, h);
}

// Computes the time of impact of a waiting pair.
void World::Impl::look_at_waiting(std::uint32_t index, const Instant& now) {
  QueuedPair& pair = impacts.queue.pair(index);
  for (const std::uint32_t body : {pair.a, pair.b}) {
    bring(body, now);
    pose_colliders(bodies[body], colliders);
  }
  const double t = time_of(pair.swept, dt_now - now.time);
  if (t < 0.0) return;
  pair.found = now.time;
  pair.after = t;
  impacts.queue.wait(index,
                     pair.swept.sensor ? ImpactQueue::Kind::sensor : ImpactQueue::Kind::impact);
}

// Returns false if there is no impact until the end of the step. Lists the sensors that are reached
// before the impact.
bool World::Impl::next_impact(const Instant& now, Instant& next) {
  impacts.reached_sensors.clear();
  while (const ImpactQueue::Entry* const entry = impacts.queue.first()) {
    const ImpactQueue::Entry first = *entry;
    if (first.kind == ImpactQueue::Kind::impact) {
      const QueuedPair& pair = impacts.queue.pair(first.pair);
      next = {first.time, pair.found, pair.after};
      return true;
    }
    impacts.queue.pop();
    if (first.kind == ImpactQueue::Kind::sensor) {
      impacts.reached_sensors.push_back(first.pair);
    } else {
      look_at_waiting(first.pair, now);
    }
  }
  return false;
}

// Swept bodies report a sensor even if they pass through it within the step.
void World::Impl::report_reached_sensors() {
  std::sort(impacts.reached_sensors.begin(), impacts.reached_sensors.end(),
            [this](std::uint32_t p, std::uint32_t q) {
              return impacts.queue.pair(p).swept.pair.key < impacts.queue.pair(q).swept.pair.key;
            });
  for (const std::uint32_t index : impacts.reached_sensors) {
    const QueuedPair& pair = impacts.queue.pair(index);
    const SweptPair& swept = pair.swept;
    const Collider& c = colliders[swept.swept_is_a ? swept.pair.a : swept.pair.b];
    pose_colliders(bodies[c.body], colliders);
    const double t = (pair.found - impacts.times[c.body]) + pair.after;
    const Vec3 centre = c.T.position() + t * impacts.motions[c.body].v;
    report_sensor(swept.pair, centre, {0, 0, 0}, pair.found + pair.after);
  }
}

// --- an impact -----------------------------------------------------------------------------------

// Advances a body along its swept motion to a later time. Links are there already.
void World::Impl::bring(std::uint32_t index, const Instant& now) {
  Body& body = bodies[index];
  if (body.is_link || impacts.times[index] == now.time) return;
  const double h = now.since(std::exchange(impacts.times[index], now.time));
  if (is_still(body) || impacts.stopped[index]) return;
  impacts.brought[index] = 1;
  move_within_step(index, h, false);
  impacts.motions[index].x = reference_point(body);
}

void World::Impl::move_within_step(std::uint32_t index, double h, bool freely) {
  advance_body(bodies[index], impacts.motions[index], h, freely, impacts.drift[index].w);
  if (!stop_if_out_of_range(context, index, impacts.start_poses[index])) return;
  impacts.stopped[index] = 1;
  refresh_motion_of(index, dt_now - impacts.times[index]);
  refresh_bounds_of(index, dt_now - impacts.times[index]);
}

// Adds a body to the affected ones; a link with all links of its articulation that have colliders.
void World::Impl::concern(std::uint32_t index) {
  const auto add = [this](std::uint32_t b) {
    if (impacts.concerns[b] != Concern::none) return;
    impacts.concerns[b] = Concern::listed;
    impacts.concerned.push_back(b);
  };
  const Body& body = bodies[index];
  if (body.motion == Motion::fixed || impacts.concerns[index] != Concern::none) return;
  if (!body.is_link) return add(index);
  for (const std::uint32_t b : articulations[body.articulation].bodies) {
    if (bodies[b].first_collider != kNone) add(b);
  }
}

// Advances the links to the impact. It affects those whose motion changes.
void World::Impl::advance_links(const Instant& previous, const Instant& now) {
  const double h = now.since(previous.time);
  advance_discrete_contacts(h);
  advance_articulations(h);
  refresh_links(dt_now - now.time);
}
void World::Impl::refresh_links(double h) {
  for (const std::uint32_t i : lists.links) {
    if (bodies[i].remote) continue;
    const collide::Motion before = impacts.motions[i];
    refresh_motion_of(i, h);
    refresh_bounds_of(i, h);
    if (before.v != impacts.motions[i].v || before.w != impacts.motions[i].w) concern(i);
  }
}

// Adds the bodies of the pairs that collide now, and of the next pairs while these already touch.
// Drops the pairs of affected bodies: they are found again.
void World::Impl::concern_bodies_that_meet(const Instant& now) {
  const auto is_concerned = [this](std::uint32_t b) {
    return impacts.concerns[b] != Concern::none;
  };
  while (const ImpactQueue::Entry* const entry = impacts.queue.first()) {
    const QueuedPair& pair = impacts.queue.pair(entry->pair);
    if (!is_concerned(pair.a) && !is_concerned(pair.b)) {
      if (entry->kind != ImpactQueue::Kind::impact) return;
      if (entry->time > now.time && !touches_at(pair, now)) return;
      concern(pair.a);
      concern(pair.b);
    }
    impacts.queue.pop();
  }
}

// Whether the bodies are so close to their impact that they touch. Does not advance them.
bool World::Impl::touches_at(const QueuedPair& pair, const Instant& now) {
  constexpr double kTouching = 0.4;  // fraction of the slop; impacts are at a separation of half
  const double left = (pair.found + pair.after) - now.time;
  return travel(bodies[pair.a], impacts.motions[pair.a], left) +
             travel(bodies[pair.b], impacts.motions[pair.b], left) <=
         kTouching * desc.contact_slop;
}

// Adds the pairs of an affected body that can collide within h. A pair of two affected bodies is
// added once.
void World::Impl::find_swept_pairs_of(std::uint32_t index, const Instant& now, double h) {
  impacts.concerns[index] = Concern::searched;
  impacts.swept_body_pairs.for_each_partner(index, [&](std::uint32_t other) {
    if (impacts.concerns[other] == Concern::searched) return;
    if (!overlap(impacts.bounds[index], impacts.bounds[other])) return;
    bring(other, now);
    add_swept_pairs_of({std::min(index, other), std::max(index, other)}, h);
  });
}

// Adds the dynamic bodies that touch affected ones.
void World::Impl::concern_what_touches(const Instant& now) {
  const double h = dt_now - now.time;
  impacts.swept_pairs.clear();
  for (std::size_t k = 0; k < impacts.concerned.size(); ++k) {
    const std::uint32_t i = impacts.concerned[k];
    if (!bodies[i].is_link) {
      bring_concerned(i, now);
      refresh_motion_of(i, h);
      refresh_bounds_of(i, h);
    }
    impacts.swept_body_pairs.find(body_motions(), {&i, 1}, desc.contact_slop, h);
    const std::size_t first = impacts.swept_pairs.size();
    find_swept_pairs_of(i, now, 0.0);
    for (std::size_t p = first; p < impacts.swept_pairs.size(); ++p) {
      const SweptPair& swept = impacts.swept_pairs[p];
      if (swept.sensor || swept.separation > desc.contact_slop) continue;
      for (const std::uint32_t c : {swept.pair.a, swept.pair.b}) {
        if (bodies[colliders[c].body].motion == Motion::dynamic) concern(colliders[c].body);
      }
    }
  }
  std::sort(impacts.concerned.begin(), impacts.concerned.end());
  sort_swept_pairs();
}

// Advances an affected body to the impact, with its free rotation if no swept pair was found for
// it.
void World::Impl::bring_concerned(std::uint32_t index, const Instant& now) {
  if (impacts.times[index] != now.time && !is_still(bodies[index]) && !impacts.stopped[index]) {
    const double h = now.since(std::exchange(impacts.times[index], now.time));
    move_within_step(index, h, !impacts.moves_rigidly[index] && !impacts.brought[index]);
  }
  impacts.times[index] = now.time;
  impacts.moves_rigidly[index] = impacts.brought[index] = 0;
}

void World::Impl::find_swept_pairs_of_concerned(const Instant& now) {
  const double h = dt_now - now.time;
  for (const std::uint32_t i : impacts.concerned) {
    if (bodies[i].is_link) continue;
    refresh_motion_of(i, h);
    refresh_bounds_of(i, h);
  }
  refresh_links(h);
  collide_remote(h);
  impacts.moved.assign(impacts.concerned.begin(), impacts.concerned.end());
  for (const std::uint32_t i : lists.links) {
    if (!bodies[i].remote && impacts.concerns[i] == Concern::none) impacts.moved.push_back(i);
  }
  impacts.swept_body_pairs.find(body_motions(), impacts.moved, desc.contact_slop, h);
  for (const std::uint32_t i : impacts.concerned) {
    impacts.queue.forget_pairs_of(i);
    impacts.concerns[i] = Concern::listed;
  }
  impacts.swept_pairs.clear();
  for (const std::uint32_t i : impacts.concerned) find_swept_pairs_of(i, now, h);
  sort_swept_pairs();
}

void World::Impl::solve_impact(const Instant& previous, const Instant& now) {
  const double h = dt_now - now.time;
  impacts.concerned.clear();
  advance_links(previous, now);
  for (const solve::ContactConstraint& c : impacts.discrete_contacts) {
    concern(c.a);
    concern(c.b);
  }
  for (const std::uint32_t i : impacts.row_joints) {
    if (is_in_sub_steps(joints[i])) continue;
    concern(joints[i].a);
    concern(joints[i].b);
  }
  concern_bodies_that_meet(now);
  concern_what_touches(now);
  solve_contacts(h, dt_now, false);
  report_contacts(impacts.contacts, now.time);
  note_contacts(impacts.contacts);
  find_swept_pairs_of_concerned(now);
  queue_swept_pairs(now.time, h);
  for (const std::uint32_t i : impacts.concerned) impacts.concerns[i] = Concern::none;
}

// --- the stage -----------------------------------------------------------------------------------

// Stops the bodies of the swept pairs that would collide within h. A body that stops is in the way
// of others that it would have stayed ahead of, so its pairs are found again.
void World::Impl::stop_swept_pairs(const Instant& now, double h) {
  std::vector<std::uint32_t>& stopped = impacts.concerned;
  stopped.clear();
  const auto stop = [&](std::uint32_t body) {
    if (impacts.stopped[body]) return;
    hold(body);
    if (!bodies[body].is_link) return stopped.push_back(body);
    const auto& links = articulations[bodies[body].articulation].bodies;
    std::copy_if(links.begin(), links.end(), std::back_inserter(stopped),
                 [this](std::uint32_t b) { return bodies[b].first_collider != kNone; });
  };
  for (std::size_t pair = 0, searched = 0;; ++searched) {
    for (; pair < impacts.swept_pairs.size(); ++pair) {
      const SweptPair swept = impacts.swept_pairs[pair];
      if (swept.sensor || time_of(swept, h) < 0.0) continue;
      stop(colliders[swept.pair.a].body);
      stop(colliders[swept.pair.b].body);
    }
    if (searched == stopped.size()) break;
    find_swept_pairs_of(stopped[searched], now, h);
  }
  for (const std::uint32_t i : stopped) impacts.concerns[i] = Concern::none;
}

// The limit of impacts is reached: bodies that would still collide stop for the rest of the step.
void World::Impl::stop_what_would_hit(const Instant& now) {
  status.impact_limit = true;
  const double h = status.time_lost = dt_now - now.time;
  for (const std::uint32_t i : lists.of_impacts(bodies)) {
    bring(i, now);
    impacts.brought[i] = 0;
  }
  refresh_displacements(h);
  find_swept_pairs(h);
  stop_swept_pairs(now, h);
  take_back_forces(h);
  // Lists the sensors that are reached within the rest of the step.
  impacts.queue.clear(bodies.size());
  std::erase_if(impacts.swept_pairs, [](const SweptPair& p) { return !p.sensor; });
  sort_swept_pairs();
  const auto is_same = [](const SweptPair& p, const SweptPair& q) {
    return p.pair.key == q.pair.key;
  };
  impacts.swept_pairs.erase(
      std::unique(impacts.swept_pairs.begin(), impacts.swept_pairs.end(), is_same),
      impacts.swept_pairs.end());
  queue_swept_pairs(now.time, h);
  Instant none;
  (void)next_impact(now, none);
}

void World::Impl::advance_to_end(const Instant& now) {
  for (const std::uint32_t i : lists.of_impacts(bodies)) {
    const Body& body = bodies[i];
    if (body.is_link || is_still(body) || impacts.stopped[i]) continue;
    const double h = dt_now - std::exchange(impacts.times[i], dt_now);
    move_within_step(i, h, !impacts.in_contact[i] && !impacts.brought[i]);
  }
  advance_articulations(dt_now - now.time);
}

void World::Impl::run_impacts(double dt) {
  const auto stage = in(Stage::impacts);
  end_links(dt, sub_steps_taken);
  refresh_displacements(dt);
  make_remote();
  find_discrete_pairs(dt);
  find_touching_pairs(dt);
  find_discrete_contacts(dt);
  solve_contacts(dt, dt, true);
  remember_impulses(impacts.contacts, 1.0);
  report_contacts(impacts.contacts, 0.0);
  note_contacts(impacts.contacts);
  refresh_displacements(dt);
  find_swept_pairs(dt);
  impacts.queue.clear(bodies.size());
  queue_swept_pairs(0.0, dt);
  Instant now;
  for (int solved = 0;; ++solved) {
    Instant next;
    bool collides = next_impact(now, next);
    if (collides && solved >= desc.max_impacts_per_step) {
      stop_what_would_hit(now);
      collides = false;
    }
    report_reached_sensors();
    if (solved == 0) report_ends();
    if (!collides) break;
    ++counters.impacts;
    solve_impact(now, next);
    now = next;
  }
  advance_to_end(now);
  note_open_row_joints();
}

}  // namespace vp
