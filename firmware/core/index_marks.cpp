#include "core/index_marks.h"

namespace firmware {

void IndexMarks::poll(uint32_t now_ms) {
  if (reading_) {
    const I2cBus::State state = bus_.state();
    if (state == I2cBus::kBusy) return;
    reading_ended(state == I2cBus::kIdle, now_ms);
    bus_.release();
    return;  // other users of the bus take precedence
  }
  if (static_cast<int32_t>(now_ms - next_ms_) < 0 || !bus_.claim(this)) return;
  next_ms_ = now_ms + read_ms_;
  reading_ = true;
  bus_.read(kExpander);
}

void IndexMarks::reading_ended(bool good, uint32_t now_ms) {
  reading_ = false;
  under_ = good ? static_cast<uint8_t>(~bus_.byte()) : 0;
  if (!good) next_ms_ = now_ms + kRetryMs;
}

}  // namespace firmware
