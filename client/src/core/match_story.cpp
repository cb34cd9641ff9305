#include "core/match_story.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wire/enums.h"

namespace client {
namespace {

using Kind = wire::EventKind;

constexpr float kTouch = 0.004f;       // [N s]: a smaller impulse is leaning, no touch
constexpr float kAfterTouch = 0.02f;   // [s]: by then the ball has left the foot at its final speed
constexpr float kFastestShot = 12.0f;  // [m/s]: full strength

float speed_of(const wire::Snapshot& scene) {
  const auto& v = scene.ball.linear_velocity;
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

}  // namespace

bool stopped_for_goal(const wire::Snapshot& scene) {
  const auto screen = static_cast<wire::Screen>(scene.screen);
  return (screen == wire::Screen::ceremony || screen == wire::Screen::end) && scene.ball_visible;
}

void MatchStory::begin_match() {
  *this = MatchStory();
}

void MatchStory::touch(const wire::EventSnapshot& event, const foosball::TableSpec& table) {
  const int team = event.team == 1 ? 1 : 0, rod = std::min<int>(event.rod, foosball::kRods - 1);
  const foosball::Line line = table.rods[static_cast<std::size_t>(rod)].line;
  const bool defends = line == foosball::Line::goalie || line == foosball::Line::defence;
  if (shooting_team_ == 1 - team && defends && since_shot_ < kSaveWithin) {
    ++statistics_[static_cast<std::size_t>(team)].saves;
    moments_.push_back({Moment::save, team, std::min(shot_speed_ / kFastestShot, 1.0f)});
  }
  shooting_team_ = -1;
  touch_ = {team, rod, event.man};
  since_touch_ = 0.0f;
  shot_judged_ = false;
}

// The match itself reports which team the goal counts for.
void MatchStory::score(const wire::EventSnapshot& event) {
  const int team = event.team == 1 ? 1 : 0;
  const bool touched = touch_.team >= 0;
  goal_ = {team, touched ? event.rod : -1, touched ? event.man : -1, event.own, event.value};
  if (event.own) ++statistics_[static_cast<std::size_t>(1 - team)].own_goals;
  moments_.push_back({event.own ? Moment::own_goal : Moment::goal, team,
                      std::clamp(event.value / kFastestShot, 0.3f, 1.0f)});
  touch_ = {};
  shooting_team_ = -1;
}

// The score stays until the next set begins.
void MatchStory::end_set(const wire::EventSnapshot& event, const wire::Snapshot& scene) {
  const auto screen = static_cast<wire::Screen>(scene.screen);
  if (screen != wire::Screen::ceremony && screen != wire::Screen::end) return;
  set_over_ = true;
  set_winner_ = event.team == 1 ? 1 : 0;
  sets_.push_back({scene.score[0], scene.score[1]});
}

// The loser of the set serves (5). If that is now the winner's index, the sides were changed (13).
void MatchStory::begin_set(const wire::Snapshot& scene) {
  set_over_ = false;
  if (scene.next_server != set_winner_) return;
  for (std::array<int, 2>& set : sets_) std::swap(set[0], set[1]);
}

void MatchStory::watch_shot(const wire::Snapshot& scene, float dt) {
  since_touch_ += dt;
  since_shot_ += dt;
  if (!scene.ball_in_play || touch_.team < 0) return;
  auto& team = statistics_[static_cast<std::size_t>(touch_.team)];
  team.possession += dt;
  speed_ = speed_of(scene);
  if (shot_judged_ || since_touch_ < kAfterTouch) return;
  shot_judged_ = true;
  const auto ahead =
      static_cast<float>(foosball::attack_sign(touch_.team)) * scene.ball.linear_velocity[0];
  if (ahead < kShotSpeed) return;
  ++team.shots;
  team.fastest_shot = std::max(team.fastest_shot, speed_);
  shooting_team_ = touch_.team;
  since_shot_ = 0.0f;
  shot_speed_ = speed_;
  moments_.push_back({Moment::shot, touch_.team, std::min(speed_ / kFastestShot, 1.0f)});
}

void MatchStory::update(std::span<const wire::EventSnapshot> events, const wire::Snapshot& scene,
                        float dt) {
  moments_.clear();
  const auto screen = static_cast<wire::Screen>(scene.screen);
  if (screen == wire::Screen::logo || screen == wire::Screen::selection) begin_match();
  if (set_over_ && screen == wire::Screen::play) begin_set(scene);
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(scene.layout));
  for (const wire::EventSnapshot& event : events) {
    switch (static_cast<Kind>(event.kind)) {
      case Kind::man_hit:
        if (event.value > kTouch) touch(event, table);
        break;
      case Kind::goal:
        score(event);
        break;
      case Kind::serve:
        touch_ = {};
        shooting_team_ = -1;
        since_serve_ = 0.0f;
        break;
      case Kind::set_won:
      case Kind::match_won:
        end_set(event, scene);
        break;
      case Kind::foul:
        since_foul_ = 0.0f;
        break;
      default:
        break;
    }
  }
  since_foul_ += dt;
  since_serve_ += dt;
  watch_shot(scene, screen == wire::Screen::play && !scene.paused ? dt : 0.0f);
}

}  // namespace client
