#pragma once

namespace cabinet {

bool is_mouse(int fd);  // an evdev device with two relative axes

// Opens a mouse exclusively: locked, and grabbed, so that no other program gets its events. Stamps
// are of CLOCK_MONOTONIC. Returns -1 and errno on failure: EBUSY: another program has it; ENOTTY:
// not a mouse.
int open_mouse_line(const char* path);

}  // namespace cabinet
