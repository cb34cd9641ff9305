// Any text: rejected with a sentence, or a calibration that converts any counts to finite motion.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "cabinet/calibration.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto calibration = cabinet::parse_calibration(text, "fuzz");
  if (!calibration) {
    if (calibration.error().empty() || calibration.error().back() != '.') std::abort();
    return 0;
  }
  for (const auto& rod : calibration->rods) {
    const double determinant = rod.m[0][0] * rod.m[1][1] - rod.m[0][1] * rod.m[1][0];
    if (!std::isfinite(determinant) || determinant == 0) std::abort();
    if (rod.index && !std::isfinite(rod.index->angle + rod.index->width + rod.index->lag))
      std::abort();
    cabinet::RodIntegrator integrator(rod);
    const auto moved = integrator.add(32767, -32768, 2.0, 1e6);
    if (!std::isfinite(moved.slide) || !std::isfinite(moved.angle)) std::abort();
  }
  return 0;
}
