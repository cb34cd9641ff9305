#include "journal_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <span>

#include "os/capabilities.h"
#include "os/file_descriptor.h"
#include "server/byte_ring.h"

namespace server {
namespace {

using Clock = std::chrono::steady_clock;  // for sync times; does not affect the match

bool begins_as_a_recording(const std::string& path) {
  const os::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  constexpr std::size_t kRecordHead = 8;
  std::array<std::byte, kRecordHead + wire::kMaxJournalHeader> start;
  const ssize_t size = file ? ::read(file.get(), start.data(), start.size()) : -1;
  if (size <= 0) return false;
  const std::span<const std::byte> bytes(start.data(), static_cast<std::size_t>(size));
  if (wire::other_journal_format(bytes)) return true;
  wire::JournalReader reader(bytes);
  const auto entry = reader.next();
  return entry && std::holds_alternative<wire::JournalHeader>(*entry);
}

std::string errno_text(int number) {
  return std::strerror(number);
}

// Empty, or the reason why it must not be written. File systems without locks are accepted.
std::string lock(int file) {
  if (::flock(file, LOCK_EX | LOCK_NB) == 0) return {};
  if (errno != EWOULDBLOCK) return {};
  return "another server is writing it; choose another name, or end that server";
}

// Truncates an existing recording if allowed. Empty, or the reason why the file must not be
// changed, and what to do.
std::string objection(int file, const JournalFileOptions& options) {
  struct stat about {};
  if (::fstat(file, &about) != 0) return errno_text(errno) + "; try again";
  if (S_ISCHR(about.st_mode)) return {};  // such as /dev/null: any number may write it
  if (std::string why = lock(file); !why.empty()) return why;
  if (!S_ISREG(about.st_mode) || about.st_size == 0) return {};
  if (!begins_as_a_recording(options.path)) {
    return "a file of that name exists and is not a recording; choose another name";
  }
  if (!options.overwrite) {
    return "a recording of that name exists; choose another name, remove it, or give --overwrite";
  }
  if (::ftruncate(file, 0) != 0) return errno_text(errno) + "; remove the old one";
  return {};
}

}  // namespace

// The file and the state of the journal thread.
class JournalFile::Writer {
 public:
  Writer(const JournalFileOptions& options, os::FileDescriptor file, os::FileDescriptor wake)
      : options_(options),
        file_(std::move(file)),
        wake_(std::move(wake)),
        ring_(options.ring_bytes) {}

  enum class Failure : int { none, ring_full, write_failed, stalled, too_large };

  // Tick thread.
  bool write(std::span<const std::byte> bytes) { return ring_.write(bytes); }
  void close() {
    closing_.store(true, std::memory_order_release);
    signal();
  }
  // Never blocks: the counter of an eventfd cannot overflow with this number of writes.
  void signal() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t ignored = ::write(wake_.get(), &one, sizeof one);
  }

  // Any thread.
  void fail(Failure failure, int error_number) {
    error_number_.store(error_number, std::memory_order_relaxed);
    Failure none = Failure::none;
    failure_.compare_exchange_strong(none, failure, std::memory_order_acq_rel);
  }
  bool failed() const { return failure_.load(std::memory_order_acquire) != Failure::none; }
  wire::Sentence problem() const;
  std::uint64_t written() const { return written_.load(std::memory_order_relaxed); }

  // The journal's thread.
  void run();

 private:
  bool drain();
  bool wait_writable();
  void wait_for_work();
  bool sync();

  const JournalFileOptions options_;
  const os::FileDescriptor file_, wake_;
  ByteRing ring_;
  std::atomic<std::uint64_t> written_{0};
  std::atomic<Failure> failure_{Failure::none};
  std::atomic<int> error_number_{0};
  std::atomic<bool> closing_{false};
  // Used by the journal's thread only.
  bool unsynced_ = false;
  Clock::time_point synced_ = Clock::now();
};

wire::Sentence JournalFile::Writer::problem() const {
  using wire::SentenceId, wire::make_sentence;
  const std::string& path = options_.path;
  switch (failure_.load(std::memory_order_acquire)) {
    case Failure::none:
      return {};
    case Failure::ring_full:
      return make_sentence<SentenceId::disk_too_slow>(path);
    case Failure::write_failed:
      return make_sentence<SentenceId::recording_failed>(
          path, errno_text(error_number_.load(std::memory_order_relaxed)));
    case Failure::too_large:
      return make_sentence<SentenceId::recording_too_large>(path, options_.max_bytes >> 20);
    case Failure::stalled:
      return make_sentence<SentenceId::recording_stalled>(path);
  }
  return {};
}

void JournalFile::Writer::run() {
  while (true) {
    const bool closing = closing_.load(std::memory_order_acquire);
    if (!drain()) return;
    const bool due = Clock::now() - synced_ >= options_.sync_period;
    if ((closing || (unsynced_ && due)) && !sync()) return;
    if (closing) return;
    wait_for_work();
  }
}

// Waits for data to write, or until written data must be synced.
void JournalFile::Writer::wait_for_work() {
  int timeout_ms = -1;
  if (unsynced_) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(synced_ + options_.sync_period - Clock::now());
    timeout_ms = static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1'000'000));
  }
  pollfd ready{wake_.get(), POLLIN, 0};
  if (::poll(&ready, 1, timeout_ms) <= 0) return;
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t ignored = ::read(wake_.get(), &count, sizeof count);
}

// False if the disk failed. A pipe or a device cannot be synced: EINVAL.
bool JournalFile::Writer::sync() {
  const bool ok = ::fdatasync(file_.get()) == 0 || errno == EINVAL;
  if (!ok) fail(Failure::write_failed, errno);
  unsynced_ = false;
  synced_ = Clock::now();
  return ok;
}

// Waits until the reader of a full pipe takes data. False if it has not by the end.
bool JournalFile::Writer::wait_writable() {
  constexpr int kLook_ms = 20;  // interval of the check for the end
  std::optional<Clock::time_point> closing_since;
  while (true) {
    pollfd ready{file_.get(), POLLOUT, 0};
    if (::poll(&ready, 1, kLook_ms) != 0) return true;  // write() reports an error, if there is one
    if (!closing_.load(std::memory_order_acquire)) continue;
    const auto now = Clock::now();
    if (!closing_since) closing_since = now;
    if (now - *closing_since < options_.close_patience) continue;
    fail(Failure::stalled, 0);
    return false;
  }
}

// False if the file accepts no more. A record that is truncated by that is where a reader stops.
bool JournalFile::Writer::drain() {
  for (auto piece = ring_.peek(); !piece.empty(); piece = ring_.peek()) {
    const ssize_t size = ::write(file_.get(), piece.data(), piece.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && errno == EAGAIN) {
      if (!wait_writable()) return false;
      continue;
    }
    if (size <= 0) {
      fail(Failure::write_failed, errno);
      return false;
    }
    ring_.consume(static_cast<std::size_t>(size));
    written_.fetch_add(static_cast<std::uint64_t>(size), std::memory_order_relaxed);
    unsynced_ = true;
  }
  return true;
}

// --- the tick thread's side

// O_NONBLOCK: a pipe without a reader is rejected; a full pipe is waited for by poll(), which can
// be interrupted. It has no effect on files.
tl::expected<std::unique_ptr<JournalFile>, std::string> JournalFile::create(
    const JournalFileOptions& options) {
  constexpr mode_t kMode = 0666;  // minus the umask
  const auto refused = [&](const std::string& why) {
    return tl::unexpected("cannot record to " + options.path + ": " + why);
  };
  os::FileDescriptor file(
      ::open(options.path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, kMode));
  if (!file && errno == ENXIO) return refused("nobody reads this pipe; start its reader first");
  if (!file) return refused(errno_text(errno) + "; choose a file in a folder that can be written");
  if (const std::string why = objection(file.get(), options); !why.empty()) return refused(why);
  os::FileDescriptor wake(::eventfd(0, EFD_CLOEXEC));
  if (!wake) return tl::unexpected("cannot record: " + errno_text(errno));
  return std::unique_ptr<JournalFile>(new JournalFile(
      options, std::make_shared<Writer>(options, std::move(file), std::move(wake))));
}

JournalFile::JournalFile(const JournalFileOptions& options, std::shared_ptr<Writer> writer)
    : close_patience_(options.close_patience),
      room_(options.max_bytes),
      writer_(std::move(writer)) {
  encoded_.reserve(std::size_t{2} << 20);
  std::promise<void> end;
  ended_ = end.get_future();
  thread_ = std::thread([writer = writer_, end = std::move(end)]() mutable {
    os::drop_capabilities(false);  // its file is open
    writer->run();
    end.set_value();
  });
}

JournalFile::~JournalFile() {
  close();
}

void JournalFile::add(const wire::JournalEntry& entry) {
  if (failed()) {
    ++dropped_;
    return;
  }
  if (!encoder_.add(entry, encoded_)) ++dropped_;
  push();
}

void JournalFile::push() {
  if (encoded_.empty()) return;
  if (encoded_.size() > room_) {
    ++dropped_;
    writer_->fail(Writer::Failure::too_large, 0);
  } else if (writer_->write(encoded_)) {
    room_ -= encoded_.size();
    writer_->signal();
  } else {
    ++dropped_;
    writer_->fail(Writer::Failure::ring_full, 0);
  }
  encoded_.clear();
}

// The thread gives a full pipe close_patience. A system call that does not return is abandoned
// after twice that time, together with the data it uses.
void JournalFile::close() {
  if (!thread_.joinable()) return;
  if (!failed()) {
    encoder_.flush(encoded_);
    push();
  }
  writer_->close();
  if (ended_.wait_for(2 * close_patience_) == std::future_status::ready) {
    thread_.join();
  } else {
    writer_->fail(Writer::Failure::stalled, 0);
    thread_.detach();
  }
}

wire::Sentence JournalFile::problem() const {
  return writer_->problem();
}
bool JournalFile::failed() const {
  return writer_->failed();
}
std::uint64_t JournalFile::bytes_written() const {
  return writer_->written();
}

}  // namespace server
