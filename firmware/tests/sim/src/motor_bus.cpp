#include "firmware_sim/motor_bus.h"

namespace firmware_sim {

namespace {

// Min times of fast mode [ns].
constexpr std::uint64_t kHigh = 600, kLow = 1300, kDataSetup = 100, kStartHold = 600,
                        kStartSetup = 600, kStopSetup = 600, kBusFree = 1300;

}  // namespace

void MotorBus::require(bool good, const char* what, std::uint64_t now_ns) {
  if (!good) violations_.push_back(std::string(what) + " at " + std::to_string(now_ns) + " ns");
}

void MotorBus::drive(std::uint64_t now_ns, bool clock_low, bool data_low) {
  if (stretched_until_ns_ && *stretched_until_ns_ <= now_ns) stretched_until_ns_.reset();
  master_clock_low_ = clock_low;
  master_data_low_ = data_low;
  // A device's response to an edge may change the wires again.
  while (take_step(now_ns, clock_low, data_low)) {
  }
}

bool MotorBus::take_step(std::uint64_t now_ns, bool clock_low, bool data_low) {
  if (!holds_clock) clock_held_ = false;
  const bool clock = !clock_low && !pulls_clock(), data = !data_low && !pulls_data();
  const bool clock_changed = clock != clock_, data_changed = data != data_;
  if (!clock_changed && !data_changed) return false;
  clock_ = clock;
  data_ = data;
  if (data_changed) data_ns_ = now_ns;
  if (clock_changed && data_changed) require(false, "clock and data change at once", now_ns);
  if (clock_changed) {
    clock ? on_rise(now_ns) : on_fall(now_ns);
  } else if (clock) {
    data ? on_stop(now_ns) : on_start(now_ns);
  }
  return true;
}

void MotorBus::on_start(std::uint64_t now_ns) {
  if (!master_data_low_) return;  // a device that holds the line is not being addressed
  require(now_ns - rose_ns_ >= kStartSetup, "START too soon after the clock rose", now_ns);
  require(stop_ns_ == 0 || now_ns - stop_ns_ >= kBusFree, "START too soon after STOP", now_ns);
  start_ns_ = now_ns;
  active_ = true;
  begun_ = addressed_ = sends_ = false;
  part_ = Part::none;
  bit_ = 0;
  bytes_ = 0;
}

void MotorBus::on_stop(std::uint64_t now_ns) {
  require(now_ns - rose_ns_ >= kStopSetup, "STOP too soon after the clock rose", now_ns);
  stop_ns_ = now_ns;
  if (active_ && part_ == Part::multiplexer && bytes_ > 0) channels_ = new_channels_;
  active_ = false;
  data_low_ = false;
}

void MotorBus::on_rise(std::uint64_t now_ns) {
  require(now_ns - fell_ns_ >= kLow, "the clock was low too short", now_ns);
  require(now_ns - data_ns_ >= kDataSetup, "data too late before the clock rose", now_ns);
  rose_ns_ = now_ns;
  ++clocks_;
  if (!active_ || !begun_) return;
  if (bit_ < 8 && !sends_) shift_ = static_cast<std::uint8_t>(shift_ << 1 | (data_ ? 1 : 0));
  if (bit_ == 8 && sends_ && data_) part_ = Part::none;  // not acknowledged: stop sending
}

void MotorBus::on_fall(std::uint64_t now_ns) {
  require(now_ns - rose_ns_ >= kHigh, "the clock was high too short", now_ns);
  require(now_ns - start_ns_ >= kStartHold, "the clock fell too soon after START", now_ns);
  fell_ns_ = now_ns;
  if (held_clocks_ > 0) --held_clocks_;
  if (holds_clock) clock_held_ = true;
  if (!active_) return;
  if (!begun_) {
    begun_ = true;
    return;
  }
  data_low_ = false;
  if (++bit_ == 8) {
    if (sends_) return;  // acknowledged by the controller
    data_low_ = take_byte(now_ns);
    if (data_low_ && stretch_us > 0) stretched_until_ns_ = now_ns + 1000ull * stretch_us;
    return;
  }
  if (bit_ == 9) {
    bit_ = 0;
    if (part_ == Part::expander && sends_) shift_ = *expander;
  }
  if (sends_ && part_ == Part::expander && bit_ < 8) data_low_ = (shift_ >> (7 - bit_) & 1) == 0;
}

// Returns true for acknowledge.
bool MotorBus::take_byte(std::uint64_t now_ns) {
  if (!addressed_) {
    addressed_ = true;
    return take_address(now_ns);
  }
  if (part_ == Part::none) return false;
  if (part_ == Part::multiplexer) new_channels_ = shift_;
  if (part_ == Part::driver && bytes_ == 0) pointer_ = shift_;
  if (part_ == Part::driver && bytes_ > 0) {
    for (int rod = 0; rod < 8; ++rod) {
      if ((channels_ & attached & 1u << rod) == 0) continue;
      registers_[static_cast<std::size_t>(rod)][pointer_] = shift_;
      writes_.push_back({now_ns, rod, pointer_, shift_});
    }
    ++pointer_;
  }
  ++bytes_;
  return true;
}

bool MotorBus::take_address(std::uint64_t now_ns) {
  const int address = shift_ >> 1;
  const bool reading = (shift_ & 1) != 0;
  if (address == kMultiplexer && multiplexer && !reading) part_ = Part::multiplexer;
  if (address == kDriver && multiplexer && (channels_ & attached) != 0 && !reading)
    part_ = Part::driver;
  if (address == kExpander && expander && reading) part_ = Part::expander;
  sends_ = part_ == Part::expander;
  if (sends_) reads_ns_.push_back(now_ns);
  return part_ != Part::none;
}

}  // namespace firmware_sim
