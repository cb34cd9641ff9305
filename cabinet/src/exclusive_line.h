#pragma once

namespace cabinet {

// Opens the device for reading, exclusively: no other server has it at the same time (flock), and
// no other program has a serial line (TIOCEXCL; root still can). Sets a tty to raw mode at 1 Mbaud.
// Returns -1 and errno on failure; EBUSY: another program has it. May block until a USB device
// answers.
int open_exclusively(const char* path);

}  // namespace cabinet
