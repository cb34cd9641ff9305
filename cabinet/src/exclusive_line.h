#pragma once

namespace cabinet {

// Opens the device to read, for this program alone: no other server has it at the same time
// (flock), and a serial line no other program (TIOCEXCL; root may all the same). A tty is made raw
// at 1 Mbaud. -1 and errno; EBUSY: another has it. May wait for a USB device's answer.
int open_exclusively(const char* path);

}  // namespace cabinet
