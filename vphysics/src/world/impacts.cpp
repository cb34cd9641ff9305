// The impact stage: solves the contacts at the start of a step, then impacts in the order of time.
//
// An impact affects the bodies of its pair, the dynamic bodies that touch these, and so on
// (affected_). Only the contacts of affected bodies are solved; then their motions and pairs are
// computed again. Every other body keeps its motion, and its pose keeps its own time (times_); a
// body that may collide with an affected one is advanced to the impact. Every impact affects the
// links whose motion has changed, and the bodies in contacts with links and in row joints.
#include <algorithm>
#include <iterator>
#include <utility>

#include "world/impact_stage.h"

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

// Queues swept_pairs_. Precondition: all their bodies are at `now`, h before the end of the step.
void ImpactStage::queue_swept_pairs(double now, double h) {
  using Kind = ImpactQueue::Kind;
  const auto body_of = [&](std::uint32_t collider) { return s_.colliders[collider].body; };
  for (const SweptPair& swept : swept_pairs_) {
    for (const std::uint32_t b : {body_of(swept.pair.a), body_of(swept.pair.b)}) {
      moves_rigidly_[b] = 1;
      first_impacts_[b] = h;
    }
  }
  const auto queue = [&](const SweptPair& swept) {
    const std::uint32_t a = body_of(swept.pair.a), b = body_of(swept.pair.b);
    double until = h;
    for (const std::uint32_t body : {a, b}) {
      if (is_free(s_.bodies[body])) until = std::min(until, first_impacts_[body]);
    }
    const double t = time_of(swept, until);
    if (t < 0.0 && !(until < h)) return;
    QueuedPair pair{swept, a, b, 0, 0, now, t < 0.0 ? until : t};
    const Kind kind = t < 0.0 ? Kind::waiting : swept.sensor ? Kind::sensor : Kind::impact;
    queue_.wait(queue_.add(pair), kind);
    if (kind != Kind::impact) return;
    for (const std::uint32_t body : {a, b}) first_impacts_[body] = t;
  };
  for (const bool sensor : {false, true}) {
    for (const SweptPair& swept : swept_pairs_) {
      if (swept.sensor == sensor) queue(swept);
    }
  }
}

// The time until the impact, from the current poses of both bodies; negative: not within h.
double ImpactStage::time_of(const SweptPair& swept, double h) {
  const ImpactTimes times = impact_times();
  if (!swept.sensor)
    return times.until(swept, separation_at_impact(swept, s_.desc.contact_slop), h);
  return swept.separation <= times.tolerance() ? 0.0 : times.until(swept, 0.0, h);
}

// Computes the time of impact of a waiting pair.
void ImpactStage::update_waiting(std::uint32_t index, const Instant& now) {
  QueuedPair& pair = queue_.pair(index);
  for (const std::uint32_t body : {pair.a, pair.b}) {
    advance_to(body, now);
    pose_colliders(s_.bodies[body], s_.colliders);
  }
  const double t = time_of(pair.swept, s_.dt - now.time);
  if (t < 0.0) return;
  pair.found = now.time;
  pair.after = t;
  queue_.wait(index, pair.swept.sensor ? ImpactQueue::Kind::sensor : ImpactQueue::Kind::impact);
}

// Returns false if there is no impact until the end of the step. Lists the sensors that are reached
// before the impact.
bool ImpactStage::next_impact(const Instant& now, Instant& next) {
  reached_sensors_.clear();
  while (const ImpactQueue::Entry* const entry = queue_.first()) {
    const ImpactQueue::Entry first = *entry;
    if (first.kind == ImpactQueue::Kind::impact) {
      const QueuedPair& pair = queue_.pair(first.pair);
      next = {first.time, pair.found, pair.after};
      return true;
    }
    queue_.pop();
    if (first.kind == ImpactQueue::Kind::sensor) {
      reached_sensors_.push_back(first.pair);
    } else {
      update_waiting(first.pair, now);
    }
  }
  return false;
}

// Swept bodies report a sensor even if they pass through it within the step.
void ImpactStage::report_reached_sensors() {
  std::sort(reached_sensors_.begin(), reached_sensors_.end(),
            [this](std::uint32_t p, std::uint32_t q) {
              return queue_.pair(p).swept.pair.key < queue_.pair(q).swept.pair.key;
            });
  for (const std::uint32_t index : reached_sensors_) {
    const QueuedPair& pair = queue_.pair(index);
    const SweptPair& swept = pair.swept;
    const Collider& c = s_.colliders[swept.swept_is_a ? swept.pair.a : swept.pair.b];
    pose_colliders(s_.bodies[c.body], s_.colliders);
    const double t = (pair.found - times_[c.body]) + pair.after;
    const Vec3 centre = c.T.position() + t * motions_[c.body].v;
    pair_contacts_.report_sensor(swept.pair, centre, {0, 0, 0}, pair.found + pair.after);
  }
}

// --- an impact -----------------------------------------------------------------------------------

// Advances a body along its swept motion to a later time. Links are there already.
void ImpactStage::advance_to(std::uint32_t index, const Instant& now) {
  Body& body = s_.bodies[index];
  if (body.is_link || times_[index] == now.time) return;
  const double h = now.since(std::exchange(times_[index], now.time));
  if (is_still(body) || stopped_[index]) return;
  advanced_[index] = 1;
  move_within_step(index, h, false);
  motions_[index].x = reference_point(body);
}

void ImpactStage::move_within_step(std::uint32_t index, double h, bool freely) {
  advance_body(s_.bodies[index], motions_[index], h, freely, drift_[index].w);
  if (!stop_if_out_of_range(s_, index, start_poses_[index])) return;
  stopped_[index] = 1;
  refresh_motion_of(index, s_.dt - times_[index]);
  refresh_bounds_of(index, s_.dt - times_[index]);
}

// Adds a body to the affected ones; a link with all links of its articulation that have colliders.
void ImpactStage::mark_affected(std::uint32_t index) {
  const auto add = [this](std::uint32_t b) {
    if (affected_flags_[b] != Affected::none) return;
    affected_flags_[b] = Affected::listed;
    affected_.push_back(b);
  };
  const Body& body = s_.bodies[index];
  if (body.motion == Motion::fixed || affected_flags_[index] != Affected::none) return;
  if (!body.is_link) return add(index);
  for (const std::uint32_t b : s_.articulations[body.articulation].bodies) {
    if (s_.bodies[b].first_collider != kNone) add(b);
  }
}

// Advances the links to the impact. It affects those whose motion changes.
void ImpactStage::advance_links(const Instant& previous, const Instant& now) {
  const double h = now.since(previous.time);
  advance_discrete_contacts(h);
  advance_articulations(h);
  refresh_links(s_.dt - now.time);
}
void ImpactStage::refresh_links(double h) {
  for (const std::uint32_t i : s_.lists.links) {
    if (s_.bodies[i].remote) continue;
    const collide::Motion before = motions_[i];
    refresh_motion_of(i, h);
    refresh_bounds_of(i, h);
    if (before.v != motions_[i].v || before.w != motions_[i].w) mark_affected(i);
  }
}

// Adds the bodies of the pairs that collide now, and of the next pairs while these already touch.
// Drops the pairs of affected bodies: they are found again.
void ImpactStage::mark_colliding_bodies_affected(const Instant& now) {
  const auto is_affected = [this](std::uint32_t b) { return affected_flags_[b] != Affected::none; };
  while (const ImpactQueue::Entry* const entry = queue_.first()) {
    const QueuedPair& pair = queue_.pair(entry->pair);
    if (!is_affected(pair.a) && !is_affected(pair.b)) {
      if (entry->kind != ImpactQueue::Kind::impact) return;
      if (entry->time > now.time && !touches_at(pair, now)) return;
      mark_affected(pair.a);
      mark_affected(pair.b);
    }
    queue_.pop();
  }
}

// Whether the bodies are so close to their impact that they touch. Does not advance them.
bool ImpactStage::touches_at(const QueuedPair& pair, const Instant& now) {
  constexpr double kTouching = 0.4;  // fraction of the slop; impacts are at a separation of half
  const double left = (pair.found + pair.after) - now.time;
  return travel(s_.bodies[pair.a], motions_[pair.a], left) +
             travel(s_.bodies[pair.b], motions_[pair.b], left) <=
         kTouching * s_.desc.contact_slop;
}

// Adds the pairs of an affected body that can collide within h. A pair of two affected bodies is
// added once.
void ImpactStage::find_swept_pairs_of(std::uint32_t index, const Instant& now, double h) {
  affected_flags_[index] = Affected::searched;
  swept_body_pairs_.for_each_partner(index, [&](std::uint32_t other) {
    if (affected_flags_[other] == Affected::searched) return;
    if (!overlap(bounds_[index], bounds_[other])) return;
    advance_to(other, now);
    add_swept_pairs_of({std::min(index, other), std::max(index, other)}, h);
  });
}

// Adds the dynamic bodies that touch affected ones.
void ImpactStage::mark_touching_bodies_affected(const Instant& now) {
  const double h = s_.dt - now.time;
  swept_pairs_.clear();
  for (std::size_t k = 0; k < affected_.size(); ++k) {
    const std::uint32_t i = affected_[k];
    if (!s_.bodies[i].is_link) {
      advance_affected(i, now);
      refresh_motion_of(i, h);
      refresh_bounds_of(i, h);
    }
    swept_body_pairs_.find(body_motions(), {&i, 1}, s_.desc.contact_slop, h);
    const std::size_t first = swept_pairs_.size();
    find_swept_pairs_of(i, now, 0.0);
    for (std::size_t p = first; p < swept_pairs_.size(); ++p) {
      const SweptPair& swept = swept_pairs_[p];
      if (swept.sensor || swept.separation > s_.desc.contact_slop) continue;
      for (const std::uint32_t c : {swept.pair.a, swept.pair.b}) {
        if (s_.bodies[s_.colliders[c].body].motion == Motion::dynamic)
          mark_affected(s_.colliders[c].body);
      }
    }
  }
  std::sort(affected_.begin(), affected_.end());
  sort_swept_pairs();
}

// Advances an affected body to the impact, with its free rotation if no swept pair was found for
// it.
void ImpactStage::advance_affected(std::uint32_t index, const Instant& now) {
  if (times_[index] != now.time && !is_still(s_.bodies[index]) && !stopped_[index]) {
    const double h = now.since(std::exchange(times_[index], now.time));
    move_within_step(index, h, !moves_rigidly_[index] && !advanced_[index]);
  }
  times_[index] = now.time;
  moves_rigidly_[index] = advanced_[index] = 0;
}

void ImpactStage::find_swept_pairs_of_affected(const Instant& now) {
  const double h = s_.dt - now.time;
  for (const std::uint32_t i : affected_) {
    if (s_.bodies[i].is_link) continue;
    refresh_motion_of(i, h);
    refresh_bounds_of(i, h);
  }
  refresh_links(h);
  collide_remote(h);
  moved_.assign(affected_.begin(), affected_.end());
  for (const std::uint32_t i : s_.lists.links) {
    if (!s_.bodies[i].remote && affected_flags_[i] == Affected::none) moved_.push_back(i);
  }
  swept_body_pairs_.find(body_motions(), moved_, s_.desc.contact_slop, h);
  for (const std::uint32_t i : affected_) {
    queue_.forget_pairs_of(i);
    affected_flags_[i] = Affected::listed;
  }
  swept_pairs_.clear();
  for (const std::uint32_t i : affected_) find_swept_pairs_of(i, now, h);
  sort_swept_pairs();
}

void ImpactStage::solve_impact(const Instant& previous, const Instant& now) {
  const double h = s_.dt - now.time;
  affected_.clear();
  advance_links(previous, now);
  for (const solve::ContactConstraint& c : discrete_contacts_) {
    mark_affected(c.a);
    mark_affected(c.b);
  }
  for (const std::uint32_t i : rows_.joints()) {
    if (rows_.is_in_sub_steps(s_.joints[i])) continue;
    mark_affected(s_.joints[i].a);
    mark_affected(s_.joints[i].b);
  }
  mark_colliding_bodies_affected(now);
  mark_touching_bodies_affected(now);
  solve_contacts(h, s_.dt, false);
  pair_contacts_.report(contacts_, now.time);
  find_swept_pairs_of_affected(now);
  queue_swept_pairs(now.time, h);
  for (const std::uint32_t i : affected_) affected_flags_[i] = Affected::none;
}

// --- the stage -----------------------------------------------------------------------------------

// Stops the bodies of the swept pairs that would collide within h. A body that stops is in the way
// of others that it would have stayed ahead of, so its pairs are found again.
void ImpactStage::stop_swept_pairs(const Instant& now, double h) {
  std::vector<std::uint32_t>& stopped = affected_;
  stopped.clear();
  const auto stop = [&](std::uint32_t body) {
    if (stopped_[body]) return;
    stop_body(body);
    if (!s_.bodies[body].is_link) return stopped.push_back(body);
    const auto& links = s_.articulations[s_.bodies[body].articulation].bodies;
    std::copy_if(links.begin(), links.end(), std::back_inserter(stopped),
                 [this](std::uint32_t b) { return s_.bodies[b].first_collider != kNone; });
  };
  for (std::size_t pair = 0, searched = 0;; ++searched) {
    for (; pair < swept_pairs_.size(); ++pair) {
      const SweptPair swept = swept_pairs_[pair];
      if (swept.sensor || time_of(swept, h) < 0.0) continue;
      stop(s_.colliders[swept.pair.a].body);
      stop(s_.colliders[swept.pair.b].body);
    }
    if (searched == stopped.size()) break;
    find_swept_pairs_of(stopped[searched], now, h);
  }
  for (const std::uint32_t i : stopped) affected_flags_[i] = Affected::none;
}

// The limit of impacts is reached: bodies that would still collide stop for the rest of the step.
void ImpactStage::stop_colliding_bodies(const Instant& now) {
  s_.status.impact_limit = true;
  const double h = s_.status.time_lost = s_.dt - now.time;
  for (const std::uint32_t i : moving_bodies()) {
    advance_to(i, now);
    advanced_[i] = 0;
  }
  refresh_displacements(h);
  find_swept_pairs(h);
  stop_swept_pairs(now, h);
  take_back_forces(h);
  // Lists the sensors that are reached within the rest of the step.
  queue_.clear(s_.bodies.size());
  std::erase_if(swept_pairs_, [](const SweptPair& p) { return !p.sensor; });
  sort_swept_pairs();
  const auto is_same = [](const SweptPair& p, const SweptPair& q) {
    return p.pair.key == q.pair.key;
  };
  swept_pairs_.erase(std::unique(swept_pairs_.begin(), swept_pairs_.end(), is_same),
                     swept_pairs_.end());
  queue_swept_pairs(now.time, h);
  Instant none;
  (void)next_impact(now, none);
}

void ImpactStage::advance_to_end(const Instant& now) {
  for (const std::uint32_t i : moving_bodies()) {
    const Body& body = s_.bodies[i];
    if (body.is_link || is_still(body) || stopped_[i]) continue;
    const double h = s_.dt - std::exchange(times_[i], s_.dt);
    move_within_step(i, h, !in_contact_[i] && !advanced_[i]);
  }
  advance_articulations(s_.dt - now.time);
}

void ImpactStage::run(double dt) {
  refresh_displacements(dt);
  make_remote();
  find_discrete_pairs(dt);
  find_touching_pairs(dt);
  find_discrete_contacts(dt);
  solve_contacts(dt, dt, true);
  pair_contacts_.remember(contacts_, 1.0);
  pair_contacts_.report(contacts_, 0.0);
  refresh_displacements(dt);
  find_swept_pairs(dt);
  queue_.clear(s_.bodies.size());
  queue_swept_pairs(0.0, dt);
  Instant now;
  for (int solved = 0;; ++solved) {
    Instant next;
    bool collides = next_impact(now, next);
    if (collides && solved >= s_.desc.max_impacts_per_step) {
      stop_colliding_bodies(now);
      collides = false;
    }
    report_reached_sensors();
    if (solved == 0) pair_contacts_.report_ends();
    if (!collides) break;
    ++s_.counters.impacts;
    solve_impact(now, next);
    now = next;
  }
  advance_to_end(now);
  rows_.note_open_joints();
}

}  // namespace vp
