#include "two_wire.h"

#include <simavr/avr_twi.h>
#include <simavr/sim_interrupts.h>
#include <simavr/sim_io.h>

#include <cstring>
#include <utility>

namespace firmware_sim {

namespace {

constexpr std::uint8_t kFlag = 0x80, kAcknowledge = 0x40, kStart = 0x20, kStop = 0x10, kOn = 0x04;
constexpr std::uint8_t kStarted = 0x08, kStartedAgain = 0x10, kLost = 0x38;
constexpr std::uint64_t kHold = 5;       // [cycles] data hold time after the clock's falling edge
constexpr std::uint64_t kLookAgain = 8;  // ... retry period while a device holds the clock

}  // namespace

TwoWire::TwoWire(avr_t* avr, Wires wires) : avr_(avr), wires_(std::move(wires)) {
  for (avr_io_t* io = avr->io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "twi") == 0) twi_ = reinterpret_cast<avr_twi_t*>(io);
  }
  if (twi_ == nullptr) return;
  auto& writing = avr->io[AVR_DATA_TO_IO(twi_->r_twcr)].w;
  writing.c = on_control;
  writing.param = this;
}

std::uint8_t& TwoWire::control() const {
  return avr_->data[twi_->r_twcr];
}
// Data sheet, 24.5.2, without the prescaler.
std::uint64_t TwoWire::half() const {
  return 8u + avr_->data[twi_->r_twbr];
}

void TwoWire::reset() {
  doing_ = Doing::nothing;
  owns_bus_ = false;
  release();
}

void TwoWire::drive(bool clock_low, bool data_low) {
  clock_low_ = clock_low;
  data_low_ = data_low;
  wires_.changed();
}
void TwoWire::release() {
  if (clock_low_ || data_low_) drive(false, false);
}

void TwoWire::on_control(avr_t* avr, avr_io_addr_t, std::uint8_t value, void* parameter) {
  auto& two_wire = *static_cast<TwoWire*>(parameter);
  std::uint8_t& control = two_wire.control();
  const std::uint8_t flag = control & kFlag;
  if ((value & kOn) == 0) {
    avr_cycle_timer_cancel(avr, on_time, parameter);
    control = value & static_cast<std::uint8_t>(~(kFlag | kStop));
    avr_clear_interrupt(avr, &two_wire.twi_->twi);
    two_wire.reset();
    return;
  }
  control = static_cast<std::uint8_t>((value & ~kFlag) | flag);
  if ((value & kFlag) == 0) return;
  control &= static_cast<std::uint8_t>(~kFlag);
  avr_clear_interrupt(avr, &two_wire.twi_->twi);
  two_wire.begin(value);
}

void TwoWire::begin(std::uint8_t value) {
  phase_ = 0;
  if ((value & kStop) != 0) {
    doing_ = Doing::stop;
  } else if ((value & kStart) != 0) {
    doing_ = Doing::start;
  } else if (owns_bus_) {
    begin_byte();
  } else {
    doing_ = Doing::nothing;
    return;
  }
  avr_cycle_timer_register(avr_, kHold, on_time, this);
}

void TwoWire::begin_byte() {
  doing_ = Doing::byte;
  sends_ = !addressed_ || !reading_;
  shift_ = avr_->data[twi_->r_twdr];
  if (!addressed_) reading_ = (shift_ & 1) != 0;
  acknowledges_ = (control() & kAcknowledge) != 0;
  bit_ = 0;
}

avr_cycle_count_t TwoWire::on_time(avr_t* avr, avr_cycle_count_t, void* parameter) {
  const std::uint64_t cycles = static_cast<TwoWire*>(parameter)->step();
  return cycles == 0 ? 0 : avr->cycle + cycles;
}

std::uint64_t TwoWire::step() {
  switch (doing_) {
    case Doing::start:
      return step_start();
    case Doing::byte:
      return step_byte();
    case Doing::stop:
      return step_stop();
    case Doing::nothing:
      break;
  }
  return 0;
}

void TwoWire::done(std::uint8_t status) {
  doing_ = Doing::nothing;
  avr_->data[twi_->r_twsr] = status;
  control() |= kFlag;
  avr_raise_interrupt(avr_, &twi_->twi);
}

std::uint64_t TwoWire::step_start() {
  switch (phase_) {
    case 0:  // repeated START: this side owns the clock
      if (owns_bus_) drive(true, false);
      phase_ = 1;
      return half();
    case 1:
      if (owns_bus_) drive(false, false);
      if (!wires_.clock() || !wires_.data()) return kLookAgain;
      phase_ = 2;
      return half();
    case 2:
      drive(false, true);
      phase_ = 3;
      return half();
    default:
      drive(true, true);
      addressed_ = false;
      done(std::exchange(owns_bus_, true) ? kStartedAgain : kStarted);
      return 0;
  }
}

// Phases: data, rising clock edge, falling clock edge.
std::uint64_t TwoWire::step_byte() {
  const bool mine = (bit_ < 8) == sends_;  // this side drives this bit
  switch (phase_) {
    case 0: {
      const bool high = bit_ < 8 ? (shift_ & 0x80) != 0 : !acknowledges_;
      drive(true, mine && !high);
      phase_ = 1;
      return half() - kHold;
    }
    case 1:
      drive(false, data_low_);
      if (!wires_.clock()) return kLookAgain;
      phase_ = 2;
      return half();
    default:
      break;
  }
  const bool high = wires_.data();
  if (mine && !high && !data_low_) {
    owns_bus_ = false;
    drive(false, false);
    done(kLost);
    return 0;
  }
  if (bit_ < 8) {
    shift_ = static_cast<std::uint8_t>(shift_ << 1 | (high ? 1 : 0));
  } else {
    acknowledged_ = !high;
  }
  drive(true, data_low_);
  phase_ = 0;
  if (++bit_ < 9) return kHold;
  if (!sends_) avr_->data[twi_->r_twdr] = shift_;
  done(status_of_byte());
  addressed_ = true;
  return 0;
}

std::uint8_t TwoWire::status_of_byte() const {
  if (!addressed_) return reading_ ? (acknowledged_ ? 0x40 : 0x48) : (acknowledged_ ? 0x18 : 0x20);
  if (reading_) return acknowledged_ ? 0x50 : 0x58;
  return acknowledged_ ? 0x28 : 0x30;
}

std::uint64_t TwoWire::step_stop() {
  if (!owns_bus_) phase_ = 3;
  switch (phase_) {
    case 0:
      drive(true, true);
      phase_ = 1;
      return half() - kHold;
    case 1:
      drive(false, true);
      if (!wires_.clock()) return kLookAgain;
      phase_ = 2;
      return half();
    default:
      drive(false, false);
      owns_bus_ = false;
      control() &= static_cast<std::uint8_t>(~kStop);
      doing_ = (control() & kStart) != 0 ? Doing::start : Doing::nothing;
      phase_ = 0;
      return doing_ == Doing::start ? half() : 0;
  }
}

}  // namespace firmware_sim
