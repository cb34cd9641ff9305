// Implementation of the match, shared by three files: match.cpp (one step), match_play.cpp (ball
// and referee) and match_screens.cpp (screens, modes).
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "match_state.h"
#include "table_world.h"

namespace foosball {

inline std::uint64_t to_ticks(double seconds) {
  return static_cast<std::uint64_t>(std::lround(seconds / kTick));
}

struct Match::Impl {
  explicit Impl(const MatchDesc& d);

  MatchDesc desc;
  MatchState state;
  std::unique_ptr<TableWorld> world;
  MatchView view;
  std::vector<Event> events;
  std::uint64_t events_dropped = 0;
  std::uint32_t matches_begun = 0;

  const TableSpec& table() const { return world->table(); }
  const Rules& rules() const { return state.game.rules; }
  int characters() const { return static_cast<int>(desc.characters.size()); }
  Mode mode() const { return state.attract ? Mode::match : state.game.mode; }

  // match.cpp
  void step(const TickInput& input);
  void apply(const Command& command);
  void drive_rods(const RodTargets& targets);
  void watch_hands(const RodTargets& hands, bool commanded);
  void leave_idle_screen();
  void refresh_view();
  void refresh_match_view();
  vp::Expected<void> restore(std::span<const std::byte> bytes);

  // match_play.cpp
  void watch_ball(const vp::Vec3& velocity_before);
  void note_contacts(const vp::Vec3& velocity_before);
  void note_touch(int rod, int man);
  void note_shot();
  void watch_rods(const RodTargets& hands);
  void judge_jarring(int rod, const RodTarget& hand);
  void judge_ball();
  bool judge_spin();
  void judge_goal(int scorer);
  void judge_possession();
  Touch credited(int scorer) const;
  void score_goal(int scorer, const Touch& by);
  void finish_set(int winner);
  void finish_undecided();
  void foul(Foul reason, int team);
  void serve_from(int rod, double delay, int man = -1);
  void serve_again();
  void put_in_play();
  bool find_position(int rod, int man, vp::Vec3& position);

  // match_screens.cpp
  void run_screen();
  void run_play();
  void run_time_out();
  void begin_training(int team);
  void ask_time_out(int team);
  void feed(int team, int value);
  void feed_to(int rod, int man);
  void feed_by_turn(int rod, int turn);
  void show_match();
  void read_gestures();
  void push(int team);
  void choose(int team, int character);
  void enter(Screen screen);
  void start_match();
  void start_play(int server);
  void new_set();
  void go_on_after_end();
  void set_up(const GameSetup& setup);
  int characters_to_draw() const;
  int person() const;
  int dice(int n);
  void tune(int index, double value);
  void rebuild_world();
  void reset_gestures();

  int rod_of(int team, Line line) const {
    return rods_of_team(table(), team)[static_cast<std::size_t>(line)];
  }
  // The man who gets the serve if none is named: the middle one; of two, the one to the team's
  // right.
  int middle_man(int rod) const {
    const RodSpec& spec = table().rods[rod];
    return spec.team == 0 ? spec.men / 2 : spec.men - 1 - spec.men / 2;
  }
  int feed_man() const { return state.feed_man >= 0 ? state.feed_man : middle_man(state.feed_rod); }
  bool last_set() const {
    return state.tally.sets[0] + state.tally.sets[1] + 1 >= 2 * rules().sets_to_win - 1;
  }
  void emit(const Event& event) {
    if (events.size() < kMaxEventsPerStep) {
      events.push_back(event);
    } else {
      ++events_dropped;
    }
  }
  void emit(EventKind kind, int team = 0, double value = 0.0) {
    emit(Event{.kind = kind,
               .team = static_cast<std::uint8_t>(team),
               .value = value,
               .point = world->ball().pose.position()});
  }
};

}  // namespace foosball
