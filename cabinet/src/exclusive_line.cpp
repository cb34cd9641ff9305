#include "exclusive_line.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>

#include "os/file_descriptor.h"
#include "raw_line.h"

namespace cabinet {

int open_exclusively(const char* path) {
  constexpr int kHow = O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
  os::FileDescriptor fd(::open(path, O_RDWR | kHow));
  // A read-only device still works, without haptics.
  if (!fd && (errno == EACCES || errno == EROFS))
    fd = os::FileDescriptor(::open(path, O_RDONLY | kHow));
  if (!fd) return -1;
  if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) errno = EBUSY;
    const int error = errno;
    fd.reset();
    errno = error;
    return -1;
  }
  if (::isatty(fd.get()) != 0) {
    ::ioctl(fd.get(), TIOCEXCL);
    make_raw(fd.get());
  }
  return fd.release();
}

}  // namespace cabinet
