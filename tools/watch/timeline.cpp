#include "timeline.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "os/file_descriptor.h"
#include "server/recordings.h"
#include "wire/enums.h"
#include "wire/read_file.h"

namespace watch {
namespace {

constexpr std::uint64_t kStepTicks = 20;  // the granularity at which the reader updates the story
constexpr std::chrono::milliseconds kLookAgain{500};
// This many earlier bytes are read again: a file that was replaced has not grown.
constexpr std::size_t kOverlap = 4'096;

// Reads `size` bytes from an offset; fewer at the file's end.
std::vector<std::byte> read_part(int file, std::size_t from, std::size_t size) {
  std::vector<std::byte> bytes(size);
  std::size_t got = 0;
  while (got < size) {
    const auto n = ::pread(file, bytes.data() + got, size - got, static_cast<off_t>(from + got));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    got += static_cast<std::size_t>(n);
  }
  bytes.resize(got);
  return bytes;
}

}  // namespace

tl::expected<std::unique_ptr<Timeline>, std::string> Timeline::open(const std::string& path) {
  const server::RecordingSummary summary = server::summarise_recording(path);
  if (summary.state == server::RecordingSummary::State::bad) return tl::unexpected(summary.problem);
  struct stat about {};
  FileIdentity file;
  if (::stat(path.c_str(), &about) == 0) file = {about.st_dev, about.st_ino};
  auto scene = server::RecordedScene::open(path);
  if (!scene) return tl::unexpected(scene.error());
  auto reader = scene->twin();
  if (!reader) return tl::unexpected(reader.error());
  return std::unique_ptr<Timeline>(new Timeline(path, file, std::move(*scene), std::move(*reader)));
}

Timeline::Timeline(std::string path, FileIdentity file, server::RecordedScene scene,
                   server::RecordedScene reader)
    : path_(std::move(path)), file_(file), scene_(std::move(scene)), reader_(std::move(reader)) {
  findings_.total = scene_.total_ticks();
  leave_mark({});
  thread_ = std::thread([this] { run(); });
}

Timeline::~Timeline() {
  {
    const std::lock_guard guard(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Timeline::run() {
  client::MatchStory story;
  do {
    read(story);
  } while (await_growth());
  {
    const std::lock_guard guard(mutex_);
    over_ = true;
  }
  changed_.notify_all();
}

// Reads all present data.
void Timeline::read(client::MatchStory& story) {
  bool more = true;
  while (more && !stop_) {
    more = reader_.advance_to(reader_.ticks() + kStepTicks);
    const auto events = reader_.take_events();
    story.update(events, reader_.snapshot(), 1e-3f * kStepTicks);
    note(events, story);
    if (reader_.ticks() < next_mark_) continue;
    leave_mark(story);
    next_mark_ = reader_.ticks() + between_;
  }
}

// False: no more data can come, or the timeline is being destroyed.
bool Timeline::await_growth() {
  const server::Playback& playback = reader_.playback();
  const bool open_end = playback.verdict() == server::Playback::Verdict::cut_short;
  const bool being_made = open_end && server::is_being_recorded(path_);
  {
    const std::lock_guard guard(mutex_);
    findings_.done = true;
    findings_.being_made = being_made;
    findings_.verdict = playback.verdict();
    findings_.sentence = playback.verdict_sentence();
  }
  changed_.notify_all();
  while (open_end && !stop_) {
    if (look()) return true;
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kLookAgain, [&] { return stop_ || look_; });
    look_ = false;
    lock.unlock();
    // The end may have been written since the last read.
    const bool still = server::is_being_recorded(path_);
    lock.lock();
    findings_.being_made = still;
  }
  return false;
}

// True: the same file has grown.
bool Timeline::look() {
  {
    const std::lock_guard guard(mutex_);
    ++looks_begun_;
  }
  const bool more = grow();
  {
    const std::lock_guard guard(mutex_);
    ++looks_ended_;
  }
  changed_.notify_all();
  return more;
}

bool Timeline::grow() {
  const auto& had = *reader_.playback().bytes();
  struct stat about {};
  const os::FileDescriptor file(
      ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!file || ::fstat(file.get(), &about) != 0 || !S_ISREG(about.st_mode) ||
      about.st_dev != file_.device || about.st_ino != file_.node ||
      static_cast<std::uint64_t>(about.st_size) <= had.size()) {
    return false;
  }
  const std::size_t end = std::min(static_cast<std::size_t>(about.st_size), wire::kMaxJournalFile);
  const std::size_t again = std::min(had.size(), kOverlap), from = had.size() - again;
  if (end <= had.size()) return false;
  const std::vector<std::byte> part = read_part(file.get(), from, end - from);
  if (part.size() <= again || std::memcmp(part.data(), had.data() + from, again) != 0) return false;
  std::vector<std::byte> bytes;
  bytes.reserve(from + part.size());
  bytes.insert(bytes.end(), had.begin(), had.begin() + static_cast<std::ptrdiff_t>(from));
  bytes.insert(bytes.end(), part.begin(), part.end());
  auto longer = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  reader_.extend(longer);
  const std::lock_guard guard(mutex_);
  grown_ = std::move(longer);
  findings_.total = reader_.total_ticks();
  return true;
}

// On the window's thread.
void Timeline::take_growth() {
  server::Playback::Bytes longer;
  std::uint64_t total = 0;
  {
    const std::lock_guard guard(mutex_);
    longer = std::exchange(grown_, nullptr);
    total = findings_.total;
  }
  if (longer) scene_.extend(std::move(longer), total);
}

void Timeline::note(const std::vector<wire::EventSnapshot>& events,
                    const client::MatchStory& story) {
  const std::lock_guard guard(mutex_);
  findings_.read = reader_.ticks();
  for (const wire::EventSnapshot& event : events) {
    if (event.kind == wire::number(wire::EventKind::goal))
      findings_.goals.push_back({reader_.ticks(), story.last_goal().team});
  }
}

void Timeline::leave_mark(const client::MatchStory& story) {
  auto mark = std::make_shared<const Mark>(Mark{reader_.mark(), story});
  const std::lock_guard guard(mutex_);
  marks_.push_back(std::move(mark));
  if (marks_.size() < kMaxMarks) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < marks_.size(); i += 2) marks_[kept++] = std::move(marks_[i]);
  marks_.resize(kept);
  between_ *= 2;
}

std::shared_ptr<const Timeline::Mark> Timeline::mark_before(std::uint64_t tick) const {
  const std::lock_guard guard(mutex_);
  const auto after = std::ranges::upper_bound(
      marks_, tick, {}, [](const auto& mark) { return mark->scene.place.ticks; });
  return *std::prev(after);  // the first mark is at 0
}

void Timeline::play_to(std::uint64_t tick) {
  take_growth();
  scene_.advance_to(tick);
}

bool Timeline::seek(std::uint64_t tick) {
  take_growth();
  tick = std::min(tick, std::max(findings().read, scene_.ticks()));
  const auto mark = mark_before(tick);
  if (!scene_.go_to(mark->scene)) return false;
  story_ = mark->story;
  while (scene_.ticks() < tick && scene_.advance_to(std::min(tick, scene_.ticks() + kStepTicks))) {
    story_.update(scene_.take_events(), scene_.snapshot(), 1e-3f * kStepTicks);
  }
  scene_.take_events();
  return true;
}

Findings Timeline::findings() const {
  const std::lock_guard guard(mutex_);
  return findings_;
}

void Timeline::wait_until_read() const {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return findings_.done && findings_.read >= findings_.total; });
}

void Timeline::look_now() {
  std::unique_lock lock(mutex_);
  look_ = true;
  changed_.notify_all();
  changed_.wait(lock, [&, wanted = looks_begun_ + 1] { return looks_ended_ >= wanted || over_; });
}

}  // namespace watch
