#pragma once

namespace cabinet {

// Sets a tty to raw bytes at 1 Mbaud. A read without data returns EAGAIN (VMIN 1), so that 0 always
// means hang-up. May block until a USB device answers.
void make_raw(int fd);

}  // namespace cabinet
