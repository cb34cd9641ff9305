// The host's side of core/sampling.h: one thread, so nothing needs holding; tests read the lines
// back.
#include "core/sampling.h"

namespace firmware {

void hold_sampling() {}
void resume_sampling() {}
void drive_lines(uint8_t, uint8_t) {}

}  // namespace firmware
