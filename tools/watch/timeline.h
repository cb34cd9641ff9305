// A recorded match that can be watched from any moment: a thread of its own plays it once from the
// beginning and leaves marks to go back to, the goals, and whether it is the match that was played.
// A recording that is still being made is followed: what is new is read as it comes.
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

inline constexpr std::uint64_t kMarkTicks = 2'000;  // between two marks, until they are too many
// Beyond, every second one is dropped: 40 MB. Three hours then have a mark each 4 s, from which the
// simulation takes about 50 ms to any moment.
inline constexpr std::size_t kMostMarks = 4'096;

struct Goal {
  std::uint64_t tick;
  int team;  // that it counts for
};

struct Findings {
  std::uint64_t read = 0;   // ticks, from the beginning
  std::uint64_t total = 0;  // ticks that the file holds
  bool done = false;        // all of it is read
  bool being_made = false;  // a server writes it; what comes is read too
  server::Playback::Verdict verdict = server::Playback::Verdict::so_far;
  std::string sentence;  // the verdict's, once done
  std::vector<Goal> goals;
};

class Timeline {
 public:
  // Reads all of the file, which takes a while. The error is a sentence that names it.
  static tl::expected<std::unique_ptr<Timeline>, std::string> open(const std::string& path);
  ~Timeline();

  // Plays on to the tick, as far as there is one; events gather in the scene.
  void play_to(std::uint64_t tick);
  // Goes there from the nearest mark before; as far as was read.
  // False: the state did not come out as it was, and nothing has changed.
  bool seek(std::uint64_t tick);

  server::RecordedScene& scene() { return scene_; }
  const server::RecordedScene& scene() const { return scene_; }
  // What a person would have been told up to the last seek().
  const client::MatchStory& story() const { return story_; }
  Findings findings() const;
  const std::string& path() const { return path_; }
  // Until all that the file holds is read.
  void wait_until_read() const;
  // Looks at once whether the file has grown, rather than twice a second, and waits until a look
  // that began after this call has ended. Returns at once if nothing more can come.
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

  mutable std::mutex mutex_;  // of what follows
  Findings findings_;
  std::vector<std::shared_ptr<const Mark>> marks_;  // by tick
  std::uint64_t between_ = kMarkTicks;
  server::Playback::Bytes grown_;  // longer than the scene's, or null
  bool look_ = false;
  std::uint64_t looks_begun_ = 0, looks_ended_ = 0;
  bool over_ = false;  // the thread looks no more
  mutable std::condition_variable news_;

  server::RecordedScene reader_;  // the thread's own
  std::uint64_t next_mark_ = kMarkTicks;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace watch
