#include "hand_watch.h"

#include <algorithm>
#include <cmath>

#include "foosball/rod_motion.h"

namespace server {
namespace {

template <class Time>
std::int64_t newest(const auto& source, std::uint8_t rods, Time time) {
  std::int64_t newest = 0;
  for (int rod = 0; rod < cabinet::kRods; ++rod)
    if ((rods >> rod & 1) != 0) newest = std::max(newest, source[rod].*time);
  return newest;
}

}  // namespace

void HandWatch::restart(std::size_t source, std::int64_t now_us, std::int64_t play_us) {
  for (Rod& rod : sources_[source]) {
    rod.live_us = now_us;
    rod.moved_us = play_us;
  }
}

void HandWatch::look(std::size_t source, const cabinet::RodInputs& rods, std::int64_t now_us,
                     std::int64_t play_us) {
  for (int i = 0; i < cabinet::kRods; ++i) {
    const cabinet::RodInput& now = rods[i];
    Rod& rod = sources_[source][i];
    if (now.status != cabinet::RodStatus::live) continue;
    rod.live_us = now_us;
    const bool moved = std::fabs(now.slide - rod.slide) > foosball::kMinHandSlide ||
                       std::fabs(now.angle - rod.angle) > foosball::kMinHandTurn;
    if (!moved) continue;
    rod.slide = now.slide;
    rod.angle = now.angle;
    rod.moved_us = play_us;
  }
}

std::int64_t HandWatch::still_us(std::size_t source, std::uint8_t rods,
                                 std::int64_t play_us) const {
  return play_us - newest(sources_[source], rods, &Rod::moved_us);
}

std::int64_t HandWatch::undriven_us(std::size_t source, std::uint8_t rods,
                                    std::int64_t now_us) const {
  return now_us - newest(sources_[source], rods, &Rod::live_us);
}

}  // namespace server
