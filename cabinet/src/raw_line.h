#pragma once

namespace cabinet {

// A tty: raw bytes at 1 Mbaud; a read of nothing is EAGAIN (VMIN 1), so that 0 only ever means
// hang-up. May wait for a USB device's answer.
void make_raw(int fd);

}  // namespace cabinet
