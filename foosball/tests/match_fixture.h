// A match under the control of a test: rods moved by hand, commands, and states set through a
// snapshot.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "../src/match_save.h"
#include "foosball/match.h"

namespace foosball {

inline constexpr Rules kQuick{.goals_to_win = 5,
                              .max_goals = 8,
                              .lead = 2,
                              .dead_ball_seconds = 1.0,
                              .ceremony_seconds = 0.7,
                              .end_seconds = 0.8};

class MatchTest : public testing::Test {
 protected:
  explicit MatchTest(Layout layout = Layout::tournament, const Rules& rules = kQuick,
                     Mode mode = Mode::match)
      : desc{layout, 7, rules, mode} {
    match = std::make_unique<Match>(*Match::create(desc));
    for (RodTarget& rod : input.rods) rod.live = true;
  }

  const MatchView& view() const { return match->view(); }
  const TableSpec& table() const { return table_spec(desc.layout); }

  void step() {
    input.commands = commands;
    match->step(input);
    commands.clear();
    events.insert(events.end(), match->events().begin(), match->events().end());
  }
  void run(double seconds) {
    for (int i = 0; i < std::lround(seconds / kTick); ++i) step();
  }
  void command(Command::Kind kind, int team = 0, int value = 0) {
    commands.push_back({kind, static_cast<std::uint8_t>(team), static_cast<std::uint8_t>(value)});
    step();
  }
  const Event* last(EventKind kind) const {
    const auto found = std::find_if(events.rbegin(), events.rend(),
                                    [kind](const Event& event) { return event.kind == kind; });
    return found == events.rend() ? nullptr : &*found;
  }
  long count(EventKind kind) const {
    return std::count_if(events.begin(), events.end(),
                         [kind](const Event& event) { return event.kind == kind; });
  }

  // Moves one rod by hand to this slide and angle, in this time.
  void move(int rod, double slide, double angle, double seconds) {
    RodTarget& hand = input.rods[rod];
    const RodTarget from = hand;
    const int ticks = static_cast<int>(std::lround(seconds / kTick));
    for (int i = 1; i <= ticks; ++i) {
      hand.slide = from.slide + (slide - from.slide) * i / ticks;
      hand.angle = from.angle + (angle - from.angle) * i / ticks;
      hand.slide_rate = (slide - from.slide) / seconds;
      hand.angle_rate = (angle - from.angle) / seconds;
      step();
    }
    hand.slide_rate = hand.angle_rate = 0.0;
    run(0.05);
  }
  void push(int rod) {
    const int team = table().rods[rod].team;
    run(0.01);  // a stroke starts at rest
    move(rod, push_sign(team) * 0.06, input.rods[rod].angle, 0.15);
    move(rod, 0.0, input.rods[rod].angle, 0.15);
  }

  void start_by_commands() {
    command(Command::Kind::push, 0);
    command(Command::Kind::push, 0);
    command(Command::Kind::push, 1);
    ASSERT_EQ(view().screen, Screen::play);
  }

  void start_by_commands_from_here() {
    if (view().screen == Screen::logo) command(Command::Kind::push, 0);
    command(Command::Kind::push, 0);
    command(Command::Kind::push, 1);
    ASSERT_EQ(view().screen, Screen::play);
  }

  // Changes the state through a snapshot; the match continues from it.
  void arrange(const std::function<void(MatchState&, TableWorld&)>& change) {
    std::vector<std::byte> bytes;
    match->snapshot(bytes);
    MatchState state;
    auto world = std::make_unique<TableWorld>(desc.layout, bodies_of(desc, state), state.first);
    ASSERT_TRUE(load_match(desc, bytes, state, world));
    change(state, *world);
    bytes.clear();
    save_match(desc, state, *world, bytes);
    const auto restored = match->restore(bytes);
    ASSERT_TRUE(restored) << restored.error().message;
  }
  // A moving ball that two men have touched.
  void shoot(const vp::Vec3& from, const vp::Vec3& velocity, int toucher = 0) {
    arrange([&](MatchState& state, TableWorld& world) {
      state.screen = Screen::play;
      state.ball_in_play = true;
      state.ball_parked = state.ball_in_goal = false;
      state.touched = 0b11;
      state.last_toucher = toucher;
      const int rod = rods_of_team(table(), toucher)[3];
      state.touch = state.touch_of[toucher] = {rod, 1, state.tick, true};
      state.touch_of[1 - toucher] = {};
      state.watch.reset(from);
      world.set_ball(from, velocity);
    });
  }
  void shoot_goal(int scorer) {
    shoot({attack_sign(scorer) * 0.56, 0.08, 0.0174}, {attack_sign(scorer) * 5.0, 0.0, 0.0},
          scorer);
    run(0.1);
  }

  MatchDesc desc;
  std::unique_ptr<Match> match;
  TickInput input;
  std::vector<Command> commands;
  std::vector<Event> events;
};

}  // namespace foosball
