#pragma once

namespace cabinet {

bool is_mouse(int fd);  // an evdev device with two relative axes

// Opens a mouse for this program alone: locked, and grabbed, so that nobody else hears it; stamps
// of CLOCK_MONOTONIC. -1 and errno: EBUSY, another has it; ENOTTY: no mouse.
int open_mouse_line(const char* path);

}  // namespace cabinet
