#include "pulse_watch.h"

#include <algorithm>

#include "wire/device_command.h"

namespace cabinet_bench {
namespace {

bool decode(std::span<const std::uint8_t> packet, cabinet::DeviceFraming framing,
            wire::DeviceCommand& command) {
  if (framing == cabinet::DeviceFraming::report) {  // after the report's number
    return packet.size() > wire::kDeviceCommandBytes &&
           wire::decode_device_command(packet.data() + 1, wire::kDeviceCommandBytes, command);
  }
  std::uint8_t plain[wire::kDeviceReportBytes];
  const std::size_t size = wire::cobs_decode(packet.data(), packet.size() - 1, plain, sizeof plain);
  return wire::decode_device_command(plain, size, command);
}

}  // namespace

void PulseWatch::commanded(std::span<const std::uint8_t> packet, cabinet::DeviceFraming framing,
                           std::int64_t now_us) {
  wire::DeviceCommand command{};
  if (!decode(packet, framing, command) || command.kind != wire::kPulseCommand) return;
  ++counts_.pulses;
  Motor& motor = motors_[command.rod];
  motor.end_us = now_us + 1000 * command.duration_ms + kMaxUs;
  motor.waiting.push_back(
      {now_us, command.amplitude, motor.amplitude == command.amplitude, writes_});
}

void PulseWatch::written(const MotorWrite& write) {
  Motor& motor = motors_[static_cast<std::size_t>(write.rod)];
  motor.amplitude = write.amplitude;
  const std::uint64_t before = writes_++;
  if (write.amplitude == 0) return;
  const auto pulse = std::ranges::find(motor.waiting, write.amplitude, &Pulse::amplitude);
  if (pulse == motor.waiting.end()) {
    ++counts_.stray;
    return;
  }
  ++counts_.begun;
  const auto latency = static_cast<float>(write.time_us - pulse->us);
  counts_.latency_us.push_back(latency);
  if (pulse->writes == before) counts_.free_latency_us.push_back(latency);
  counts_.merged += static_cast<std::uint64_t>(pulse - motor.waiting.begin());
  motor.waiting.erase(motor.waiting.begin(), pulse + 1);
}

void PulseWatch::passed(std::int64_t now_us) {
  for (Motor& motor : motors_) {
    while (!motor.waiting.empty() && now_us - motor.waiting.front().us > kMaxUs) {
      ++(motor.waiting.front().runs_already ? counts_.merged : counts_.missing);
      motor.waiting.pop_front();
    }
    if (motor.amplitude == 0 || now_us <= motor.end_us) continue;
    ++counts_.not_ended;
    motor.end_us = now_us + 1'000'000;
  }
}

}  // namespace cabinet_bench
