#include "hands.h"

#include <cmath>
#include <limits>
#include <utility>

namespace cabinet_bench {
namespace {

// A swing: the rod is pulled to its near stop, its men rotate slowly past their mark and back, and
// the rod is pushed to the other stop, which ends a ceremony. In doubles, one hand holds each rod.
struct KeyPose {
  double seconds;
  double reach;  // fraction of the travel, towards the near stop
  double angle;  // [rad]
};
constexpr double kGiveBack = 0.5;  // [s] from there to the players' targets
constexpr double kAside = 1.4;     // [rad]: beyond a mark and half its width
constexpr KeyPose kSwing[] = {
    {0.3, 0, 0}, {0.7, 1, -kAside}, {1.7, 1, kAside}, {2.7, 1, -kAside}, {3.1, -1, 0}};

foosball::RodTarget swing_target(double seconds, const Pose& from, double near_stop) {
  const double turns = std::round(from.angle / (2 * M_PI)) * 2 * M_PI;
  Pose before = from;
  double began = 0;
  for (const KeyPose& key : kSwing) {
    const Pose to = &key == kSwing ? from : Pose{key.reach * near_stop, turns + key.angle};
    if (seconds < key.seconds) {
      const double span = key.seconds - began, t = (seconds - began) / span;
      const double ease = t * t * (3 - 2 * t), rate = 6 * t * (1 - t) / span;
      return {std::lerp(before.slide, to.slide, ease), std::lerp(before.angle, to.angle, ease),
              rate * (to.slide - before.slide), rate * (to.angle - before.angle), true};
    }
    before = to;
    began = key.seconds;
  }
  return {before.slide, before.angle, 0, 0, true};
}

}  // namespace

foosball::RodState step_rod(const foosball::MatchView& view, std::size_t rod,
                            const foosball::RodState& now, const foosball::RodTarget& target) {
  const foosball::TableSpec& table = foosball::table_spec(kLayout);
  const foosball::RodSpec& spec = table.rods[rod];
  const auto& body = view.bodies[static_cast<std::size_t>(spec.team)];
  return foosball::step_rod(spec, foosball::rod_inertia(table, spec, body, view.tuning), now,
                            target);
}

Hands::Hands(const MatchOptions& options, const PerRod<Pose>& begin)
    : swings_(options.swings), swing_seconds_(std::numeric_limits<double>::infinity()) {
  for (int team = 0; team < foosball::kTeams; ++team) {
    foosball::ComputerPlayerDesc desc;
    desc.team = team;
    desc.seed = options.seed + static_cast<std::uint64_t>(team);
    desc.player.level = options.level;
    players_.emplace_back(desc);
  }
  for (std::size_t rod = 0; rod < begin.size(); ++rod) {
    rods_[rod] = {begin[rod].slide, begin[rod].angle, 0, 0};
    targets_[rod] = {begin[rod].slide, begin[rod].angle, 0, 0, true};
  }
}

PerRod<Pose> Hands::move(const foosball::MatchView& view) {
  for (foosball::ComputerPlayer& player : players_) player.play(view, targets_);
  begin_swing(view);
  PerRod<Pose> poses;
  for (std::size_t rod = 0; rod < poses.size(); ++rod) {
    rods_[rod] = step_rod(view, rod, rods_[rod], target(rod));
    poses[rod] = {rods_[rod].slide, rods_[rod].angle};
  }
  swing_seconds_ += foosball::kTick;
  return poses;
}

// Before the match, and after a goal.
void Hands::begin_swing(const foosball::MatchView& view) {
  const auto before = std::exchange(screen_, view.screen);
  const bool calm = !before || (before != view.screen && view.screen == foosball::Screen::ceremony);
  if (!swings_ || !calm) return;
  swing_seconds_ = 0;
  for (std::size_t rod = 0; rod < swing_from_.size(); ++rod) {
    swing_from_[rod] = {rods_[rod].slide, rods_[rod].angle};
  }
}

foosball::RodTarget Hands::target(std::size_t rod) {
  const double after = (swing_seconds_ - std::end(kSwing)[-1].seconds) / kGiveBack;
  const foosball::RodTarget& wanted = targets_[rod];
  if (after >= 1) return wanted;
  foosball::RodTarget swing = swing_target(swing_seconds_, swing_from_[rod], Table::near_stop(rod));
  if (after > 0) {
    const double ease = after * after * (3 - 2 * after);
    swing.slide = std::lerp(swing.slide, wanted.slide, ease);
    swing.angle = std::lerp(swing.angle, wanted.angle, ease);
  }
  return swing;
}

}  // namespace cabinet_bench
