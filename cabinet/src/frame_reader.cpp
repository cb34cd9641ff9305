#include "frame_reader.h"

#include <algorithm>
#include <cstring>

#include "wire/device_settings.h"

namespace cabinet {

namespace {

bool is_padded(std::span<const std::uint8_t> report) {
  const auto padding = report.subspan(wire::kDeviceFrameBytes);
  return std::all_of(padding.begin(), padding.end(), [](std::uint8_t byte) { return byte == 0; });
}

// The answer to the controller page's request for the settings, which every reader receives.
bool tells_settings(std::span<const std::uint8_t> report) {
  return is_padded(report) && wire::is_settings_report(report.data(), wire::kDeviceFrameBytes);
}

}  // namespace

bool decode_report(std::span<const std::uint8_t> report, wire::DeviceFrame& frame) {
  return report.size() == wire::kDeviceReportBytes && is_padded(report) &&
         wire::decode_device_frame(report.data(), wire::kDeviceFrameBytes, frame);
}

void FrameReader::reset(Packing packing) {
  packing_ = packing;
  begin_ = end_ = 0;
  searching_ = false;
}

std::span<std::uint8_t> FrameReader::room() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  return std::span(buffer_).subspan(end_);
}

void FrameReader::filled(std::size_t bytes, SourceCounters& counters) {
  if (packing_ == Packing::report_message && bytes != wire::kDeviceReportBytes) {
    ++counters.bad;
    return;
  }
  end_ += std::min(bytes, buffer_.size() - end_);
}

bool FrameReader::next(wire::DeviceFrame& frame, SourceCounters& counters) {
  return packing_ == Packing::cobs ? next_cobs(frame, counters) : next_report(frame, counters);
}

bool FrameReader::next_cobs(wire::DeviceFrame& frame, SourceCounters& counters) {
  while (begin_ < end_) {
    const std::uint8_t* const first = buffer_.data() + begin_;
    const void* const zero = std::memchr(first, 0, end_ - begin_);
    if (zero == nullptr) {
      if (end_ - begin_ < wire::kDeviceCobsBytes) return false;
      if (!searching_) ++counters.bad;
      searching_ = true;  // too long for a frame: drop everything up to the next 0
      begin_ = end_ = 0;
      return false;
    }
    const auto size = static_cast<std::size_t>(static_cast<const std::uint8_t*>(zero) - first);
    begin_ += size + 1;
    if (searching_ || size == 0) {
      searching_ = false;
      continue;
    }
    std::uint8_t decoded[wire::kDeviceFrameBytes];
    const std::size_t got = wire::cobs_decode(first, size, decoded, sizeof decoded);
    if (wire::decode_device_frame(decoded, got, frame)) return true;
    if (!wire::is_settings_report(decoded, got)) ++counters.bad;
  }
  return false;
}

bool FrameReader::next_report(wire::DeviceFrame& frame, SourceCounters& counters) {
  while (end_ - begin_ >= wire::kDeviceReportBytes) {
    const std::span report{buffer_.data() + begin_, wire::kDeviceReportBytes};
    const bool is_frame = decode_report(report, frame);
    if (is_frame || tells_settings(report)) {
      begin_ += wire::kDeviceReportBytes;
      searching_ = false;
      if (is_frame) return true;
      continue;
    }
    if (!searching_) ++counters.bad;
    if (packing_ == Packing::report_message) {
      begin_ += wire::kDeviceReportBytes;
    } else {
      searching_ = true;
      ++begin_;
    }
  }
  return false;
}

}  // namespace cabinet
