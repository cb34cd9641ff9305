#include "remote_source.h"

namespace server {
namespace {

// A rod that is no longer driven holds its position.
void let_go(cabinet::RodInput& rod) {
  if (rod.status != cabinet::RodStatus::live) return;
  rod.status = cabinet::RodStatus::held;
  rod.slide_rate = rod.angle_rate = 0.0;
}

}  // namespace

void RemoteSource::reset(std::int64_t now_us) {
  rods_ = {};
  own_ = {};
  received_ = false;
  received_us_ = now_us;
}

void RemoteSource::set_rods(std::uint8_t rods) {
  for (int rod = 0; rod < cabinet::kRods; ++rod) {
    own_[rod] = (rods >> rod & 1) != 0;
    if (!own_[rod]) rods_[rod] = {};
  }
}

bool RemoteSource::accept(const wire::InputDatagram& input, std::int64_t now_us) {
  // A signed difference, so that a counter may wrap.
  const auto ahead = static_cast<std::int32_t>(input.sequence - sequence_);
  if (received_ && ahead <= 0) {
    ++counters_.stale;
    return false;
  }
  if (received_) counters_.lost += static_cast<std::uint64_t>(ahead - 1);
  ++counters_.frames;
  received_ = true;
  sequence_ = input.sequence;
  received_us_ = now_us;
  for (int rod = 0; rod < cabinet::kRods; ++rod) {
    const wire::InputRod& in = input.rods[rod];
    if (!own_[rod]) continue;
    if (!in.driven) {
      let_go(rods_[rod]);
      continue;
    }
    rods_[rod] = {in.slide,      in.angle, in.slide_rate,
                  in.angle_rate, now_us,   cabinet::RodStatus::live};
  }
  return true;
}

void RemoteSource::poll(std::int64_t now_us) {
  if (!received_ || now_us - received_us_ < kSilenceUs) return;
  for (cabinet::RodInput& rod : rods_) let_go(rod);
}

}  // namespace server
