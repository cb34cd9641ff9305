// Reports device faults with a remedy, and reports when a device works again.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cabinet/device.h"
#include "wire/sentence.h"

namespace server {

class DeviceWatch {
 public:
  // fault: empty if the device works again; is_well is then the text for the log.
  using Report = std::function<void(std::uint32_t device, const wire::Sentence& fault,
                                    const std::string& is_well)>;

  // Reports at once when a device stops being live, or is live again; other states only after a
  // while.
  void look(const std::vector<std::unique_ptr<cabinet::Device>>& devices, std::int64_t now_us,
            const Report& report);
  // A sensor that could not follow its rod: the number of lost counts is unknown. Reported for a
  // while.
  void look_at_sensors(const std::vector<std::unique_ptr<cabinet::Device>>& devices,
                       std::int64_t now_us, const Report& report);

 private:
  // Delay before a new device is reported, and before one fault replaces another: a controller that
  // was plugged in again is silent while it starts.
  static constexpr std::int64_t kPatienceUs = 1'000'000;
  struct Watched {
    cabinet::DeviceState state;  // as last seen
    std::int64_t since_us;       // in that state, or watched
    std::optional<cabinet::DeviceState> reported;
    bool ever_live = false;
  };
  struct Saturation {
    std::uint64_t overflows = 0;  // reported so far
    std::int64_t last_us = 0;
    bool reported = false;
  };
  static constexpr std::int64_t kSaturationShownUs = 6'000'000;
  static bool due(const Watched& watched, std::int64_t now_us);

  std::vector<Watched> watched_;
  std::vector<Saturation> saturations_;
};

}  // namespace server
