// The page of controllers: for the host, the devices at the server's machine. Raw counts,
// calibrated motion, rates and latency, current and over the last seconds.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "client/menu_page.h"
#include "wire/control.h"

namespace client {

struct DeviceView {
  static constexpr double kTraceSeconds = 10.0;
  struct Point {
    double seconds;      // on the server's clock
    double slide, spin;  // [counts]
  };
  wire::DeviceReport now;
  double frames_per_second = 0.0;  // over the last second, like the next two
  double latency_ms = -1.0;        // mean, from arrival to tick; negative: unknown
  std::uint64_t lost = 0;          // frames
  std::array<std::deque<Point>, wire::kRods> traces;

  struct Totals {
    std::int64_t time_us;
    std::uint64_t frames, lost, stamped, latency_sum_us;
  };
  std::deque<Totals> totals;  // of the last second
};

class DevicesMenu {
 public:
  static constexpr std::int64_t kAskEveryUs = 50'000;
  static constexpr std::int64_t kPatienceUs = 1'000'000;  // time limit for an answer

  // Call each frame while the page is shown. True: send a request to the server.
  bool ask(std::int64_t now_us);
  void update(const wire::Devices& reported);
  // Sets the joined session, and whether this client is its host.
  void follow(std::uint64_t session, bool host);

  int rows() const { return static_cast<int>(devices_.size()); }
  MenuPage page(int row) const;

 private:
  std::uint64_t session_ = 0;
  bool host_ = false, answered_ = false, waits_ = false;
  std::int64_t asked_us_ = 0;
  std::vector<std::shared_ptr<DeviceView>> devices_;
};

}  // namespace client
