// The sub-stepped solver: soft contacts, colour after colour (solve/contact_passes.h).
#include <algorithm>
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
// 1 kHz, 5 at 240 Hz, 9 at 60 Hz.
int World::Impl::sub_steps_in(double dt) const {
  if (desc.sub_steps > 0) return desc.sub_steps;
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(dt / 0.00026))));
}

// Of all colours; a word of lane_bits for each.
std::size_t World::Impl::blocks_in_use() {
  std::size_t count = 0;
  for_runs([&](const auto&, const auto&, const auto& blocks) { count += blocks.size(); });
  lane_bits.resize(std::max(lane_bits.size(), count));
  return count;
}

void World::Impl::run_sub_steps(double dt) {
  const int n = sub_steps_in(dt);
  sub_steps_taken = n;
  if (!some_are_not) return;
  take_sub_steps(dt, n);
  const auto stage = in(Stage::report);
  end_joints(dt);
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
  for (int colour = 0; colour <= solve::kParked; ++colour) {
    rescale(graph.of<1>(colour).blocks);
    rescale(graph.of<4>(colour).blocks);
  }
  for (BodyJoint& joint : joints) {
    for (solve::JointRow6& row : joint.block.rows) {
      row.impulse *= h / before;
      row.stop *= h / before;
    }
  }
}

void World::Impl::take_sub_steps(double dt, int n) {
  const auto stage = in(Stage::sub_steps);
  counters.sub_steps = static_cast<std::uint32_t>(n);
  const float h = static_cast<float>(dt / n);
  const solve::Passes& pass = solve::passes();
  rescale_impulses(h);
  // What has sunk in longer sub-steps is not thrown out by shorter ones: the push becomes as fast
  // as theirs by and by.
  push_length = std::max(static_cast<double>(h), push_length - kHurry * dt);
  solve::Soft soft{static_cast<float>(kPush / push_length),
                   static_cast<float>(1.0 - kLoss),
                   static_cast<float>(kLoss),
                   static_cast<float>(kFastestPush),
                   1.0f / h,
                   0.0f};
  const auto threshold = static_cast<float>(desc.restitution_threshold);
  begin_joints(h);
  const bool links = !bodies_on_links.empty();
  if (links) find_link_contacts(dt, n);
  // What contacts gave in one sub-step is given again in the next as a whole, by body, unless
  // joints and links have a share in it: these turn within the step.
  const bool repeats = n > 1 && !links && active_joints.empty();
  const auto for_movers = [&](const auto& f) {
    in_parallel(movers.size(), kBodyGrain,
                [&](std::size_t begin, std::size_t end) { f(movers.data() + begin, end - begin); });
  };
  for (int k = 0; k < n; ++k) {
    for_movers([&](const std::uint32_t* some, std::size_t count) {
      if (repeats && k > 0) pass.find_gains(body_rows.data(), gains.data(), some, count);
      pass.accelerate(body_rows.data(), some, count, h);
    });
    for (int round = 0;; ++round) {
      if (round == kStrikes) {
        status.bounce_limit = true;
        break;
      }
      const std::size_t blocks = blocks_in_use();
      std::fill_n(lane_bits.begin(), blocks, 0u);
      for_parts([&](const auto& p, const auto& part, std::size_t first) {
        lane_bits[first] = p.strike(part, h, threshold) ? 1u : 0u;
      });
      const bool again = std::find(lane_bits.begin(), lane_bits.begin() + blocks, 1u) !=
                         lane_bits.begin() + blocks;
      if (!again) break;
      ++counters.bounce_rounds;
    }
    if (links) begin_links(h);
    warm_start_joints();
    if (repeats) {
      for_movers([&](const std::uint32_t* some, std::size_t count) {
        (k == 0 ? pass.keep : pass.repeat)(body_rows.data(), gains.data(), some, count);
      });
    }
    if (k == 0 || !repeats) {
      for_parts([](const auto& p, const auto& part, std::size_t) { p.warm_start(part); });
    }
    for (int round = 0; round < kRounds; ++round) {
      solve_joints(h, round);
      for_parts([&](const auto& p, const auto& part, std::size_t) {
        (round == 0 ? p.solve_first : p.solve_again)(part, soft);
      });
      if (links) solve_links(h);
    }
    if (links) move_links(h);
    for_movers([&](const std::uint32_t* some, std::size_t count) {
      pass.move(body_rows.data(), some, count, h);
    });
    refresh_joints(h);
    relax_joints(h);
    if (k == n - 1) find_news();
    for_parts([&](const auto& p, const auto& part, std::size_t) { p.relax(part, soft); });
    soft.kept = 1.0f;
    if (links) relax_links(h);
  }
}

}  // namespace vp
