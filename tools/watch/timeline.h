// A recorded match that can be watched from any moment. A separate thread plays it once from the
// beginning and records marks (restore points), the goals, and whether the result equals the match
// that was played. A recording that is still being written is followed: new data is read as it
// arrives.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <tl/expected.hpp>
#include <vector>

#include "core/match_story.h"
#include "server/recorded_scene.h"

namespace watch {

inline constexpr std::uint64_t kMarkTicks = 2'000;  // initial interval of the marks
// Above this number every second mark is dropped: 40 MB. In three hours there is then a mark every
// 4 s, from which the simulation reaches any moment in about 50 ms.
inline constexpr std::size_t kMaxMarks = 4'096;

struct Goal {
  std::uint64_t tick;
  int team;  // that the goal counts for
};

struct Findings {
  std::uint64_t read = 0;   // ticks, from the beginning
  std::uint64_t total = 0;  // ticks that the file holds
  bool done = false;        // all of it is read
  bool being_made = false;  // a server is writing it; new data is read too
  server::Playback::Verdict verdict = server::Playback::Verdict::so_far;
  std::string sentence;  // of the verdict, once done
  std::vector<Goal> goals;
};

class Timeline {
 public:
  // Reads the whole file, which takes a while. The error is a sentence that names the file.
  static tl::expected<std::unique_ptr<Timeline>, std::string> open(const std::string& path);
  ~Timeline();

  // Plays forward to the tick, as far as the recording goes; events accumulate in the scene.
  void play_to(std::uint64_t tick);
  // Restores the last mark before the tick and plays from there, as far as the file was read.
  // False: the restored state differs from the recorded one, and nothing has changed.
  bool seek(std::uint64_t tick);

  server::RecordedScene& scene() { return scene_; }
  const server::RecordedScene& scene() const { return scene_; }
  // What a person has seen of the match up to the last seek().
  const client::MatchStory& story() const { return story_; }
  Findings findings() const;
  const std::string& path() const { return path_; }
  // Until the file's present data is read.
  void wait_until_read() const;
  // Checks now whether the file has grown, instead of at the next half-second interval. Waits until
  // a check that began after this call has ended. Returns at once if the file cannot grow any more.
  void look_now();

 private:
  struct Mark {
    server::RecordedScene::Mark scene;
    client::MatchStory story;
  };
  struct FileIdentity {
    dev_t device = 0;
    ino_t node = 0;
  };
  Timeline(std::string path, FileIdentity file, server::RecordedScene scene,
           server::RecordedScene reader);
  void run();
  void read(client::MatchStory& story);
  bool await_growth();
  bool look();
  bool grow();
  void note(const std::vector<wire::EventSnapshot>& events, const client::MatchStory& story);
  void leave_mark(const client::MatchStory& story);
  std::shared_ptr<const Mark> mark_before(std::uint64_t tick) const;
  void take_growth();

  std::string path_;
  FileIdentity file_;
  server::RecordedScene scene_;
  client::MatchStory story_;

  mutable std::mutex mutex_;  // guards the following
  Findings findings_;
  std::vector<std::shared_ptr<const Mark>> marks_;  // by tick
  std::uint64_t between_ = kMarkTicks;
  server::Playback::Bytes grown_;  // longer than the scene's, or null
  bool look_ = false;
  std::uint64_t looks_begun_ = 0, looks_ended_ = 0;
  bool over_ = false;  // the thread no longer checks
  mutable std::condition_variable changed_;

  server::RecordedScene reader_;  // used only by the thread
  std::uint64_t next_mark_ = kMarkTicks;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace watch
