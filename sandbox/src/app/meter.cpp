#include "app/meter.h"

#include <algorithm>

namespace sandbox {

void Meter::frame(std::int64_t now_ns, double scene_time) {
  ++frames_;
  if (since_ns_ == 0 || scene_time < since_time_) {
    since_ns_ = now_ns;
    since_time_ = scene_time;
    window_frames_ = 0;
    return;
  }
  ++window_frames_;
  if (now_ns - since_ns_ < kWindowNs) return;
  const double seconds = 1e-9 * static_cast<double>(now_ns - since_ns_);
  rate_ = window_frames_ / seconds;
  speed_ = (scene_time - since_time_) / seconds;
  since_ns_ = now_ns;
  since_time_ = scene_time;
  window_frames_ = 0;
}

}  // namespace sandbox
