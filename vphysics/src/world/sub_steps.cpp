// The sub-stepped solver: soft contacts, colour after colour (solve/contact_passes.h).
#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "solve/contact_lane.h"
#include "world/impl.h"
#include "world/runs.h"

namespace vp {
namespace {

// Share of an accumulated impulse that a sub-step lets go before it is solved for again. It damps
// what warm starting does to loads that have not settled: without it a wall of 47 bodies never
// comes to rest. With kPush it leaves a load L, in impulses of a sub-step, to sink by  h (kLoss /
// kPush) L / m:  0.07 mm under ten boxes at 1 ms.
constexpr double kLoss = 0.07;
// How fast the length of sub-steps that the push is made for follows theirs when they become
// shorter.
constexpr double kHurry = 0.02;
// Passes of pushing in one sub-step.
constexpr int kRounds = 3;
// Rounds of bounces in one sub-step: an impact may run through as many contacts against the order
// of the colours.
constexpr int kStrikes = 64;

}  // namespace

// Errors grow with the square of the sub-step, so longer steps have shorter shares: 2 sub-steps at
// 1 kHz, 5 at 240 Hz, 9 at 60 Hz. What is smaller falls by its own size sooner, by the root.
int World::Impl::sub_steps_in(double dt) const {
  if (desc.sub_steps > 0) return desc.sub_steps;
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(dt / (0.00026 * speed_unit)))));
}

// Of all regions and colours; a word of lane_bits for each. Returns how many.
std::size_t World::Impl::number_blocks() {
  first_block.resize(graph.regions());
  std::size_t count = 0;
  const auto number = [&](std::size_t region) {
    first_block[region] = count;
    for_runs_of(region, [&](const auto&, const auto&, const auto& b) { count += b.size(); });
  };
  for (std::size_t region = 1; region <= region_count; ++region) number(region);
  number(solve::kBetween);
  lane_bits.resize(std::max(lane_bits.size(), count));
  return count;
}

void World::Impl::run_sub_steps(double dt) {
  const int n = sub_steps_in(dt);
  sub_steps_taken = n;
  if (!some_are_not) {
    position_error_before = false;
    return;
  }
  take_sub_steps(dt, n);
  const auto stage = in(Stage::report);
  report_news();
}

// Impulses to start from are of sub-steps before: a load's are as long as these. Only ever shorter:
// a blow must not come back larger.
void World::Impl::rescale_impulses(double h) {
  const double before = std::exchange(sub_step_before, h);
  if (before <= h) return;
  const auto factor = static_cast<float>(h / before);
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
    for (BodyJointRow& row : joint.rows) {
      row.impulse *= h / before;
      row.stop *= h / before;
    }
  }
}

// What is done in a sub-step to one region's bodies and contacts. Those of kBetween are gone
// through by several workers, others by one.
class World::Impl::SubSteps {
 public:
  SubSteps(World::Impl& world, float h, const solve::Soft& soft)
      : world_(world),
        h_(h),
        threshold_(static_cast<float>(world.desc.restitution_threshold)),
        soft_(soft) {}

  void load_inertias(std::size_t region) const {
    world_.for_parts_of(
        region, [](const auto& p, const auto& part, std::size_t) { p.load_inertias(part); });
  }
  void accelerate(std::size_t region, bool find_gains) const {
    for_movers(region, [&](const std::uint32_t* some, std::size_t count) {
      if (find_gains) pass_.find_gains(rows(), world_.gains.data(), some, count);
      pass_.accelerate(rows(), some, count, h_);
    });
  }
  // Of blocks in which something bounces, lane_bits becomes 1.
  void strike(std::size_t region) const {
    world_.for_parts_of(region, [&](const auto& p, const auto& part, std::size_t first) {
      world_.lane_bits[first] = p.strike(part, h_, threshold_) ? 1u : 0u;
    });
  }
  void keep_velocities(std::size_t region) const {
    for_movers(region, [&](const std::uint32_t* some, std::size_t count) {
      pass_.keep(rows(), world_.gains.data(), some, count);
    });
  }
  void repeat_gains(std::size_t region) const {
    for_movers(region, [&](const std::uint32_t* some, std::size_t count) {
      pass_.repeat(rows(), world_.gains.data(), some, count);
    });
  }
  void warm_start(std::size_t region) const {
    world_.for_parts_of(region,
                        [](const auto& p, const auto& part, std::size_t) { p.warm_start(part); });
  }
  void push(std::size_t region, int round) const {
    world_.for_parts_of(region, [&](const auto& p, const auto& part, std::size_t) {
      (round == 0 ? p.solve_first : p.solve_again)(part, soft_);
    });
  }
  void move(std::size_t region) const {
    for_movers(region, [&](const std::uint32_t* some, std::size_t count) {
      pass_.move(rows(), some, count, h_);
    });
  }
  // last: of the step. What is worth telling is found before: what pushes two apart that overlap is
  // a load, though nothing of it is left in the velocities.
  void relax(std::size_t region, bool last) const {
    if (last) {
      world_.for_parts_of(region, [&](const auto& p, const auto& part, std::size_t first) {
        p.find_news(part, world_.lane_bits.data() + first);
      });
    }
    solve::Soft soft = soft_;
    soft.last = last;
    world_.for_parts_of(region, [&](const auto& p, const auto& part, std::size_t) {
      if (p.relax(part, soft)) world_.some_are_too_deep.store(true, std::memory_order_relaxed);
    });
  }
  void move_and_relax(std::size_t region, bool last) const {
    move(region);
    relax(region, last);
  }
  // The first sub-step's impulses have been noted.
  void go_on() { soft_.kept = 1.0f; }

 private:
  solve::BodyRow* rows() const { return world_.body_rows.data(); }
  template <class F>
  void for_movers(std::size_t region, const F& f) const {
    const std::uint32_t first = world_.first_of_region[region];
    const std::uint32_t count = world_.first_of_region[region + 1] - first;
    const std::uint32_t* some = world_.movers_by_region.data() + first;
    if (region != solve::kBetween) return f(some, std::size_t{count});
    world_.in_parallel(count, kBodyGrain,
                       [&](std::size_t begin, std::size_t end) { f(some + begin, end - begin); });
  }

  World::Impl& world_;
  float h_, threshold_;
  solve::Soft soft_;
  const solve::Passes& pass_ = solve::passes();
};

void World::Impl::take_sub_steps(double dt, int n) {
  const auto stage = in(Stage::sub_steps);
  counters.sub_steps = static_cast<std::uint32_t>(n);
  const float h = static_cast<float>(dt / n);
  rescale_impulses(h);
  // What has sunk in longer sub-steps is not thrown out by shorter ones: the push becomes as fast
  // as theirs by and by.
  push_length = std::max(static_cast<double>(h), push_length - kHurry * dt);
  const double fastest = std::clamp(kPush / push_length * kSmallDepth * desc.length_unit,
                                    kFastestPush * speed_unit, kFastestShift * speed_unit);
  SubSteps steps(*this, h,
                 {.rate = static_cast<float>(kPush / push_length),
                  .share = static_cast<float>(1.0 - kLoss),
                  .fastest_push = static_cast<float>(fastest),
                  .inverse_h = 1.0f / h,
                  .kept = 0.0f,
                  .fastest_shift = static_cast<float>(kFastestShift * speed_unit),
                  .h = h,
                  .reach = static_cast<float>(speed_unit)});
  begin_joints(h);
  const bool links = !bodies_on_links.empty();
  if (links) find_link_contacts(dt, n);
  const bool contacts_alone = !links && active_joints.empty();
  // What contacts gave in one sub-step is given again in the next as a whole, by body, unless
  // joints and links have a share in it: these turn within the step.
  const bool repeats = contacts_alone && n > 1;
  const std::size_t blocks = number_blocks();
  everywhere([&](std::size_t region) { steps.load_inertias(region); });
  for (int k = 0; k < n; ++k) {
    const bool last = k == n - 1;
    everywhere([&](std::size_t region) { steps.accelerate(region, repeats && k > 0); });
    strike(steps, blocks);
    if (links) begin_links(h);
    warm_start_joints();
    if (repeats) {
      everywhere([&](std::size_t region) {
        k == 0 ? steps.keep_velocities(region) : steps.repeat_gains(region);
      });
    }
    if (k == 0 || !repeats) everywhere([&](std::size_t region) { steps.warm_start(region); });
    if (contacts_alone) {
      // All that comes one after another for a region alone is done at once, so that its contacts
      // are read from memory once, but for what strikes and the first warm start look at.
      for (int round = 0; round < kRounds; ++round) steps.push(solve::kBetween, round);
      for_regions([&](std::size_t region) {
        for (int round = 0; round < kRounds; ++round) steps.push(region, round);
        steps.move_and_relax(region, last);
      });
      steps.move_and_relax(solve::kBetween, last);
    } else {
      for (int round = 0; round < kRounds; ++round) {
        solve_joints(h, round);
        everywhere([&](std::size_t region) { steps.push(region, round); });
        if (links) solve_links(h);
      }
      if (links) move_links(h);
      everywhere([&](std::size_t region) { steps.move(region); });
      prepare_joints();
      relax_joints(h);
      everywhere([&](std::size_t region) { steps.relax(region, last); });
      if (links) relax_links(h);
    }
    steps.go_on();
  }
  end_joints(dt);
  note_position_errors();
}

// What is pushed out within a step of its beginning is no trouble.
void World::Impl::note_position_errors() {
  const bool now = some_are_too_deep.exchange(false) || some_are_far_open;
  status.position_error = now && position_error_before;
  position_error_before = now;
}

// Until nothing bounces any more.
void World::Impl::strike(const SubSteps& steps, std::size_t blocks) {
  const auto end = lane_bits.begin() + static_cast<std::ptrdiff_t>(blocks);
  for (int round = 0;; ++round) {
    if (round == kStrikes) {
      status.bounce_limit = true;
      return;
    }
    std::fill(lane_bits.begin(), end, 0u);
    everywhere([&](std::size_t region) { steps.strike(region); });
    if (std::find(lane_bits.begin(), end, 1u) == end) return;
    ++counters.bounce_rounds;
  }
}

}  // namespace vp
