// core/sampling.h on the PC: one thread, so nothing needs blocking; tests read the lines from
// Ps2Lines.
#include "core/sampling.h"

namespace firmware {

void hold_sampling() {}
void resume_sampling() {}
void drive_lines(uint8_t, uint8_t) {}

}  // namespace firmware
