#include "world/restarts.h"

#include <algorithm>

#include "world/step_context.h"

namespace vp {
namespace {

constexpr std::size_t kRestartGrain = 32;  // bodies: some microseconds
// Less than any approach: the next pass over the speculative pairs finds the pair.
constexpr double kNoClearance = -1.0;

// The displacements before of the bodies of a pair that have restarted; null: has not.
struct PairRestart {
  const float *of_a, *of_b;
  bool keeps_clearance;
};

void zero_displacement(const Stores& s, std::uint32_t index) {
  std::fill_n(s.body_states[index + 1].displacement, 6, 0.0f);
  std::fill_n(s.bodies[index].bounded_at, 6, 1e9f);
}

// Whether the clearance of a contact without points goes on, or what is left of it.
bool clearance_goes_on(const Stores& s, const Contact& c, const PairRestart& restarted) {
  if (!restarted.keeps_clearance) return false;
  ContactStore& contacts = s.contact_store;
  const solve::SpeculativePair& pair = contacts.speculative.pair(c.speculative_index);
  const std::uint32_t a = pair.a, b = pair.b;
  // Two that fly past each other use up no clearance.
  if (is_between_spheres(pair) &&
      !s.finder.should_pair(s.colliders[c.a].proxy, s.colliders[c.b].proxy))
    return false;
  bool follows = true;
  if (restarted.of_a) follows = contacts.follow_restart(c, a, restarted.of_a);
  if (restarted.of_b) follows = contacts.follow_restart(c, b, restarted.of_b) && follows;
  return follows || contacts.use_clearance(c, s.body_set);
}

}  // namespace

void restart_displacement(const Stores& s, std::uint32_t index, bool keeps_clearances) {
  float before[6];
  std::copy_n(s.body_states[index + 1].displacement, 6, before);
  zero_displacement(s, index);
  s.start_displacements[index] = {};
  ContactStore& contacts = s.contact_store;
  contacts.for_each_of(s.bodies[index], [&](std::uint32_t i, const Contact& c) {
    if (c.slot.points > 0 || c.sensor || c.of_link || c.parked) return contacts.mark_dirty(i);
    if (c.dirty) return;
    const bool is_a = contacts.speculative.pair(c.speculative_index).a == index + 1;
    const PairRestart restarted{is_a ? before : nullptr, is_a ? nullptr : before, keeps_clearances};
    if (clearance_goes_on(s, c, restarted)) return;
    contacts.reset_speculative(c, s.body_set);
    contacts.mark_dirty(i);
  });
}

void Restarts::reserve(std::size_t bodies) {
  bodies_.reserve(bodies);
  kinds_.resize(bodies, Kind::none);
}

void Restarts::add(std::uint32_t body, bool keeps_clearances) {
  bodies_.push_back(body);
  kinds_[body] = keeps_clearances ? Kind::keeps_clearances : Kind::forgets_them;
}

void Restarts::run(const Stores& s) {
  const auto for_bodies = [&](const auto& f) {
    s.workers.in_parallel(bodies_.size(), kRestartGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) f(bodies_[k]);
    });
  };
  for_bodies([&](std::uint32_t body) { zero_displacement(s, body); });
  for_bodies([&](std::uint32_t body) { restart_contacts_of(s, body); });
  for (const std::uint32_t body : bodies_) {
    s.start_displacements[body] = {};
    kinds_[body] = Kind::none;
  }
  bodies_.clear();
}

// If both bodies of a contact restart, it belongs to the one with the lower number.
void Restarts::restart_contacts_of(const Stores& s, std::uint32_t body) const {
  ContactStore& contacts = s.contact_store;
  contacts.prefetch_speculative(s.bodies[body]);
  contacts.for_each_of(s.bodies[body], [&](std::uint32_t, Contact& c) {
    const ContactStore::States states = contacts.states_of(c);
    const auto displacement_of = [&](std::uint32_t state) {
      const bool restarts = state != solve::kWorldState && kinds_[state - 1] != Kind::none;
      return restarts ? s.start_displacements[state - 1].displacement : nullptr;
    };
    const auto forgets = [&](std::uint32_t state) {
      return state != solve::kWorldState && kinds_[state - 1] == Kind::forgets_them;
    };
    const std::uint32_t own = body + 1, other = states.a == own ? states.b : states.a;
    if (other < own && displacement_of(other)) return;
    if (c.sensor || c.of_link || c.parked) {
      (c.is_part() ? contacts[c.aggregate] : c).dirty = true;
    } else if (c.slot.points > 0) {
      contacts.mark_moved(c);
    } else if (!c.dirty && !clearance_goes_on(s, c,
                                              {displacement_of(states.a), displacement_of(states.b),
                                               !forgets(states.a) && !forgets(states.b)})) {
      contacts.set_clearance(c, {kNoClearance}, s.body_set);
    }
  });
}

}  // namespace vp
