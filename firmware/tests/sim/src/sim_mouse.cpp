#include "firmware_sim/sim_mouse.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace firmware_sim {

namespace {

constexpr std::uint64_t kUs = 1000, kMs = 1'000'000;
constexpr std::uint64_t kLook = 50 * kUs;  // period at which an idle mouse checks the wires
// From the release of the clock to the first pulse.
constexpr std::uint64_t kRequestDelay = 60 * kUs;
constexpr int kStopBit = 10;

bool odd_ones(std::uint8_t value) {
  return (std::popcount(value) & 1) != 0;
}

std::uint16_t frame_of(std::uint8_t value, bool bad_parity, bool bad_stop) {
  const unsigned parity = odd_ones(value) == bad_parity ? 1u : 0u;
  return static_cast<std::uint16_t>(value << 1 | parity << 9 | (bad_stop ? 0u : 1u) << kStopBit);
}

}  // namespace

SimMouse::SimMouse(const MouseOptions& options) : options_(options), random_(options.seed) {
  due_ns_ = options_.self_test_ms * kMs;
}

void SimMouse::set_options(const MouseOptions& options) {
  options_ = options;
  random_.seed(options.seed);
  if (phase_ == Phase::self_test) due_ns_ = now_ns_ + options_.self_test_ms * kMs;
}

void SimMouse::move(int slide_counts, int spin_counts) {
  if (!enabled_ && !options_.counts_disabled) return;
  pending_slide_ += slide_counts;
  pending_spin_ += spin_counts;
}

void SimMouse::unplug() {
  phase_ = Phase::unplugged;
  clock_low_ = data_low_ = spiking_ = false;
  outgoing_.clear();
  set_defaults();
}

void SimMouse::replug() {
  set_defaults();
  phase_ = Phase::self_test;
  due_ns_ = now_ns_ + options_.self_test_ms * kMs;
}

void SimMouse::skip_clock(int bit) {
  fault_ = Fault::skip_clock;
  fault_bit_ = bit;
}
void SimMouse::flip_parity() {
  fault_ = Fault::flip_parity;
}
void SimMouse::drop_stop() {
  fault_ = Fault::drop_stop;
}
void SimMouse::lose_byte() {
  fault_ = Fault::lose_byte;
}
void SimMouse::stretch_clock(int bit, std::uint32_t longer_us) {
  fault_ = Fault::stretch;
  fault_bit_ = bit;
  fault_ns_ = longer_us * 1000;
}
void SimMouse::glitch_clock(int bit, std::uint32_t width_ns) {
  fault_ = Fault::glitch;
  fault_bit_ = bit;
  fault_ns_ = width_ns;
}
void SimMouse::misread_command() {
  misreads_ = true;
}
void SimMouse::lose_announcement() {
  announcement_lost_ = true;
}
void SimMouse::spike(std::uint64_t width_ns) {
  spike_width_ns_ = width_ns;
}

bool SimMouse::settled() const {
  return pending_slide_ == 0 && pending_spin_ == 0 && outgoing_.empty() && phase_ == Phase::idle;
}

SimMouse::Counts SimMouse::unsent() const {
  auto slide = static_cast<int>(pending_slide_), spin = static_cast<int>(pending_spin_);
  for (const Chunk& chunk : outgoing_) {
    if (!chunk.movement) continue;
    slide += chunk.slide;
    spin += chunk.spin;
  }
  return {slide, spin};
}

void SimMouse::feel(std::uint64_t now_ns) {
  if (!hand_) return;
  const Counts moved = hand_(now_ns);
  move(moved.slide, moved.spin);
}

void SimMouse::set_defaults() {
  enabled_ = remote_ = reset_after_answer_ = false;
  rate_ = 100;
  resolution_ = 2;
  argument_of_ = 0;
  pending_slide_ = pending_spin_ = 0;
  byte_at_ = 0;
}

std::uint64_t SimMouse::next_event_ns() const {
  return spiking_ ? std::min(due_ns_, spike_end_ns_) : due_ns_;
}

void SimMouse::after(std::uint64_t now_ns, std::uint64_t delay_ns, Phase phase) {
  due_ns_ = now_ns + delay_ns;
  phase_ = phase;
}

std::uint64_t SimMouse::period_fraction(int quarters) {
  const std::uint64_t exact =
      1'000'000'000ull * static_cast<std::uint64_t>(quarters) / 4 / options_.clock_hz;
  if (options_.jitter_ns == 0) return exact;
  const std::uint64_t shift = random_() % (2ull * options_.jitter_ns + 1);
  return std::max<std::uint64_t>(exact + shift, options_.jitter_ns + kUs) - options_.jitter_ns;
}

bool SimMouse::spikes_due(std::uint64_t now_ns) {
  if (spiking_ && now_ns >= spike_end_ns_) spiking_ = false;
  return now_ns < due_ns_;
}

void SimMouse::step(std::uint64_t now_ns, bool host_clock_low, bool host_data_low) {
  now_ns_ = now_ns;
  if (spikes_due(now_ns)) return;
  switch (phase_) {
    case Phase::unplugged:
      after(now_ns, kLook, Phase::unplugged);
      break;
    case Phase::self_test:
      outgoing_.clear();
      if (!std::exchange(announcement_lost_, false)) outgoing_.push_back({{0xAA, 0x00}});
      after(now_ns, 0, Phase::idle);
      at_idle(now_ns, host_clock_low, host_data_low);
      break;
    case Phase::idle:
      at_idle(now_ns, host_clock_low, host_data_low);
      break;

    case Phase::send_data:
      if (host_clock_low) return abort(now_ns);
      data_low_ = (frame_ >> bit_at_ & 1) == 0;
      after(now_ns, period_fraction(1), Phase::send_fall);
      break;
    case Phase::send_fall:
      if (host_clock_low) return abort(now_ns);
      clock_low_ = !faulty_bit(Fault::skip_clock);
      after(now_ns, period_fraction(2) + (faulty_bit(Fault::stretch) ? fault_ns_ : 0),
            Phase::send_rise);
      break;
    case Phase::send_rise:
      clock_low_ = false;
      if (faulty_bit(Fault::glitch)) {
        byte_fault_ = Fault::none;
        after(now_ns, period_fraction(1), Phase::send_glitch);
        break;
      }
      if (++bit_at_ > kStopBit) return end_byte(now_ns);
      after(now_ns, period_fraction(1), Phase::send_data);
      break;

    case Phase::send_glitch:  // data unchanged: the bit is seen once more
      clock_low_ = true;
      after(now_ns, fault_ns_, Phase::send_rise);
      break;

    case Phase::take_fall:
      if (host_clock_low) return abort(now_ns);
      clock_low_ = true;
      after(now_ns, period_fraction(2), Phase::take_rise);
      break;
    case Phase::take_rise:
      clock_low_ = false;
      taken_ = static_cast<std::uint16_t>(taken_ | (host_data_low ? 0 : 1) << taken_bits_);
      if (++taken_bits_ < 10) {
        after(now_ns, period_fraction(2), Phase::take_fall);
      } else {
        data_low_ = true;
        after(now_ns, period_fraction(2), Phase::ack_fall);
      }
      break;
    case Phase::ack_fall:
      clock_low_ = true;
      after(now_ns, period_fraction(2), Phase::ack_rise);
      break;
    case Phase::ack_rise:
      clock_low_ = false;
      after(now_ns, period_fraction(1), Phase::ack_end);
      break;
    case Phase::ack_end:
      data_low_ = false;
      end_command_byte(now_ns);
      break;
  }
}

void SimMouse::at_idle(std::uint64_t now_ns, bool host_clock_low, bool host_data_low) {
  after(now_ns, kLook, Phase::idle);
  if (host_clock_low) return;
  if (host_data_low) {
    taken_ = 0;
    taken_bits_ = 0;
    after(now_ns, kRequestDelay, Phase::take_fall);
    return;
  }
  if (spike_width_ns_ && outgoing_.empty()) {
    spiking_ = true;
    spike_end_ns_ = now_ns + *spike_width_ns_;
    spike_width_ns_.reset();
    return;
  }
  if (outgoing_.empty() && enabled_ && !remote_ && now_ns >= next_report_ns_) {
    feel(now_ns);
    const std::uint64_t period = 1'000'000'000ull / static_cast<std::uint64_t>(rate_);
    next_report_ns_ = std::max(next_report_ns_ + period, now_ns - std::min(now_ns, kLook) + period);
    if (pending_slide_ != 0 || pending_spin_ != 0) outgoing_.push_back(take_movement());
  }
  if (!outgoing_.empty()) start_byte(now_ns);
}

void SimMouse::start_byte(std::uint64_t now_ns) {
  const Chunk& chunk = outgoing_.front();
  cut_after_byte_ = false;
  byte_fault_ = Fault::none;
  const bool second = byte_at_ == 1;
  if (chunk.movement && fault_ != Fault::none && second)
    byte_fault_ = std::exchange(fault_, Fault::none);
  if (byte_fault_ == Fault::lose_byte) {
    ++byte_at_;
    byte_fault_ = Fault::none;
  }
  frame_ = frame_of(chunk.bytes[byte_at_], byte_fault_ == Fault::flip_parity,
                    byte_fault_ == Fault::drop_stop);
  bit_at_ = 0;
  after(now_ns, 0, Phase::send_data);
  step(now_ns, false, false);
}

void SimMouse::end_byte(std::uint64_t now_ns) {
  data_low_ = false;
  after(now_ns, options_.byte_gap_us * kUs, Phase::idle);
  if (++byte_at_ < outgoing_.front().bytes.size()) return;
  byte_at_ = 0;
  last_sent_ = std::move(outgoing_.front());
  outgoing_.pop_front();
  if (last_sent_.movement) {
    ++packets_sent_;
    last_packet_ns_ = now_ns;
    slide_sent_ += last_sent_.slide;
    spin_sent_ += last_sent_.spin;
    if (last_sent_.overflow) ++overflows_sent_;
  }
  if (reset_after_answer_) {
    set_defaults();
    after(now_ns, options_.self_test_ms * kMs, Phase::self_test);
  }
}

void SimMouse::abort(std::uint64_t now_ns) {
  clock_low_ = data_low_ = false;
  cut_after_byte_ = byte_at_ > 0;
  byte_at_ = 0;
  after(now_ns, kLook, Phase::idle);
}

void SimMouse::end_command_byte(std::uint64_t now_ns) {
  // d0..d7, parity, stop
  const auto value = static_cast<std::uint8_t>(taken_ & 0xFF);
  const bool parity = (taken_ >> 8 & 1) != 0, stop = (taken_ >> 9 & 1) != 0;
  if (!stop || odd_ones(value) == parity || std::exchange(misreads_, false))
    return answer({0xFE}, now_ns);
  commands_.push_back(value);
  obey(value, now_ns);
}

void SimMouse::answer(std::vector<std::uint8_t> bytes, std::uint64_t now_ns) {
  // According to the standard, movement counts as reported once it has been sent.
  const bool forgets = options_.forgets_cut_packets && (cut_after_byte_ || byte_at_ > 0);
  if (!outgoing_.empty() && outgoing_.front().movement && !forgets) {
    pending_slide_ += outgoing_.front().slide;
    pending_spin_ += outgoing_.front().spin;
  }
  outgoing_.clear();  // a command discards pending output
  outgoing_.push_back({std::move(bytes)});
  byte_at_ = 0;
  after(now_ns, options_.reply_us * kUs, Phase::idle);
}

void SimMouse::obey(std::uint8_t value, std::uint64_t now_ns) {
  feel(now_ns);
  const std::uint8_t argument_of = std::exchange(argument_of_, std::uint8_t{0});
  if (argument_of == 0xF3) {
    rate_ = std::clamp<int>(value, 10, 200);
    return answer({0xFA}, now_ns);
  }
  if (argument_of == 0xE8) {
    resolution_ = value & 3;
    return answer({0xFA}, now_ns);
  }
  answer({0xFA}, now_ns);
  // All except EB and FE also discard movement not yet reported.
  if (value != 0xEB && value != 0xFE) pending_slide_ = pending_spin_ = 0;
  switch (value) {
    case 0xFF:
      reset_after_answer_ = true;
      break;
    case 0xFE:
      outgoing_.front() = last_sent_;
      break;
    case 0xF6:
      set_defaults();
      break;
    case 0xF5:
      enabled_ = false;
      break;
    case 0xF4:
      enabled_ = true;
      next_report_ns_ = now_ns;
      break;
    case 0xF3:
    case 0xE8:
      argument_of_ = value;
      break;
    case 0xF2:
      outgoing_.front().bytes.push_back(0x00);
      break;
    case 0xF0:
      remote_ = true;
      break;
    case 0xEA:
      remote_ = false;
      break;
    case 0xEB:
      outgoing_.push_back(take_movement());
      break;
    case 0xE9:
      for (const int byte : {(remote_ ? 0x40 : 0) | (enabled_ ? 0x20 : 0), resolution_, rate_}) {
        outgoing_.front().bytes.push_back(static_cast<std::uint8_t>(byte));
      }
      break;
    case 0xE7:
    case 0xE6:
      break;
    default:
      answer({0xFE}, now_ns);
  }
}

SimMouse::Chunk SimMouse::take_movement() {
  Chunk chunk;
  chunk.movement = true;
  unsigned head = 0x08;
  const auto take = [&](std::int64_t& pending, unsigned sign, unsigned over) {
    const auto delta = static_cast<int>(std::clamp<std::int64_t>(pending, -256, 255));
    if (delta != pending && !options_.splits_overflow) {
      head |= over;
      chunk.overflow = true;
      pending = 0;
    } else {
      pending -= delta;
    }
    if (delta < 0) head |= sign;
    return delta;
  };
  chunk.slide = take(pending_slide_, 0x10, 0x40);
  chunk.spin = take(pending_spin_, 0x20, 0x80);
  chunk.bytes = {static_cast<std::uint8_t>(head), static_cast<std::uint8_t>(chunk.slide),
                 static_cast<std::uint8_t>(chunk.spin)};
  return chunk;
}

}  // namespace firmware_sim
