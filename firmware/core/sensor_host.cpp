#include "core/sensor_host.h"

namespace firmware {

namespace {

const uint8_t kProductId = 0x00, kMotion = 0x02, kConfig1 = 0x0F, kConfig2 = 0x10,
              kPowerUpReset = 0x3A, kInverseProductId = 0x3F, kMotionBurst = 0x50;
const uint8_t kResetValue = 0x5A, kProduct = 0x42;
const uint8_t kMotionRegisters = 5;  // 02h..06h, to be read once after a reset
const uint8_t kSeen = 0x80;          // bit of the motion byte: the sensor has moved
const uint8_t kMaxInchesPerSecond = 250;

bool passed(uint32_t now_ms, uint32_t deadline_ms) {
  return static_cast<int32_t>(now_ms - deadline_ms) >= 0;
}

// Bit i: sensor i gave the wanted answer.
uint8_t equal(const uint8_t* answers, uint8_t wanted) {
  uint8_t mask = 0;
  for (uint8_t i = 0; i < kSensors; ++i) {
    if (answers[i] == wanted) mask = static_cast<uint8_t>(mask | 1u << i);
  }
  return mask;
}

int16_t signed16(uint8_t low, uint8_t high) {
  return static_cast<int16_t>(static_cast<uint16_t>(low | high << 8));
}

// Little endian and aligned: one access.
uint32_t word_at(const uint8_t* bytes) {
  uint32_t word;
  __builtin_memcpy(&word, __builtin_assume_aligned(bytes, 4), 4);
  return word;
}
void put_word(uint32_t word, uint8_t* bytes) {
  __builtin_memcpy(__builtin_assume_aligned(bytes, 4), &word, 4);
}

}  // namespace

// Swaps bits, then pairs, then nibbles across the diagonal, four rows per word.
void transpose8(const uint8_t* rows, uint8_t* out) {
  // Rows 0..3 and 4..7, the first one in the most significant byte.
  uint32_t high = __builtin_bswap32(word_at(rows)), low = __builtin_bswap32(word_at(rows + 4));
  uint32_t moved = (high ^ high >> 7) & 0x00AA00AAu;
  high ^= moved ^ moved << 7;
  moved = (low ^ low >> 7) & 0x00AA00AAu;
  low ^= moved ^ moved << 7;
  moved = (high ^ high >> 14) & 0x0000CCCCu;
  high ^= moved ^ moved << 14;
  moved = (low ^ low >> 14) & 0x0000CCCCu;
  low ^= moved ^ moved << 14;
  // Columns 7..4 and 3..0, the first one in the most significant byte, which is the last byte of
  // out.
  put_word((high << 4 & 0xF0F0F0F0u) | (low & 0x0F0F0F0Fu), out);
  put_word((high & 0xF0F0F0F0u) | (low >> 4 & 0x0F0F0F0Fu), out + 4);
}

void SensorHost::begin(uint8_t used, uint8_t resolution) {
  used_ = used;
  live_ = 0;
  suspect_ = observed_ = 0;
  resolution_ = resolution;
  step_ = kIdle;
  setting_up_ = 0;
  retry_ms_ = 0;
  tried_ = used == 0;
}

void SensorHost::sample(uint8_t elapsed_ms) {
  if (live_ == 0) return;
  alignas(4) uint8_t bits[8 * kBurstBytes];
  alignas(4) uint8_t answers[kBurstBytes][kSensors];
  bus_.burst(live_, bits);
  for (uint8_t byte = 0; byte < kBurstBytes; ++byte) transpose8(bits + 8 * byte, answers[byte]);
  // Motion beyond the sensor's tracking range, with a margin of a quarter: it has lost track. At
  // the 16-bit limit the delta is saturated and counts are missing.
  const int32_t max = static_cast<int32_t>(kMaxInchesPerSecond) * resolution_ * elapsed_ms / 8 + 8;
  const int32_t limit = max < 32767 ? max : 32767;
  for (uint8_t i = 0; i < kSensors; ++i) {
    const uint8_t mask = static_cast<uint8_t>(1u << i);
    if ((live_ & mask) == 0) continue;
    // All ones: nothing drives the line. All zeros: the line is held low. That looks like no
    // motion, but the observation byte is zero too.
    const bool ones = answers[0][i] == 0xFF && answers[1][i] == 0xFF;
    const bool zeros = answers[1][i] == 0 && (observed_ & mask) != 0;
    if (answers[1][i] != 0) observed_ = static_cast<uint8_t>(observed_ | mask);
    if (ones || zeros) {
      suspect_ = static_cast<uint8_t>(suspect_ | mask);
    } else if ((answers[0][i] & kSeen) != 0) {
      const int16_t x = signed16(answers[2][i], answers[3][i]);
      const int16_t y = signed16(answers[4][i], answers[5][i]);
      slide_[i] = static_cast<uint16_t>(slide_[i] + static_cast<uint16_t>(x));
      spin_[i] = static_cast<uint16_t>(spin_[i] + static_cast<uint16_t>(y));
      if (x >= limit || x <= -limit || y >= limit || y <= -limit) {
        overflow_ = static_cast<uint8_t>(overflow_ | mask);
      }
    }
  }
}

void SensorHost::service(uint32_t now_ms) {
  if (suspect_ != 0) {
    suspect_ = 0;
    ask(true);
    return;
  }
  const bool all = (used_ & ~live_) == 0;
  if (step_ != kIdle || (!all && passed(now_ms, retry_ms_))) {
    set_up(now_ms);
  } else if (live_ != 0 && passed(now_ms, check_ms_)) {
    check_ms_ = now_ms + kCheckMs;
    ask(false);
  }
}

void SensorHost::ask(bool suspicious) {
  const uint8_t address[kQuestions] = {kProductId, kInverseProductId, kConfig1};
  const uint8_t wanted[kQuestions] = {kProduct, static_cast<uint8_t>(~kProduct),
                                      static_cast<uint8_t>(resolution_ - 1)};
  alignas(4) uint8_t answers[kSensors];
  bus_.read(live_, address[question_], answers);
  bus_.write(live_, kMotionBurst, 0);  // reading a register ends burst mode
  const uint8_t wrong = static_cast<uint8_t>(live_ & ~equal(answers, wanted[question_]));
  question_ = static_cast<uint8_t>((question_ + 1) % kQuestions);
  if (suspicious || wrong != 0) count_errors(1);
  lose(wrong);
}

void SensorHost::lose(uint8_t sensors) {
  live_ = static_cast<uint8_t>(live_ & ~sensors);
  observed_ = static_cast<uint8_t>(observed_ & ~sensors);
}

void SensorHost::set_up(uint32_t now_ms) {
  alignas(4) uint8_t answers[kSensors];
  switch (step_) {
    case kIdle:
    case kReset:
      setting_up_ = static_cast<uint8_t>(used_ & ~live_);
      bus_.write(setting_up_, kPowerUpReset, kResetValue);
      step_ms_ = now_ms;
      step_ = kWake;
      break;
    case kWake:
      if (!passed(now_ms, step_ms_ + kWakeMs)) break;
      flushed_ = 0;
      step_ = kFlush;
      break;
    case kFlush:
      bus_.read(setting_up_, static_cast<uint8_t>(kMotion + flushed_), answers);
      if (++flushed_ == kMotionRegisters) step_ = kRest;
      break;
    case kRest:  // no rest modes: a sensor in one would detect the next motion up to 0.5 s late
      bus_.write(setting_up_, kConfig2, 0);
      step_ = kResolution;
      break;
    case kResolution:
      bus_.write(setting_up_, kConfig1, static_cast<uint8_t>(resolution_ - 1));
      step_ = kIdentity;
      break;
    case kIdentity:
      bus_.read(setting_up_, kProductId, answers);
      setting_up_ = static_cast<uint8_t>(setting_up_ & equal(answers, kProduct));
      step_ = kBurst;
      break;
    case kBurst:
      if (setting_up_ != 0) {
        bus_.write(setting_up_, kMotionBurst, 0);
        if ((setting_up_ & ever_live_) != 0) set_up_again_ = true;
        ever_live_ = static_cast<uint8_t>(ever_live_ | setting_up_);
        live_ = static_cast<uint8_t>(live_ | setting_up_);
      }
      tried_ = true;
      retry_ms_ = now_ms + kRetryMs;
      step_ = kIdle;
      break;
  }
}

void SensorHost::count_errors(uint8_t errors) {
  quality_ = static_cast<uint8_t>(errors > 255 - quality_ ? 255 : quality_ + errors);
}

void SensorHost::add_to_frame(wire::DeviceFrame& frame) {
  for (uint8_t sensor = 0; sensor < kSensors; ++sensor) {
    if ((used_ & 1u << sensor) == 0) continue;
    frame.slide[sensor] = slide_[sensor];
    frame.spin[sensor] = spin_[sensor];
  }
  if (set_up_again_) frame.flags = static_cast<uint8_t>(frame.flags | 1);
  frame.present = static_cast<uint8_t>((frame.present & ~used_) | live_);
  frame.overflow = static_cast<uint8_t>((frame.overflow & ~used_) | overflow_);
  frame.quality =
      static_cast<uint8_t>(quality_ > 255 - frame.quality ? 255 : frame.quality + quality_);
  set_up_again_ = false;
  overflow_ = 0;
  quality_ = 0;
}

}  // namespace firmware
