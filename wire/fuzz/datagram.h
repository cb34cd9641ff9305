// Shared by the fuzz targets of datagrams.
#pragma once

#include "samples.h"

// Reads the bytes unchanged, which mostly fails the checksum, and with a correct checksum.
template <class Read>
int read_as_is_and_sealed(const std::uint8_t* data, std::size_t size, Read read) {
  const auto in = std::as_bytes(std::span(data, size));
  wire::samples::Bytes bytes(in.begin(), in.end());
  read(bytes);
  wire::samples::reseal(bytes);
  read(bytes);
  return 0;
}
