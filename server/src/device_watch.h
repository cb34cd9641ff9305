// Tells a person what is the matter with a device, what to do, and when it is well again.
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
  // fault: empty where all is well again; then is_well is for the log.
  using Tell = std::function<void(std::uint32_t device, const wire::Sentence& fault,
                                  const std::string& is_well)>;

  // At once when a device that was live no longer is, or is again; else what has lasted a while.
  void look(const std::vector<std::unique_ptr<cabinet::Device>>& devices, std::int64_t now_us,
            const Tell& tell);
  // A sensor that could not follow its rod: what it has lost is not known. Told for a while.
  void look_at_sensors(const std::vector<std::unique_ptr<cabinet::Device>>& devices,
                       std::int64_t now_us, const Tell& tell);

 private:
  // To say its first word, and before one fault is told in place of another: a controller that was
  // plugged in again is silent for as long as it starts.
  static constexpr std::int64_t kPatienceUs = 1'000'000;
  struct Watched {
    cabinet::DeviceState state;  // as last seen
    std::int64_t since_us;       // in that state, or under watch
    std::optional<cabinet::DeviceState> told;
    bool ever_live = false;
  };
  struct Saturation {
    std::uint64_t overflows = 0;  // that are known
    std::int64_t last_us = 0;
    bool told = false;
  };
  static constexpr std::int64_t kSaturationShownUs = 6'000'000;
  static bool due(const Watched& watched, std::int64_t now_us);

  std::vector<Watched> watched_;
  std::vector<Saturation> saturations_;
};

}  // namespace server
