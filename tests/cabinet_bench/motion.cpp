#include "motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace cabinet_bench {
namespace {

constexpr int kSetUpMs = 3000, kRestMs = 300;

void pass(Controller& controller, Table& table, const PerRod<Pose>& poses,
          std::vector<std::uint8_t>& recording) {
  table.move(poses);
  table.pass(controller);
  for (const Packet& packet : controller.take_packets()) {
    recording.insert(recording.end(), packet.bytes.begin(), packet.bytes.end());
  }
}

}  // namespace

std::optional<Motion> motion_of(const std::string& text) {
  int rod = 0, read = 0;
  Motion motion;
  double mm = 0;
  if (std::sscanf(text.c_str(), "%d:%lf:%lf%n", &rod, &mm, &motion.turns, &read) != 3 ||
      static_cast<std::size_t>(read) != text.size() || rod < 1 || rod > cabinet::kRods ||
      !(std::abs(mm) <= 1000) || !(std::abs(motion.turns) <= 100)) {
    return std::nullopt;
  }
  motion.rod = static_cast<std::size_t>(rod - 1);
  motion.slide = 1e-3 * mm;
  return motion;
}

std::vector<std::uint8_t> record_motions(Controller& controller, Table& table,
                                         const std::vector<Motion>& motions) {
  std::vector<std::uint8_t> recording;
  for (int ms = 0; ms < kSetUpMs; ++ms) pass(controller, table, table.poses(), recording);
  recording.clear();
  for (const Motion& motion : motions) {
    const PerRod<Pose> from = table.poses();
    const int ms = 1000 + static_cast<int>(400 * std::abs(motion.turns));
    for (int i = 1; i <= ms + kRestMs; ++i) {
      const double t = std::min(1.0, static_cast<double>(i) / ms), ease = t * t * (3 - 2 * t);
      PerRod<Pose> to = from;
      to[motion.rod].slide += ease * motion.slide;
      to[motion.rod].angle += ease * motion.turns * 2 * M_PI;
      pass(controller, table, to, recording);
    }
  }
  return recording;
}

}  // namespace cabinet_bench
