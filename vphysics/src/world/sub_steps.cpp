// The sub-stepped solver: soft contacts, one colour after the other (solve/contact_passes.h).
#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>
#include <utility>

#include "solve/contact_slot.h"
#include "world/impl.h"

namespace vp {
namespace {

// Fraction of the accumulated impulse that a sub-step discards before it solves again. It damps the
// effect of warm starting on loads that have not converged: without it a wall of 47 bodies never
// comes to rest. Together with kUseBias, a load L, in impulse per sub-step, sinks by
//   h (kImpulseDecay / kUseBias) L / m:  0.07 mm under ten boxes at 1 ms.
constexpr double kImpulseDecay = 0.07;
// Rate at which the sub-step length of the bias velocity (last_step_length) follows the actual one
// when that becomes shorter [s/s].
constexpr double kBiasStepRate = 0.02;
// Iterations with bias velocity in one sub-step.
constexpr int kIterations = 3;
// Max searches for contacts in one sub-step: what a found contact throws may meet another body.
constexpr int kMaxSearches = 8;
// Max restitution passes in one sub-step: an impact may have to propagate through as many contacts
// against the order of the colours.
constexpr int kMaxRestitutionPasses = 64;

// Warm-start impulses come from earlier sub-steps. Those of a load are proportional to the sub-step
// length. They are only ever reduced: the impulse of an impact must not return larger.
void rescale_impulses(solve::ContactGraph& graph, Joints& joints, double ratio) {
  const auto factor = static_cast<float>(ratio);
  const auto rescale = [factor](auto& blocks) {
    for (auto& block : blocks) solve::rescale_impulses(block, factor);
  };
  for (std::size_t region = 0; region < graph.regions(); ++region) {
    for (int colour = 0; colour <= solve::kParked; ++colour) {
      rescale(graph.of<1>(region, colour).blocks);
      rescale(graph.of<4>(region, colour).blocks);
    }
  }
  for (BodyJoint& joint : joints) {
    if (joint.in_rows) continue;
    for (double& impulse : joint.impulse) impulse *= ratio;
    for (double& impulse : joint.stop) impulse *= ratio;
  }
}

// Operations of a sub-step on the bodies and contacts of one region. Several workers share the
// region kSharedRegion; one worker does each of the others.
struct SubStepContext {
  ContactRuns contacts;
  const Regions& regions;
  const Precession& precession;
  const Workers& workers;
  std::span<solve::BodyState> states;
  std::span<const solve::StartDisplacement> start_displacements;  // of each body
  std::span<solve::VelocityChange> velocity_changes;  // of each body, by the contacts of a sub-step
  std::span<solve::BounceShift> bounce_shifts;        // of each state; empty if none bounces
  float restitution_threshold;
};

class SubSteps {
 public:
  SubSteps(const SubStepContext& context, float h, const solve::Soft& soft)
      : context_(context), blocks_(context.contacts.number()), h_(h), soft_(soft) {}

  // After contact slots have been added or removed.
  void number_contacts() { blocks_ = context_.contacts.number(); }

  void load_inertias(std::size_t region) const {
    context_.contacts.for_parts_of(
        region, [](const auto& p, const auto& part, std::size_t) { p.load_inertias(part); });
  }
  void accelerate(std::size_t region, bool find_velocity_changes) const {
    for_moving_bodies(region, [&](const std::uint32_t* some, std::size_t count) {
      if (find_velocity_changes)
        pass_.find_velocity_changes(states(), context_.velocity_changes.data(), some, count);
      pass_.accelerate(states(), some, count, h_);
    });
  }
  // Repeats until nothing bounces. Returns the number of passes in which something did:
  // kMaxRestitutionPasses if something still does.
  int apply_restitution() const {
    std::uint32_t* const words = context_.contacts.words();
    for (int iteration = 0; iteration < kMaxRestitutionPasses; ++iteration) {
      std::fill_n(words, blocks_, 0u);
      context_.contacts.everywhere([&](std::size_t region) { apply_restitution(region); });
      if (std::find(words, words + blocks_, 1u) == words + blocks_) return iteration;
    }
    return kMaxRestitutionPasses;
  }
  // Calls f with what bounces on its side of what it has hit. bounced: something has a shift.
  template <class F>
  auto without_shifts(bool bounced, const F& f) const {
    if (bounced) shift_bounced(-1.0f);
    const auto result = f();
    if (bounced) shift_bounced(1.0f);
    return result;
  }
  // Calls f(body) for each body that a bounce has shifted, and forgets the shifts.
  template <class F>
  void take_bounced(const F& f) const {
    for (std::size_t i = 0; i < context_.bounce_shifts.size(); ++i) {
      float(&shift)[8] = context_.bounce_shifts[i].displacement;
      if (std::all_of(shift, shift + 6, [](float x) { return x == 0.0f; })) continue;
      if (i > 0) f(static_cast<std::uint32_t>(i - 1));
      std::fill_n(shift, 8, 0.0f);
    }
  }
  void keep_velocities(std::size_t region) const {
    for_moving_bodies(region, [&](const std::uint32_t* some, std::size_t count) {
      pass_.keep(states(), context_.velocity_changes.data(), some, count);
    });
  }
  void repeat_velocity_changes(std::size_t region) const {
    for_moving_bodies(region, [&](const std::uint32_t* some, std::size_t count) {
      pass_.repeat(states(), context_.velocity_changes.data(), some, count);
    });
  }
  void warm_start(std::size_t region) const {
    context_.contacts.for_parts_of(
        region, [](const auto& p, const auto& part, std::size_t) { p.warm_start(part); });
  }
  void solve_contacts(std::size_t region, int iteration) const {
    context_.contacts.for_parts_of(region, [&](const auto& p, const auto& part, std::size_t) {
      (iteration == 0 ? p.solve_first : p.solve_again)(part, soft_);
    });
  }
  void move(std::size_t region) const {
    for_moving_bodies(region, [&](const std::uint32_t* some, std::size_t count) {
      pass_.move(states(), some, count, h_);
    });
    context_.precession.rotate(region, context_.states, context_.start_displacements,
                               context_.velocity_changes, h_);
  }
  // last: the last sub-step of the step. Contact changes are found before the relaxation: an
  // impulse that separates overlapping bodies is a load, although it leaves nothing in the
  // velocities.
  void relax(std::size_t region, bool last) {
    if (last) {
      context_.contacts.for_parts_of(
          region, [&](const auto& p, const auto& part, std::size_t first) {
            p.find_changes(part, soft_.keeps_load, context_.contacts.words() + first);
          });
    }
    solve::Soft soft = soft_;
    soft.last = last;
    context_.contacts.for_parts_of(region, [&](const auto& p, const auto& part, std::size_t) {
      if (p.relax(part, soft)) some_too_deep_.store(true, std::memory_order_relaxed);
    });
  }
  bool has_deep_contacts() const { return some_too_deep_; }
  // Call it after the first sub-step: from then on the recorded impulses accumulate.
  void accumulate_impulses() { soft_.keeps_load = 1.0f; }

 private:
  // Sets the word of each block in which something bounces to 1.
  void apply_restitution(std::size_t region) const {
    context_.contacts.for_parts_of(region, [&](const auto& p, const auto& part, std::size_t first) {
      context_.contacts.words()[first] =
          p.apply_restitution(part, h_, context_.restitution_threshold,
                              context_.bounce_shifts.data())
              ? 1u
              : 0u;
    });
  }
  // Moves all states by these fractions of their shifts.
  void shift_bounced(float fraction) const {
    for (std::size_t i = 0; i < context_.states.size(); ++i) {
      const float* const shift = context_.bounce_shifts[i].displacement;
      for (int k = 0; k < 6; ++k) context_.states[i].displacement[k] += fraction * shift[k];
    }
  }
  solve::BodyState* states() const { return context_.states.data(); }
  template <class F>
  void for_moving_bodies(std::size_t region, const F& f) const {
    const std::span<const std::uint32_t> some = context_.regions.awake_bodies_of(region);
    if (region != solve::kSharedRegion) return f(some.data(), some.size());
    context_.workers.in_parallel(some.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
      f(some.data() + begin, end - begin);
    });
  }

  const SubStepContext context_;
  std::size_t blocks_;
  const float h_;
  solve::Soft soft_;
  std::atomic<bool> some_too_deep_ = false;  // contacts are too deep at the end of the sub-steps
  const solve::Passes& pass_ = solve::passes();
};

}  // namespace

// Errors grow with the square of the sub-step, so longer steps have more sub-steps: 2 at 1 kHz, 5
// at 240 Hz, 9 at 60 Hz. Small bodies fall by their own size sooner, by the square root of it.
int sub_steps_in(const WorldDesc& desc, double speed_unit, double dt) {
  if (desc.sub_steps > 0) return desc.sub_steps;
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(dt / (0.00026 * speed_unit)))));
}

void World::Impl::run_sub_steps(double dt) {
  const int n = sub_steps_in(desc, speed_unit, dt);
  sub_steps_taken = n;
  if (!lists.some_sub_stepped && link_contacts.empty()) return;
  take_sub_steps(dt, n);
  const auto stage = in(Stage::report);
  report_changes();
}

void World::Impl::take_sub_steps(double dt, int n) {
  const auto stage = in(Stage::sub_steps);
  counters.sub_steps = static_cast<std::uint32_t>(n);
  const BodyStates state_of_step = context.states_in(dt);
  for (const std::uint32_t i : sub_step.accelerating) state_of_step.start_acceleration(i);
  const float h = static_cast<float>(dt / n);
  SubStepState& state = sub_step_state;
  const double before = std::exchange(state.length, h);
  if (before > h) rescale_impulses(contact_store.graph, joints, h / before);
  // Shorter sub-steps must not abruptly correct a penetration from longer ones: the bias velocity
  // approaches that of the shorter ones gradually.
  state.last_step_length =
      std::max(static_cast<double>(h), state.last_step_length - kBiasStepRate * dt);
  const double fastest =
      std::clamp(kUseBias / state.last_step_length * kSmallDepth * desc.length_unit,
                 kMaxBiasVelocity * speed_unit, kMaxCorrectionSpeed * speed_unit);
  const ContactRuns runs = contact_runs();
  sub_step.precession.list(bodies, regions, contact_store.graph.regions());
  SubSteps steps({runs, regions, sub_step.precession, workers, body_states,
                  sub_step.start_displacements, sub_step.velocity_changes, sub_step.bounce_shifts,
                  static_cast<float>(desc.restitution_threshold)},
                 h,
                 {.rate = static_cast<float>(kUseBias / state.last_step_length),
                  .fraction = static_cast<float>(1.0 - kImpulseDecay),
                  .max_bias_velocity = static_cast<float>(fastest),
                  .inverse_h = 1.0f / h,
                  .keeps_load = 0.0f,
                  .fastest_shift = static_cast<float>(kMaxCorrectionSpeed * speed_unit),
                  .h = h,
                  .idle_speed = static_cast<float>(speed_unit)});
  JointSteps joint_steps({bodies, joints, contact_store.graph.regions(), body_states,
                          sub_step.start_displacements, workers, sub_step.precession, speed_unit},
                         sub_step.joints, h);
  const bool links = !link_contacts.empty();
  if (links) link_contacts.begin_sub_steps(dt, n);
  // The next sub-step applies the velocity changes by the contacts of the last one again, body by
  // body. Not if joints or links take part, which rotate within the step.
  const bool repeats = !links && joint_steps.empty() && n > 1;
  // All regions take turns in each iteration if links or joints connect them.
  const bool takes_turns = links || joint_steps.connect_regions();
  runs.everywhere([&](std::size_t region) {
    steps.load_inertias(region);
    joint_steps.begin(region);
  });
  for (int k = 0; k < n; ++k) {
    const bool last = k == n - 1;
    runs.everywhere([&](std::size_t region) { steps.accelerate(region, repeats && k > 0); });
    bool warm_starts = k == 0 || !repeats, some_bounced = false;
    for (int search = 0; search < kMaxSearches; ++search) {
      const int bounces = steps.apply_restitution();
      counters.restitution_iterations += static_cast<std::uint32_t>(bounces);
      status.bounce_limit |= bounces == kMaxRestitutionPasses;
      // The velocities of the first sub-step are those of the search, unless something bounces.
      if (bounces == 0 && (k == 0 || search > 0)) break;
      some_bounced |= bounces > 0;
      const SearchedAgain changed = steps.without_shifts(some_bounced, [&] {
        return find_contacts_within_step(static_cast<double>(h) * (n - k));
      });
      if (!changed.has_new_slots) break;
      steps.number_contacts();
      if (changed.has_woken)
        runs.everywhere([&](std::size_t region) { steps.load_inertias(region); });
      warm_starts |= changed.has_old_slots;
    }
    if (some_bounced)
      steps.take_bounced([&](std::uint32_t i) { state_of_step.note_bounce(bodies[i], i); });
    if (links) link_contacts.begin_sub_step(dt / n);
    runs.everywhere([&](std::size_t region) { joint_steps.warm_start(region); });
    if (repeats) {
      runs.everywhere([&](std::size_t region) {
        warm_starts ? steps.keep_velocities(region) : steps.repeat_velocity_changes(region);
      });
    }
    if (warm_starts) runs.everywhere([&](std::size_t region) { steps.warm_start(region); });
    if (takes_turns) {
      for (int iteration = 0; iteration < kIterations; ++iteration) {
        runs.everywhere([&](std::size_t region) { joint_steps.solve(region, iteration); });
        runs.everywhere([&](std::size_t region) { steps.solve_contacts(region, iteration); });
        if (links) link_contacts.iterate(dt / n);
      }
      if (links) link_contacts.move(dt / n);
      runs.everywhere([&](std::size_t region) { steps.move(region); });
      runs.everywhere([&](std::size_t region) { joint_steps.prepare_and_relax(region); });
      runs.everywhere([&](std::size_t region) { steps.relax(region, last); });
      if (links) link_contacts.relax(dt / n);
    } else {
      // All consecutive operations on one region are done at once, so that its contacts and joints
      // are read from memory once, except by the restitution pass and the warm start.
      const auto iterate = [&](std::size_t region) {
        for (int iteration = 0; iteration < kIterations; ++iteration) {
          joint_steps.solve(region, iteration);
          steps.solve_contacts(region, iteration);
        }
      };
      const auto move_and_relax = [&](std::size_t region) {
        steps.move(region);
        joint_steps.prepare_and_relax(region);
        steps.relax(region, last);
      };
      iterate(solve::kSharedRegion);
      runs.for_regions([&](std::size_t region) {
        iterate(region);
        move_and_relax(region);
      });
      move_and_relax(solve::kSharedRegion);
    }
    steps.accumulate_impulses();
  }
  runs.everywhere([&](std::size_t region) { joint_steps.end(region, dt); });
  if (steps.has_deep_contacts() || joint_steps.some_are_far_open()) position_error_now = true;
}

}  // namespace vp
