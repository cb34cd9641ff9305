// Statistics of matches, as counts: a pure observer of each tick's view, events and targets.
// docs/match-runner.md defines each quantity derived from these counts.
//
// All counts are integers, and distributions are histograms, so the totals of many matches do not
// depend on the order of addition. No clock, no allocation.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "foosball/match.h"
#include "foosball/played_pass.h"
#include "foosball/reach.h"

namespace foosball {

// Histogram with bins of equal width [1e-6 of the value's unit], from 0. The last bin counts all
// larger values.
template <int kBinCount, int kWidthMicro>
struct Histogram {
  static constexpr int kBins = kBinCount;
  static constexpr double kWidth = kWidthMicro * 1e-6;

  std::array<std::uint64_t, kBinCount> bins{};

  void add(double value) {
    const double bin = std::clamp(value / kWidth, 0.0, kBinCount - 1.0);
    ++bins[static_cast<std::size_t>(bin)];
  }
  std::uint64_t count() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t bin : bins) sum += bin;
    return sum;
  }
  // Precondition: 0 <= fraction <= 1. Linear within a bin; 0 if empty.
  double quantile(double fraction) const {
    const double rank = fraction * static_cast<double>(count());
    double below = 0.0;
    for (std::size_t i = 0; i < bins.size(); ++i) {
      const double here = static_cast<double>(bins[i]);
      if (here > 0.0 && below + here >= rank) {
        return (static_cast<double>(i) + (rank - below) / here) * kWidth;
      }
      below += here;
    }
    return 0.0;
  }
  // Mean of the bins' centres.
  double mean() const {
    const std::uint64_t n = count();
    double sum = 0.0;
    for (std::size_t i = 0; i < bins.size(); ++i) {
      sum += (static_cast<double>(i) + 0.5) * static_cast<double>(bins[i]);
    }
    return n == 0 ? 0.0 : kWidth * sum / static_cast<double>(n);
  }
  bool operator==(const Histogram&) const = default;
};

using PerTeam = std::array<std::uint64_t, kTeams>;
using PerRod = std::array<std::uint64_t, kRods>;

struct Statistics {
  // Matches.
  PerTeam wins{};
  std::uint64_t undecided = 0;        // abandoned before a team won
  std::uint64_t lead_changes = 0;     // the lead passed to the team that was behind
  Histogram<180, 10'000'000> length;  // playing time of a decided match [s]

  // Time in ticks, on the play screen while not paused.
  std::uint64_t ticks = 0;              // steps on any screen
  std::uint64_t play_ticks = 0;         // on the play screen
  std::uint64_t ball_ticks = 0;         // with the ball in play; the counts below are parts of it
  std::uint64_t still_ticks = 0;        // the ball is slower than kStillSpeed
  std::uint64_t unreachable_ticks = 0;  // no man can touch the ball
  PerTeam possession_ticks{};           // of the team that touched last
  std::uint64_t longest_unreachable_ticks = 0;  // longest interval
  std::uint64_t longest_stuck_ticks = 0;        // within kStuckDistance, untouched

  // Goals and stops of play.
  PerTeam goals{};            // by scoring team
  PerTeam own_goals_swing{};  // by the team that touched last: the foot drove the ball towards its
                              // own goal
  PerTeam own_goals_deflected{};  // by the team that touched last: every other own goal
  PerTeam serves{};               // from the midfield
  PerTeam goals_of_server{};      // the team of the last serve scored; by that team
  PerTeam goals_of_receiver{};    // the other team scored; by the team of the last serve
  std::uint64_t dead_balls = 0;
  std::uint64_t balls_out = 0;
  std::uint64_t fouls = 0;

  std::array<std::array<std::uint64_t, 5>, kTeams> moving_ticks{};  // [team][rods in motion]
  PerRod hand_ticks{};
  PerRod slide_reversals{};
  PerRod swing_reversals{};
  PerRod spins{};  // full turns without contact with the ball

  // Play of the ball.
  PerTeam touches{};         // by one man, of any duration
  PerTeam passes{};          // see docs/match-runner.md
  PerTeam passes_meant{};    // to a chosen man (PlayedPass)
  PerTeam passes_arrived{};  // that man touched the ball next
  PerTeam shots{};
  PerTeam shots_on_target{};
  PerTeam saves{};                      // by the defending team
  Histogram<300, 100'000> shot_speed;   // [m/s]
  Histogram<500, 1'000> hop_height;     // height of the ball's underside above the ground [m]
  Histogram<200, 10'000> bounce_ratio;  // height after a bounce on the ground to that before
  Histogram<64, 1'000'000> rally;       // changes of team until play stopped

  std::uint64_t matches() const { return wins[0] + wins[1] + undecided; }
  void merge(const Statistics& other);
  bool operator==(const Statistics&) const = default;

  // Visits every count in a fixed order, with its name: visitor.sum(name, count) for a sum,
  // visitor.max(name, count) for a maximum.
  template <class Visitor, class Self>
  static void visit(Visitor& visitor, Self& self);
};

inline constexpr double kStillSpeed = 0.02;     // [m/s]
inline constexpr double kStuckDistance = 0.08;  // the referee's for a dead ball [m]

// Height of the ground at a point of the field [m]; the corners are raised.
double ground_height(const TableSpec& table, double x, double y);

// Observes any number of matches in sequence. Call it once per tick, in order, with the match's
// view and events after the step and the targets of that step.
class StatisticsObserver {
 public:
  void observe(const MatchView& view, std::span<const Event> events, const RodTargets& targets);
  // Announces that a player makes a pass in the next observed tick. Only the player knows its
  // intention.
  void meant(const PlayedPass& pass, Layout layout);
  // Abandons the current match: counts it as undecided if it has begun, and clears its state.
  void abandon();
  // Another match begins. Abandons the previous one if it is unfinished.
  void begin_match();
  const Statistics& totals() const { return totals_; }
  // Per team, since begin_match() [m/s]; 0: no shot.
  const std::array<double, kTeams>& fastest_shots() const { return fastest_shots_; }

 private:
  // A man's touch of the ball: all his contacts until another man has one or kTouchPause has
  // passed.
  struct Touch {
    int team = -1, rod = -1, man = -1;  // -1: none since the ball was put in play
    std::uint64_t since = 0, last = 0;  // [ticks]
    double arrival_vx = 0.0;            // of the ball, before the touch [m/s]
    double arrival_speed = 0.0;         // [m/s]
    double departure_vx = 0.0;          // of the ball, so far [m/s]
    double drive = 0.0;  // velocity of the foot towards its own goal on arrival at the ball, or the
                         // maximum that the hand has given it since [m/s]
    bool faced_shot = false;  // of a shot on target by the other team
    double stroke = 0.0;  // largest speed of the foot along the ball's direction of departure [m/s]
  };
  // Detects reversals of a hand on one axis.
  struct Reversals {
    double extreme = 0.0;
    int direction = 0;  // direction of motion: -1, +1; 0: not known yet
    bool update(double value, double hysteresis);
  };
  struct Rod {
    Reversals slide, swing;
    double spin_from = 0.0;  // angle at the last touch, full turn or change of direction [rad]
    Reversals spin;
    bool followed = false;
    double hand_angle = 0.0;       // the last target [rad]
    double hand_angle_rate = 0.0;  // its change per time in this tick [rad/s]
  };
  struct Shot {
    int team = -1;  // -1: none in progress
    bool on_target = false;
    double peak = 0.0;  // [m/s]
  };

  void begin_rally(const MatchView& view, const Event& serve);
  void end_rally();
  void note_events(const MatchView& view, std::span<const Event> events);
  void note_goal(int scorer);
  void note_match_won(const MatchView& view, int team);
  void watch_hands(const MatchView& view, const RodTargets& targets);
  void watch_ball(const MatchView& view, std::span<const Event> events);
  void find_touches(const MatchView& view, std::span<const Event> events);
  void touch(const MatchView& view, int rod, int man);
  void begin_touch(const MatchView& view, int rod, int man);
  void watch_pass(const MatchView& view);
  void watch_shot(const MatchView& view);
  void end_shot();
  void watch_height(const MatchView& view, std::span<const Event> events);
  void watch_reach(const MatchView& view);
  void watch_stuck(const MatchView& view);

  Statistics totals_;
  std::array<double, kTeams> fastest_shots_{};
  std::uint64_t now_ = 0;  // ticks observed
  bool begun_ = false;     // of a match
  int leader_ = -1;        // the last team in the lead
  int server_ = -1;        // team of the last serve from a midfield
  std::array<Rod, kRods> rods_{};

  bool in_play_ = false;      // the ball, in the previous tick
  vp::Vec3 velocity_before_;  // of the ball in the previous tick [m/s]
  ManStates men_before_{};    // in the previous tick
  Touch touch_, previous_touch_;
  bool touched_now_ = false;
  std::uint64_t rally_changes_ = 0;
  Shot shot_;
  int saver_ = -1;  // team that touched a shot on target; -1: none
  std::uint64_t saved_at_ = 0;
  PlayedPass meant_;        // in progress; to_rod < 0: none
  bool pass_open_ = false;  // a man received the ball from a team mate, who does not control it yet
  vp::Vec3 stuck_at_;
  std::uint64_t stuck_ticks_ = 0, unreachable_ticks_ = 0;
  bool airborne_ = false;
  bool falling_clean_ = false;  // no contact since the peak
  double peak_ = 0.0;           // of this hop [m]
  double bounced_from_ = 0.0;   // peak before the last landing; 0: not comparable [m]
  double rebound_ = 0.0;        // maximum since that landing [m]
  std::uint64_t landed_at_ = 0;
};

template <class Visitor, class Self>
void Statistics::visit(Visitor& visitor, Self& self) {
  const auto list = [&](const char* name, auto& counts) {
    for (auto& count : counts) visitor.sum(name, count);
  };
  list("wins", self.wins);
  visitor.sum("undecided", self.undecided);
  visitor.sum("lead_changes", self.lead_changes);
  list("length", self.length.bins);
  visitor.sum("ticks", self.ticks);
  visitor.sum("play_ticks", self.play_ticks);
  visitor.sum("ball_ticks", self.ball_ticks);
  visitor.sum("still_ticks", self.still_ticks);
  visitor.sum("unreachable_ticks", self.unreachable_ticks);
  list("possession_ticks", self.possession_ticks);
  visitor.max("longest_unreachable_ticks", self.longest_unreachable_ticks);
  visitor.max("longest_stuck_ticks", self.longest_stuck_ticks);
  list("goals", self.goals);
  list("own_goals_swing", self.own_goals_swing);
  list("own_goals_deflected", self.own_goals_deflected);
  list("serves", self.serves);
  list("goals_of_server", self.goals_of_server);
  list("goals_of_receiver", self.goals_of_receiver);
  visitor.sum("dead_balls", self.dead_balls);
  visitor.sum("balls_out", self.balls_out);
  visitor.sum("fouls", self.fouls);
  for (auto& team : self.moving_ticks) list("moving_ticks", team);
  list("hand_ticks", self.hand_ticks);
  list("slide_reversals", self.slide_reversals);
  list("swing_reversals", self.swing_reversals);
  list("spins", self.spins);
  list("touches", self.touches);
  list("passes", self.passes);
  list("passes_meant", self.passes_meant);
  list("passes_arrived", self.passes_arrived);
  list("shots", self.shots);
  list("shots_on_target", self.shots_on_target);
  list("saves", self.saves);
  list("shot_speed", self.shot_speed.bins);
  list("hop_height", self.hop_height.bins);
  list("bounce_ratio", self.bounce_ratio.bins);
  list("rally", self.rally.bins);
}

}  // namespace foosball
