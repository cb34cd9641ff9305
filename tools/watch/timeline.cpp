#include "timeline.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <utility>

#include "wire/enums.h"

namespace watch {
namespace {

constexpr std::uint64_t kStepTicks = 20;  // how finely the reader follows what a person is told

std::uint64_t size_of(const std::string& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return error ? 0 : size;
}

}  // namespace

tl::expected<std::unique_ptr<Timeline>, std::string> Timeline::open(const std::string& path) {
  const std::uint64_t bytes = size_of(path);  // before it is read: what comes later is news
  auto scene = server::RecordedScene::open(path);
  if (!scene) return tl::unexpected(scene.error());
  auto reader = scene->twin();
  if (!reader) return tl::unexpected(reader.error());
  return std::unique_ptr<Timeline>(
      new Timeline(path, bytes, std::move(*scene), std::move(*reader)));
}

Timeline::Timeline(std::string path, std::uint64_t bytes, server::RecordedScene scene,
                   server::RecordedScene reader)
    : path_(std::move(path)), bytes_(bytes), scene_(std::move(scene)), reader_(std::move(reader)) {
  findings_.total = scene_.total_ticks();
  leave_mark({});
  thread_ = std::thread([this] { read(); });
}

Timeline::~Timeline() {
  stop_ = true;
  thread_.join();
}

void Timeline::read() {
  client::MatchStory story;
  std::uint64_t next_mark = kMarkTicks;
  bool more = true;
  while (more && !stop_) {
    more = reader_.advance_to(reader_.ticks() + kStepTicks);
    const auto events = reader_.take_events();
    story.update(events, reader_.snapshot(), 1e-3f * kStepTicks);
    note(events, story);
    if (reader_.ticks() < next_mark) continue;
    leave_mark(story);
    next_mark = reader_.ticks() + between_;
  }
  {
    const std::lock_guard guard(mutex_);
    findings_.done = !more;
    findings_.verdict = reader_.playback().verdict();
    findings_.sentence = reader_.playback().verdict_sentence();
  }
  finished_ = true;
  finished_.notify_all();
}

void Timeline::note(const std::vector<wire::EventSnapshot>& events,
                    const client::MatchStory& story) {
  const std::lock_guard guard(mutex_);
  const auto& score = reader_.snapshot().score;
  findings_.read = reader_.ticks();
  // A new match begins at 0 : 0; the last score stands for the match before it.
  if (score[0] + score[1] > 0) findings_.last_score = {score[0], score[1]};
  for (const wire::EventSnapshot& event : events) {
    if (event.kind != wire::number(wire::EventKind::goal)) continue;
    findings_.goals.push_back({reader_.ticks(), story.last_goal().team, {score[0], score[1]}});
  }
}

void Timeline::leave_mark(const client::MatchStory& story) {
  auto mark = std::make_shared<const Mark>(Mark{reader_.mark(), story});
  const std::lock_guard guard(mutex_);
  marks_.push_back(std::move(mark));
  if (marks_.size() < kMostMarks) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < marks_.size(); i += 2) marks_[kept++] = std::move(marks_[i]);
  marks_.resize(kept);
  between_ *= 2;
}

std::shared_ptr<const Timeline::Mark> Timeline::mark_before(std::uint64_t tick) const {
  const std::lock_guard guard(mutex_);
  const auto after = std::ranges::upper_bound(
      marks_, tick, {}, [](const auto& mark) { return mark->scene.place.ticks; });
  return *std::prev(after);  // the first is at 0
}

void Timeline::play_to(std::uint64_t tick) {
  scene_.advance_to(tick);
}

bool Timeline::seek(std::uint64_t tick) {
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

bool Timeline::has_grown() const {
  return size_of(path_) > bytes_;
}

void Timeline::wait_until_read() const {
  finished_.wait(false);
}

std::string telling_name(const Timeline& timeline) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto written = fs::last_write_time(timeline.path(), error);
  const auto system = std::chrono::file_clock::to_sys(written);
  const std::time_t time =
      std::chrono::system_clock::to_time_t(std::chrono::floor<std::chrono::seconds>(system));
  std::tm local{};
  ::localtime_r(&time, &local);
  char when[32] = "match";
  if (!error) std::strftime(when, sizeof when, "%Y-%m-%d %H.%M", &local);
  const Findings findings = timeline.findings();
  const bool paper = timeline.scene().playback().match().layout == foosball::Layout::paper;
  return std::string("space-foosball ") + when + (paper ? " paper " : " tournament ") +
         std::to_string(findings.last_score[0]) + "-" + std::to_string(findings.last_score[1]) +
         ".sfr";
}

tl::expected<std::string, std::string> share(const Timeline& timeline, const std::string& folder) {
  namespace fs = std::filesystem;
  timeline.wait_until_read();
  const fs::path name = telling_name(timeline);
  std::error_code error;
  for (int i = 1; i < 1000; ++i) {
    const std::string number = i == 1 ? "" : " (" + std::to_string(i) + ")";
    const fs::path to = fs::path(folder) / (name.stem().string() + number + ".sfr");
    if (fs::exists(to, error)) continue;
    if (fs::copy_file(timeline.path(), to, error)) return to.string();
    break;
  }
  return tl::unexpected("The recording cannot be copied to " + folder + " (" +
                        (error ? error.message() : "too many of that name") +
                        "): choose a folder that can be written with --share.");
}

}  // namespace watch
