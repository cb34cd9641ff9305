// CRC-32 as in zlib and Ethernet (reflected 0x04C11DB7, all ones before and after).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace wire {

std::uint32_t crc32(std::span<const std::byte> bytes);

}  // namespace wire
