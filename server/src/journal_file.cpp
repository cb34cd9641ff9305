#include "journal_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace server {
namespace {

bool begins_as_a_recording(const std::string& path) {
  const os::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::array<std::byte, 256> start;  // a header is 49 bytes
  const ssize_t size = file ? ::read(file.get(), start.data(), start.size()) : -1;
  if (size <= 0) return false;
  wire::JournalReader reader({start.data(), static_cast<std::size_t>(size)});
  const auto entry = reader.next();
  return entry && std::holds_alternative<wire::JournalHeader>(*entry);
}

// Makes the file an empty one. Empty, or why it must stay as it is and what to do.
std::string objection(int file, const JournalFileOptions& options) {
  struct stat about {};
  if (::fstat(file, &about) != 0) return std::string(std::strerror(errno)) + "; try again";
  if (!S_ISREG(about.st_mode) || about.st_size == 0) return {};
  if (!begins_as_a_recording(options.path)) {
    return "there is a file of that name that is no recording; choose another name";
  }
  if (!options.overwrite) {
    return "there is a recording already; choose another name, remove it, or give --overwrite";
  }
  if (::ftruncate(file, 0) != 0) return std::string(std::strerror(errno)) + "; remove the old one";
  return {};
}

}  // namespace

tl::expected<std::unique_ptr<JournalFile>, std::string> JournalFile::create(
    const JournalFileOptions& options) {
  os::FileDescriptor file(::open(options.path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644));
  if (!file) {
    return tl::unexpected("cannot record to " + options.path + ": " + std::strerror(errno) +
                          "; choose a file in a folder that can be written");
  }
  if (const std::string why = objection(file.get(), options); !why.empty()) {
    return tl::unexpected("cannot record to " + options.path + ": " + why);
  }
  os::FileDescriptor wake(::eventfd(0, EFD_CLOEXEC));
  if (!wake) return tl::unexpected("cannot record: " + std::string(std::strerror(errno)));
  return std::unique_ptr<JournalFile>(new JournalFile(options, std::move(file), std::move(wake)));
}

JournalFile::JournalFile(const JournalFileOptions& options, os::FileDescriptor file,
                         os::FileDescriptor wake)
    : path_(options.path),
      file_(std::move(file)),
      wake_(std::move(wake)),
      ring_(options.ring_bytes),
      thread_([this] { write_loop(); }) {
  encoded_.reserve(std::size_t{2} << 20);
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
  if (ring_.write(encoded_)) {
    signal();
  } else {
    ++dropped_;
    fail(Failure::ring_full, 0);
  }
  encoded_.clear();
}

void JournalFile::close() {
  if (!thread_.joinable()) return;
  if (!failed()) {
    encoder_.flush(encoded_);
    push();
  }
  closing_.store(true, std::memory_order_release);
  signal();
  thread_.join();
}

// An eventfd's counter cannot be full with this many writes, so the call never waits.
void JournalFile::signal() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t ignored = ::write(wake_.get(), &one, sizeof one);
}

void JournalFile::fail(Failure failure, int error_number) {
  error_number_.store(error_number, std::memory_order_relaxed);
  Failure none = Failure::none;
  failure_.compare_exchange_strong(none, failure, std::memory_order_acq_rel);
}

std::string JournalFile::problem() const {
  switch (failure_.load(std::memory_order_acquire)) {
    case Failure::none:
      return {};
    case Failure::ring_full:
      return "recording to " + path_ + " ended early: the disk is too slow; play goes on";
    case Failure::write_failed:
      return "recording to " + path_ +
             " ended early: " + std::strerror(error_number_.load(std::memory_order_relaxed)) +
             "; play goes on";
  }
  return {};
}

void JournalFile::write_loop() {
  while (true) {
    const bool closing = closing_.load(std::memory_order_acquire);
    if (!drain()) return;
    if (closing) return sync();
    std::uint64_t count = 0;
    [[maybe_unused]] const ssize_t ignored = ::read(wake_.get(), &count, sizeof count);
  }
}

// A pipe or a device has no disk to wait for: EINVAL.
void JournalFile::sync() {
  if (::fdatasync(file_.get()) != 0 && errno != EINVAL) fail(Failure::write_failed, errno);
}

// False when the file can take no more. A record cut in two by that is where its reader stops.
bool JournalFile::drain() {
  for (auto piece = ring_.peek(); !piece.empty(); piece = ring_.peek()) {
    const ssize_t size = ::write(file_.get(), piece.data(), piece.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) {
      fail(Failure::write_failed, errno);
      return false;
    }
    ring_.consume(static_cast<std::size_t>(size));
    written_.fetch_add(static_cast<std::uint64_t>(size), std::memory_order_relaxed);
  }
  return true;
}

}  // namespace server
