// Derives from the events of a match what a person is told: who scored, from which line, own goals,
// shots, saves, the fastest shot, possession. Pure: depends only on the given events and scenes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "foosball/table.h"
#include "wire/snapshot.h"

namespace client {

struct GoalStory {
  int team = 0;                          // that the goal counts for
  int scorer_rod = -1, scorer_man = -1;  // of the last touch; -1: no touch
  bool own_goal = false;
  float speed = 0.0f;  // of the ball at the end of the last touch [m/s]
};

struct TeamStatistics {
  int shots = 0, saves = 0, own_goals = 0;
  float fastest_shot = 0.0f;  // [m/s]
  float possession = 0.0f;    // [s] that this team had the last touch of the ball
};

// The play has stopped for a goal and not for the time: the ball stays where it scored.
bool stopped_for_goal(const wire::Snapshot& scene);

// Moments that the crowd reacts to.
enum class Moment : std::uint8_t { shot, save, goal, own_goal };
struct StoryMoment {
  Moment moment;
  int team;        // of the shot, save or goal
  float strength;  // 0..1
};

class MatchStory {
 public:
  static constexpr float kShotSpeed = 2.5f;   // [m/s] towards the opponents' goal; slower: a pass
  static constexpr float kSaveWithin = 1.0f;  // [s] from a shot to a defender's touch: a save

  // The drawn scene and the events that it has reached. dt [s] of play.
  void update(std::span<const wire::EventSnapshot> events, const wire::Snapshot& scene, float dt);
  const std::vector<StoryMoment>& moments() const { return moments_; }  // of the last update
  const GoalStory& last_goal() const { return goal_; }
  const std::array<TeamStatistics, 2>& statistics() const { return statistics_; }
  int last_touch_team() const { return touch_.team; }  // -1: nobody
  float since_foul() const { return since_foul_; }     // [s]; the scene says which foul
  float since_serve() const { return since_serve_; }   // [s]
  bool set_over() const { return set_over_; }          // the play has stopped for the end of a set
  // The goals of each set whose end was observed, by the teams' present sides.
  const std::vector<std::array<int, 2>>& sets() const { return sets_; }

 private:
  struct Touch {
    int team = -1, rod = -1, man = -1;
  };
  void begin_match();
  void touch(const wire::EventSnapshot& event, const foosball::TableSpec& table);
  void watch_shot(const wire::Snapshot& scene, float dt);
  void score(const wire::EventSnapshot& event);
  void end_set(const wire::EventSnapshot& event, const wire::Snapshot& scene);
  void begin_set(const wire::Snapshot& scene);

  GoalStory goal_;
  std::array<TeamStatistics, 2> statistics_;
  std::vector<StoryMoment> moments_;
  Touch touch_;
  float since_touch_ = 0.0f;  // [s]
  float since_foul_ = 1e3f, since_serve_ = 1e3f;
  bool set_over_ = false;
  int set_winner_ = 0;
  std::vector<std::array<int, 2>> sets_;
  bool shot_judged_ = true;  // the last touch was classified: a shot or none
  int shooting_team_ = -1;
  float since_shot_ = 0.0f, shot_speed_ = 0.0f, speed_ = 0.0f;
};

}  // namespace client
