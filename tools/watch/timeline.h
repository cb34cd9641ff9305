// A recorded match that can be watched from any moment: a thread of its own plays it once from the
// beginning and leaves marks to go back to, the goals, and whether it is the match that was played.
#pragma once

#include <atomic>
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
  std::array<int, 2> score;
};

struct Findings {
  std::uint64_t read = 0;   // ticks, from the beginning
  std::uint64_t total = 0;  // ticks that the file holds
  bool done = false;        // all of it is read
  server::Playback::Verdict verdict = server::Playback::Verdict::so_far;
  std::string sentence;  // the verdict's, once done
  std::vector<Goal> goals;
  std::array<int, 2> last_score{};
};

class Timeline {
 public:
  // The error is a sentence that names the file.
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
  // The file has become longer since it was opened, as it does while a match is played.
  bool has_grown() const;
  void wait_until_read() const;

 private:
  struct Mark {
    server::RecordedScene::Mark scene;
    client::MatchStory story;
  };
  Timeline(std::string path, std::uint64_t bytes, server::RecordedScene scene,
           server::RecordedScene reader);
  void read();
  void note(const std::vector<wire::EventSnapshot>& events, const client::MatchStory& story);
  void leave_mark(const client::MatchStory& story);
  std::shared_ptr<const Mark> mark_before(std::uint64_t tick) const;

  std::string path_;
  std::uint64_t bytes_;
  server::RecordedScene scene_;
  client::MatchStory story_;

  mutable std::mutex mutex_;  // of what follows
  Findings findings_;
  std::vector<std::shared_ptr<const Mark>> marks_;  // by tick
  std::uint64_t between_ = kMarkTicks;

  server::RecordedScene reader_;  // the thread's own
  std::atomic<bool> stop_{false}, finished_{false};
  std::thread thread_;
};

// "space-foosball 2026-11-22 21.40 paper 5-3.sfr": when it was recorded, table, score.
std::string telling_name(const Timeline& timeline);
// Copies the recording into the folder under that name, never over another file; the path it has
// there. Waits until all of it is read, for the score.
tl::expected<std::string, std::string> share(const Timeline& timeline, const std::string& folder);

}  // namespace watch
