// The counts of a match, from scripted views with one possible interpretation each, and from
// complete matches.
#include "foosball/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bodies.h"
#include "foosball/computer_player.h"

namespace foosball {
namespace {

using vp::Vec3;

// A match scripted tick by tick.
struct Script {
  StatisticsObserver observer;
  MatchView view;
  RodTargets hands{};
  std::vector<Event> events;

  Script() {
    view.screen = Screen::play;
    view.layout = Layout::tournament;
    view.character = {1, 1};
    view.ball_position = {0.0, 0.0, table().ball_radius};
  }
  const TableSpec& table() const { return table_spec(view.layout); }
  const Statistics& totals() const { return observer.totals(); }
  // The ball moves with its velocity.
  void tick(int count = 1) {
    for (int i = 0; i < count; ++i) {
      view.ball_position = view.ball_position + kTick * view.ball_velocity;
      for (int rod = 0; rod < kRods; ++rod) {
        view.men[rod].fill({view.rods[rod].angle, view.rods[rod].angle_rate});
      }
      observer.observe(view, events, hands);
      events.clear();
    }
  }
  void serve(int team) {
    view.ball_in_play = true;
    const RodSpec& rod = table().rods[rods_of_team(table(), team)[2]];
    view.ball_position = {rod.x + attack_sign(team) * 0.05, 0.075, table().ball_radius};
    view.ball_velocity = {};
    event(EventKind::serve, team);
    tick();
  }
  void event(EventKind kind, int team, int rod = 0, int man = 0) {
    events.push_back({kind, static_cast<std::uint8_t>(team), static_cast<std::uint8_t>(rod),
                      static_cast<std::uint8_t>(man), 0.0, view.ball_position});
  }
  // A man of the rod hits the ball. foot: velocity of his foot along x there.
  void hit(int rod, int man, double foot, const Vec3& velocity) {
    const double angle_rate = foot / (table().ball_radius - table().rod_height);
    view.rods[rod].angle_rate = angle_rate;
    tick();
    meet(rod, man, angle_rate, velocity);
    view.rods[rod].angle_rate = 0.0;
  }
  // The same in the tick of the contact. Before it the rod has the view's angular rate.
  void meet(int rod, int man, double angle_rate, const Vec3& velocity) {
    view.ball_position = {table().rods[rod].x, 0.075, table().ball_radius};
    view.rods[rod].angle_rate = angle_rate;
    view.ball_velocity = velocity;
    event(EventKind::man_hit, table().rods[rod].team, rod, man);
    tick();
  }
  void goal(int team) {
    ++view.score[team];
    view.ball_in_play = false;
    event(EventKind::goal, team);
    tick();
  }
};

int rod_of(int team, Line line) {
  return rods_of_team(table_spec(Layout::tournament), team)[static_cast<std::size_t>(line)];
}

TEST(Statistics, AFootThatDrivesTheBallTowardsItsOwnGoalScoresAnOwnGoalBySwing) {
  Script script;
  script.serve(0);
  script.hit(rod_of(0, Line::defence), 0, -1.0, {-3.0, 0.0, 0.0});
  script.goal(1);
  EXPECT_EQ(script.totals().own_goals_swing, (PerTeam{1, 0}));
  EXPECT_EQ(script.totals().own_goals_deflected, (PerTeam{0, 0}));
  EXPECT_EQ(script.totals().goals, (PerTeam{0, 1}));
}

TEST(Statistics, AStillFootOrOneThatOnlySlowsTheShotDeflectsIt) {
  for (const double foot : {0.0, -1.0}) {
    Script script;
    script.serve(1);
    script.view.ball_velocity = {-6.0, 0.0, 0.0};  // not a shot
    script.tick();
    script.hit(rod_of(0, Line::goalie), 0, foot, {-4.0, 0.0, 0.0});
    script.goal(1);
    EXPECT_EQ(script.totals().own_goals_swing, (PerTeam{0, 0}));
    EXPECT_EQ(script.totals().own_goals_deflected, (PerTeam{1, 0}));
  }
}

// The rebounding ball pushes a hanging foot back.
TEST(Statistics, AFootThatIsMovedByTheBallDoesNotSwing) {
  Script script;
  script.serve(0);
  script.view.ball_velocity = {2.0, 0.0, 0.0};  // from behind
  script.tick();
  constexpr double kKnockedBack = 10.0;  // [rad/s]
  script.meet(rod_of(0, Line::attack), 0, kKnockedBack, {-2.0, 0.0, 0.0});
  script.tick(10);
  script.goal(1);
  EXPECT_EQ(script.totals().own_goals_swing, (PerTeam{0, 0}));
  EXPECT_EQ(script.totals().own_goals_deflected, (PerTeam{1, 0}));
}

TEST(Statistics, AShotOnTargetThatGoesInOffADefenderIsTheShootersGoal) {
  Script script;
  script.serve(1);
  script.hit(rod_of(1, Line::attack), 1, -5.0, {-6.0, 0.0, 0.0});
  script.tick(5);
  script.hit(rod_of(0, Line::goalie), 0, 0.0, {-4.0, 0.0, 0.0});
  script.goal(1);
  EXPECT_EQ(script.totals().own_goals_deflected, (PerTeam{0, 0}));
  EXPECT_EQ(script.totals().saves, (PerTeam{0, 0}));
}

TEST(Statistics, AGoalOfTheLastToucherIsNoOwnGoal) {
  Script script;
  script.serve(0);
  script.hit(rod_of(0, Line::attack), 0, 3.0, {6.0, 0.0, 0.0});
  script.goal(0);
  EXPECT_EQ(script.totals().own_goals_swing, (PerTeam{0, 0}));
  EXPECT_EQ(script.totals().own_goals_deflected, (PerTeam{0, 0}));
  EXPECT_EQ(script.totals().shots, (PerTeam{1, 0}));
  EXPECT_EQ(script.totals().shots_on_target, (PerTeam{1, 0}));
  EXPECT_NEAR(script.totals().shot_speed.quantile(0.5), 6.0, 0.1);
}

TEST(Statistics, GoalsAreOfTheServerOrOfTheReceiverOfTheLastServe) {
  Script script;
  script.serve(0);
  script.goal(0);
  script.serve(1);
  script.goal(0);
  script.serve(1);
  script.serve(0);  // after a dead ball
  script.goal(1);
  EXPECT_EQ(script.totals().serves, (PerTeam{2, 2}));
  EXPECT_EQ(script.totals().goals_of_server, (PerTeam{1, 0}));
  EXPECT_EQ(script.totals().goals_of_receiver, (PerTeam{1, 1}));
}

TEST(Statistics, LeadChangesWhenItPassesToTheOtherSideAndNotAtEqual) {
  Script script;
  script.tick();
  for (const int scorer : {0, 1, 0, 1, 1, 1, 0}) script.goal(scorer);  // 1:0 .. 2:3, 2:4, 3:4
  EXPECT_EQ(script.totals().lead_changes, 1u);
}

TEST(Statistics, AHandThatGoesToAndFroReversesTwiceAPeriodAndTremorDoesNot) {
  Script script;
  script.hands[3].live = true;
  script.hands[5].live = true;
  for (int i = 0; i < 4000; ++i) {
    const double phase = 2.0 * vp::kPi * i * kTick;  // 1 Hz
    script.hands[3].slide = 0.05 * std::sin(phase);
    script.hands[3].angle = 0.5 * std::sin(2.0 * phase);
    script.hands[5].slide = 0.002 * std::sin(5.0 * phase);
    script.tick();
  }
  EXPECT_NEAR(static_cast<double>(script.totals().slide_reversals[3]), 8.0, 1.0);
  EXPECT_NEAR(static_cast<double>(script.totals().swing_reversals[3]), 16.0, 1.0);
  EXPECT_EQ(script.totals().slide_reversals[5], 0u);
  EXPECT_EQ(script.totals().hand_ticks[3], 4000u);
  EXPECT_EQ(script.totals().hand_ticks[0], 0u);
}

TEST(Statistics, RodsThatMoveAtOnceAreCountedForEachTeam) {
  Script script;
  for (auto& hand : script.hands) hand.live = true;
  for (const Line line : {Line::goalie, Line::attack, Line::midfield}) {
    script.view.rods[rod_of(0, line)].slide_rate = 0.1;
  }
  script.view.rods[rod_of(1, Line::attack)].angle_rate = -2.0;
  script.view.rods[rod_of(1, Line::goalie)].angle_rate = 0.5;  // coming to rest
  script.tick(10);
  EXPECT_EQ(script.totals().moving_ticks[0][3], 10u);
  EXPECT_EQ(script.totals().moving_ticks[1][1], 10u);
}

TEST(Statistics, AFullTurnWithoutTheBallIsASpinAndATouchBeginsItAnew) {
  Script script;
  const int rod = rod_of(0, Line::midfield);
  script.serve(0);
  script.hands[rod].live = true;
  for (int i = 0; i < 2000; ++i) {  // 3.2 turns
    script.view.rods[rod].angle = 0.01 * i;
    script.tick();
  }
  EXPECT_EQ(script.totals().spins[rod], 3u);
  script.event(EventKind::man_hit, 0, rod, 2);
  for (int i = 2000; i < 2600; ++i) {  // less than a turn since the touch
    script.view.rods[rod].angle = 0.01 * i;
    script.tick();
  }
  EXPECT_EQ(script.totals().spins[rod], 3u);
}

TEST(Statistics, SwingingToAndFroIsNoSpin) {
  Script script;
  script.hands[0].live = true;
  for (int i = 0; i < 20000; ++i) {
    script.view.rods[0].angle = 3.0 * std::sin(0.005 * i);
    script.tick();
  }
  EXPECT_EQ(script.totals().spins[0], 0u);
}

TEST(Statistics, APassIsStruckByOneManAndControlledByAnother) {
  const int defence = rod_of(0, Line::defence), midfield = rod_of(0, Line::midfield);
  const auto passes = [&](double foot, double speed_after, int receiver) {
    Script script;
    script.serve(0);
    script.hit(defence, 0, foot, {2.0, 0.0, 0.0});
    script.tick(60);
    script.hit(receiver, 0, 0.0, {speed_after, 0.0, 0.0});
    script.tick(20);
    return script.totals().passes[0];
  };
  EXPECT_EQ(passes(1.0, 0.1, midfield), 1u);
  EXPECT_EQ(passes(0.0, 0.1, midfield), 0u);   // bounced off the first
  EXPECT_EQ(passes(1.0, -1.8, midfield), 0u);  // bounced off the second
  EXPECT_EQ(passes(1.0, 0.1, rod_of(1, Line::attack)), 0u);
}

TEST(Statistics, AShotOnTargetThatADefenderTouchesAndDoesNotGoInIsASave) {
  for (const bool goes_in : {false, true}) {
    Script script;
    script.serve(1);
    const int attack = rod_of(1, Line::attack);
    script.hit(attack, 1, -5.0, {-5.0, 0.0, 0.0});
    script.tick(5);
    script.hit(rod_of(0, Line::goalie), 0, 0.0, {goes_in ? -1.0 : 1.0, 0.0, 0.0});
    if (goes_in) script.goal(1);
    script.view.ball_velocity = {};
    script.tick(600);
    EXPECT_EQ(script.totals().saves, (PerTeam{goes_in ? 0u : 1u, 0}));
    EXPECT_EQ(script.totals().shots_on_target[1], 1u);
  }
}

TEST(Statistics, ARallyCountsHowOftenTheBallChangedTeams) {
  Script script;
  script.serve(0);
  script.hit(rod_of(0, Line::midfield), 2, 1.0, {1.0, 0.0, 0.0});
  script.hit(rod_of(1, Line::midfield), 2, -1.0, {-1.0, 0.0, 0.0});
  script.hit(rod_of(0, Line::midfield), 2, 1.0, {1.0, 0.0, 0.0});
  script.goal(0);
  EXPECT_EQ(script.totals().rally.bins[2], 1u);
  EXPECT_EQ(script.totals().touches, (PerTeam{2, 1}));
}

TEST(Statistics, AHopIsAsHighAsItsPeakAndABounceComparesTwo) {
  Script script;
  script.serve(0);
  const double ground = script.table().ball_radius, g = 14.0, height = 0.1, ratio = 0.3;
  script.view.ball_position = {0.0, 0.3, ground + height};
  const auto fall = [&](double speed) {  // until it lands
    script.view.ball_velocity = {0.0, 0.0, speed};
    do {
      script.view.ball_velocity.z -= g * kTick;
      script.tick();
    } while (script.view.ball_position.z > ground);
  };
  fall(0.0);
  script.view.ball_position.z = ground;
  fall(std::sqrt(2.0 * g * height * ratio));
  script.view.ball_position.z = ground;
  script.view.ball_velocity = {};
  script.tick(100);
  EXPECT_EQ(script.totals().hop_height.count(), 2u);
  EXPECT_NEAR(script.totals().hop_height.quantile(1.0), height, 0.002);
  EXPECT_NEAR(script.totals().bounce_ratio.quantile(0.01), 0.0, 0.03);  // second: no bounce
  EXPECT_NEAR(script.totals().bounce_ratio.quantile(1.0), ratio, 0.03);
}

TEST(Statistics, ABallThatNobodyTouchesIsStuckForAsLongAsItStays) {
  Script script;
  script.serve(0);
  script.view.ball_position = {0.075 * 2.0, 0.3, script.table().ball_radius};  // between two rods
  script.tick(1500);
  script.view.ball_velocity = {1.0, 0.0, 0.0};
  script.tick(200);
  EXPECT_NEAR(static_cast<double>(script.totals().longest_stuck_ticks), 1580.0, 5.0);
  EXPECT_GE(script.totals().still_ticks, 1500u);
}

// As the referee counts: the touch restarts the time, but the reference point stays where the ball
// was before.
TEST(Statistics, ATouchBeginsTheTimeOfAStuckBallAgainAndNotItsPlace) {
  Script script;
  script.serve(0);
  script.view.ball_position = {0.075 * 2.0, -0.1, script.table().ball_radius};
  script.view.ball_velocity = {0.0, 0.02, 0.0};  // 80 mm in 4 s
  script.tick(2000);
  script.event(EventKind::man_hit, 0, rod_of(0, Line::midfield), 2);
  script.tick(3900);
  EXPECT_NEAR(static_cast<double>(script.totals().longest_stuck_ticks), 2000.0, 5.0);
}

// --- reach ---------------------------------------------------------------------------------------

bool some_pose_touches(const TableSpec& table, int rod, const CharacterBody& body, const Vec3& ball,
                       double radius) {
  const RodSpec& spec = table.rods[rod];
  constexpr int kSteps = 160;
  for (int man = 0; man < spec.men; ++man) {
    const double slide =
        std::clamp(ball.y - man_offset(spec, man), -spec.slide_limit, spec.slide_limit);
    for (int i = 0; i < kSteps; ++i) {
      const vp::SE3 T = man_pose(table, rod, man, {slide, 2.0 * vp::kPi * i / kSteps, 0.0, 0.0});
      const Vec3 p = vp::inverse_times(T, ball);
      for (const ManBox& box : boxes_of(body)) {
        if (box.part != ManBox::Part::foot) continue;
        const Vec3 d{std::max(0.0, std::fabs(p.x - box.centre.x) - box.half_extents.x),
                     std::max(0.0, std::fabs(p.y - box.centre.y) - box.half_extents.y),
                     std::max(0.0, std::fabs(p.z - box.centre.z) - box.half_extents.z)};
        if (vp::norm(d) <= radius) return true;
      }
    }
  }
  return false;
}

TEST(Reach, IsThatOfTheBestOfAllSlidesAndAngles) {
  for (const Layout layout : {Layout::paper, Layout::tournament}) {
    const TableSpec& table = table_spec(layout);
    const double r = table.ball_radius;
    int reached = 0, compared = 0;
    for (int i = 0; i < 600; ++i) {  // low-discrepancy points, only those at a foot's height
      const double u = std::fmod(0.5 + i * 0.7548776662466927, 1.0);
      const double v = std::fmod(0.5 + i * 0.5698402909980532, 1.0);
      const Vec3 ball{(u - 0.5) * 1.16, (v - 0.5) * 0.64, r + 0.002 * (i % 10)};
      for (int rod = 0; rod < kRods; ++rod) {
        const CharacterBody& body = built_in(i % built_in_count());
        const bool can = can_reach(table, rod, body, ball);
        if (some_pose_touches(table, rod, body, ball, r)) {
          EXPECT_TRUE(can) << i << ' ' << rod;
        }
        if (can) {
          EXPECT_TRUE(some_pose_touches(table, rod, body, ball, r + 0.0005)) << i << ' ' << rod;
        }
        reached += can ? 1 : 0;
        ++compared;
      }
    }
    EXPECT_GT(reached, compared / 20);
  }
}

TEST(Reach, OfARestingBallEndsWhereTheFootsEdgePassesOverIt) {
  const TableSpec& table = table_spec(Layout::tournament);
  const RodSpec& rod = table.rods[3];
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(can_reach(
        table, 3, built_in(1),
        {rod.x + side * (field_reach(table, built_in(1)) - 0.001), 0.0, table.ball_radius}));
    EXPECT_FALSE(can_reach(
        table, 3, built_in(1),
        {rod.x + side * (field_reach(table, built_in(1)) + 0.001), 0.0, table.ball_radius}));
  }
}

TEST(Reach, GroundRisesInTheCornersOnly) {
  const TableSpec& table = table_spec(Layout::tournament);
  const double x = 0.5 * table.length, y = 0.5 * table.width;
  EXPECT_EQ(ground_height(table, 0.0, y), 0.0);
  EXPECT_DOUBLE_EQ(ground_height(table, -x, y), table.corner_rise);
  EXPECT_NEAR(ground_height(table, x - 0.07, y - 0.07), 0.0, 1e-12);
  EXPECT_NEAR(ground_height(table, x - 0.035, 0.035 - y), 0.5 * table.corner_rise, 1e-12);
}

// --- totals --------------------------------------------------------------------------------------

TEST(Histogram, QuantilesAreLinearWithinABin) {
  Histogram<10, 1'000'000> h;
  EXPECT_EQ(h.quantile(0.5), 0.0);
  for (int i = 0; i < 8; ++i) h.add(i);
  EXPECT_DOUBLE_EQ(h.quantile(0.5), 4.0);
  EXPECT_DOUBLE_EQ(h.quantile(1.0), 8.0);
  EXPECT_DOUBLE_EQ(h.mean(), 4.0);
  h.add(-1.0);
  h.add(1e9);
  EXPECT_EQ(h.bins[0], 2u);
  EXPECT_EQ(h.bins[9], 1u);
}

Statistics watch(std::uint64_t seed, int ticks) {
  Match match = *Match::create({.layout = Layout::tournament, .seed = seed, .rules = {}});
  ComputerPlayer home({.team = 0, .seed = 2 * seed, .player = *parse_player("classic:0.6")});
  ComputerPlayer away({.team = 1, .seed = 2 * seed + 1, .player = *parse_player("classic:0.6")});
  TickInput input;
  StatisticsObserver observer;
  for (int i = 0; i < ticks; ++i) {
    home.play(match.view(), input.rods);
    away.play(match.view(), input.rods);
    match.step(input);
    observer.observe(match.view(), match.events(), input.rods);
  }
  return observer.totals();
}

TEST(Statistics, OfTwoMatchesAddUpInAnyOrder) {
  const Statistics a = watch(1, 20000), b = watch(2, 15000);
  Statistics ab = a, ba = b;
  ab.merge(b);
  ba.merge(a);
  EXPECT_EQ(ab, ba);
  EXPECT_EQ(ab.ticks, 35000u);
  EXPECT_EQ(ab.ball_ticks, a.ball_ticks + b.ball_ticks);
  EXPECT_EQ(ab.longest_stuck_ticks, std::max(a.longest_stuck_ticks, b.longest_stuck_ticks));
  EXPECT_GT(a.touches[0] + a.touches[1], 20u);
  EXPECT_LE(a.unreachable_ticks, a.ball_ticks);
  EXPECT_NEAR(static_cast<double>(a.possession_ticks[0] + a.possession_ticks[1]),
              static_cast<double>(a.ball_ticks), 0.3 * static_cast<double>(a.ball_ticks));
}

}  // namespace
}  // namespace foosball
