#include "app/frame_meter.h"

namespace client {
namespace {

constexpr int kJudgedFrames = 20;
constexpr int kLoadingFrames = 5;
constexpr std::int64_t kRateOverUs = 500'000;

}  // namespace

void FrameMeter::begin(std::int64_t now_us) {
  began_us_ = now_us;
  if (rate_since_us_ == 0) rate_since_us_ = now_us;
}

void FrameMeter::end(std::int64_t now_us) {
  ++frames_;
  ++rate_frames_;
  if (now_us - rate_since_us_ >= kRateOverUs) {
    rate_ = static_cast<double>(rate_frames_) * 1e6 / static_cast<double>(now_us - rate_since_us_);
    rate_frames_ = 0;
    rate_since_us_ = now_us;
  }
  if (skip_ > 0) {
    --skip_;
    return;
  }
  spent_s_ += 1e-6 * static_cast<double>(now_us - began_us_);
  if (++judged_ < kJudgedFrames) return;
  too_slow_ = spent_s_ / kJudgedFrames > kTooSlowS;
  judged_ = 0;
  spent_s_ = 0;
}

void FrameMeter::restart_judgement() {
  skip_ = kLoadingFrames;
  judged_ = 0;
  spent_s_ = 0;
  too_slow_ = false;
}

}  // namespace client
