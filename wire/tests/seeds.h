// The seeds of the fuzz targets, stored in wire/fuzz/corpus/TARGET/NAME. wire_fuzz_corpus writes
// them; a test compares them.
#pragma once

#include <string>
#include <vector>

#include "samples.h"

namespace wire::samples {

struct Seed {
  std::string target, name;
  Bytes bytes;
};

std::vector<Seed> seeds();

}  // namespace wire::samples
