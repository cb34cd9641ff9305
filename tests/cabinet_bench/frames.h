// Decodes the frames in a controller's data.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "cabinet/device_source.h"
#include "wire/device_frame.h"

namespace cabinet_bench {

class Frames {
 public:
  explicit Frames(cabinet::DeviceFraming framing) : framing_(framing) {}

  void take(std::span<const std::uint8_t> bytes,
            const std::function<void(const wire::DeviceFrame&)>& each) {
    wire::DeviceFrame frame;
    if (framing_ == cabinet::DeviceFraming::report) {
      if (wire::decode_device_frame(bytes.data(), wire::kDeviceFrameBytes, frame)) each(frame);
      return;
    }
    for (const std::uint8_t byte : bytes) {
      if (byte != 0) {
        pending_.push_back(byte);
        continue;
      }
      std::uint8_t plain[wire::kDeviceReportBytes];
      const std::size_t size =
          wire::cobs_decode(pending_.data(), pending_.size(), plain, sizeof plain);
      if (wire::decode_device_frame(plain, size, frame)) each(frame);
      pending_.clear();
    }
  }

 private:
  cabinet::DeviceFraming framing_;
  std::vector<std::uint8_t> pending_;
};

}  // namespace cabinet_bench
