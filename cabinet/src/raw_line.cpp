#include "raw_line.h"

#include <termios.h>

namespace cabinet {

void make_raw(int fd) {
  termios line{};
  if (tcgetattr(fd, &line) != 0) return;
  cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cc[VMIN] = 1;
  line.c_cc[VTIME] = 0;
  cfsetspeed(&line, B1000000);
  tcsetattr(fd, TCSANOW, &line);
}

}  // namespace cabinet
