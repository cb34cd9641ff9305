#include "server/log_writer.h"

#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "os/capabilities.h"
#include "os/file_descriptor.h"

namespace server {

struct LogWriter::State {
  explicit State(int descriptor) : owned(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0)) {}
  void run();
  bool put(const std::string& text);

  // A duplicate: an abandoned thread may still write when the caller's descriptor refers to another
  // file.
  const os::FileDescriptor owned;
  std::mutex mutex;  // guards all members below; never locked while writing
  std::condition_variable wake, idle;
  std::string waiting;
  std::uint64_t dropped = 0, dropped_unsaid = 0;
  bool writing = false, closing = false;
};

// False if the reader has gone, or the writer is abandoned.
bool LogWriter::State::put(const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    // A writable pipe accepts PIPE_BUF bytes at once.
    pollfd polled{owned.get(), POLLOUT, 0};
    constexpr int kLookAgainMs = 100;
    const int ready = ::poll(&polled, 1, kLookAgainMs);
    if (ready <= 0) {
      const std::lock_guard guard(mutex);
      if (closing) return false;
      continue;
    }
    const auto part = std::min<std::size_t>(text.size() - at, PIPE_BUF);
    const ssize_t size = ::write(owned.get(), text.data() + at, part);
    if (size < 0 && errno != EINTR && errno != EAGAIN) return false;
    if (size > 0) at += static_cast<std::size_t>(size);
  }
  return true;
}

void LogWriter::State::run() {
  os::drop_capabilities(false);
  std::unique_lock lock(mutex);
  while (true) {
    wake.wait(lock, [this] { return !waiting.empty() || dropped_unsaid > 0 || closing; });
    if (waiting.empty() && closing) return;
    std::string text = std::exchange(waiting, {});
    if (dropped_unsaid > 0) {
      text.append("(").append(std::to_string(dropped_unsaid));
      text.append(" lines were omitted here: nobody read them in time)\n");
      dropped_unsaid = 0;
    }
    writing = true;
    lock.unlock();
    put(text);
    lock.lock();
    writing = false;
    idle.notify_all();
  }
}

LogWriter::LogWriter(int fd) : state_(std::make_shared<State>(fd)) {
  std::thread([state = state_] { state->run(); }).detach();
}

LogWriter::~LogWriter() {
  flush(kPatienceUs);
  const std::lock_guard guard(state_->mutex);
  state_->closing = true;
  state_->waiting.clear();
  state_->wake.notify_all();
}

void LogWriter::write(const std::string& text) {
  const std::lock_guard guard(state_->mutex);
  if (state_->waiting.size() + text.size() > kMaxWaiting) {
    ++state_->dropped;
    ++state_->dropped_unsaid;
    return;
  }
  state_->waiting += text;
  state_->wake.notify_all();
}

bool LogWriter::flush(std::int64_t patience_us) {
  std::unique_lock lock(state_->mutex);
  return state_->idle.wait_for(lock, std::chrono::microseconds(patience_us),
                               [this] { return state_->waiting.empty() && !state_->writing; });
}

std::uint64_t LogWriter::dropped() const {
  const std::lock_guard guard(state_->mutex);
  return state_->dropped;
}

}  // namespace server
