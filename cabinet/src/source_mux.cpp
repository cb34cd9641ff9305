#include "cabinet/source_mux.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace cabinet {
namespace {

// Time constant for the offset of an absolute driver: down to 2 % in 0.6 s, at up to 1.3 m/s for an
// offset of 0.2 m, no faster than a hand.
constexpr double kFadeSeconds = 0.15;
constexpr double kTurn = 2 * std::numbers::pi;

// Removes the fraction `share` of the offset; returns the rate of the change.
double fade(double& offset, double towards, double share, double seconds) {
  const double step = (towards - offset) * share;
  offset += step;
  if (std::abs(offset - towards) < 1e-6) offset = towards;
  return seconds > 0 ? step / seconds : 0;
}

}  // namespace

SourceMux::SourceMux(const std::array<double, kRods>& slide_limit) : slide_limit_(slide_limit) {}

int SourceMux::add(InputSource& source, Origin origin) {
  sources_.push_back({&source, origin});
  return static_cast<int>(sources_.size()) - 1;
}

void SourceMux::assign(int rod, std::span<const int> order) {
  auto& wanted = slots_[rod].order;
  wanted.clear();
  wanted.reserve(order.size());  // an order of the same size needs no allocation
  std::copy_if(order.begin(), order.end(), std::back_inserter(wanted),
               [&](int index) { return index >= 0 && index < static_cast<int>(sources_.size()); });
}

void SourceMux::place(int rod, double slide, double angle) {
  rods_[rod].slide = std::clamp(slide, -slide_limit_[rod], slide_limit_[rod]);
  rods_[rod].angle = angle;
  slots_[rod].driver = kNobody;  // the next driver takes over from this pose
}

int SourceMux::pick(int rod) const {
  for (const int index : slots_[rod].order) {
    if (sources_[index].source->rods()[rod].status != RodStatus::absent) return index;
  }
  return kNobody;
}

void SourceMux::take_over(int rod, int driver) {
  Slot& slot = slots_[rod];
  slot.driver = driver;
  if (driver == kNobody) return;
  const RodInput& in = sources_[driver].source->rods()[rod];
  slot.slide_offset = rods_[rod].slide - in.slide;
  slot.angle_offset = rods_[rod].angle - in.angle;
}

void SourceMux::follow(int rod, double seconds) {
  Slot& slot = slots_[rod];
  RodInput& out = rods_[rod];
  if (slot.driver == kNobody) {
    out.status = RodStatus::absent;
    out.slide_rate = out.angle_rate = 0;
    return;
  }
  const Entry& entry = sources_[slot.driver];
  const RodInput& in = entry.source->rods()[rod];
  double slide_rate = in.slide_rate, angle_rate = in.angle_rate;
  const bool live = in.status == RodStatus::live, absolute = entry.origin == Origin::absolute;
  const double share = 1 - std::exp(-seconds / kFadeSeconds);
  if (live && absolute) slide_rate += fade(slot.slide_offset, 0, share, seconds);
  if (live && (absolute || in.angle_known)) {
    const double turns = kTurn * std::round(slot.angle_offset / kTurn);
    angle_rate += fade(slot.angle_offset, turns, share, seconds);
  }

  const double limit = slide_limit_[rod];
  const double wanted = in.slide + slot.slide_offset;
  const double slide = std::clamp(wanted, -limit, limit);
  if (slide != wanted && slide_rate * wanted > 0) slide_rate = 0;  // at the stop: no rate into it
  if (entry.origin == Origin::relative) {  // ... and no wind-up, by the measured position
    const double measured = in.slide - in.slide_ahead;
    slot.slide_offset = std::clamp(measured + slot.slide_offset, -limit, limit) - measured;
  }
  out = {.slide = slide,
         .angle = in.angle + slot.angle_offset,
         .slide_rate = slide_rate,
         .angle_rate = angle_rate,
         .time_us = in.time_us,
         .status = in.status,
         .slide_ahead = in.slide_ahead,
         .angle_ahead = in.angle_ahead,
         .angle_known = in.angle_known};
}

void SourceMux::poll(std::int64_t now_us) {
  const double elapsed = started_ ? static_cast<double>(now_us - last_us_) * 1e-6 : 0;
  started_ = true;
  last_us_ = now_us;
  counters_ = {};
  for (const Entry& entry : sources_) {
    entry.source->poll(now_us);
    counters_ = counters_ + entry.source->counters();
  }
  for (int rod = 0; rod < kRods; ++rod) {
    const int driver = pick(rod);
    if (driver != slots_[rod].driver) take_over(rod, driver);
    follow(rod, std::max(elapsed, 0.0));
  }
}

}  // namespace cabinet
