// Tells when a device goes away, comes back, or was never there.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cabinet/device_source.h"
#include "wire/control.h"

namespace server {

class DeviceWatch {
 public:
  using Tell = std::function<void(wire::Notice::Level, std::uint32_t device, const std::string&)>;

  void look(const std::vector<std::unique_ptr<cabinet::DeviceSource>>& devices, std::int64_t now_us,
            const Tell& tell);

 private:
  // A device that takes longer than this to say its first word is told to be missing.
  static constexpr std::int64_t kPatienceUs = 1'000'000;
  enum class State : std::uint8_t { awaited, present, gone };
  struct Watched {
    State state = State::awaited;
    std::int64_t since_us = 0;
  };
  std::vector<Watched> watched_;
};

}  // namespace server
