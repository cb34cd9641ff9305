// Opens the real window, draws scripted moments and examines the pixels. Needs a display.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "render/scene.h"
#include "render_rig.h"
#include "scripted_scene.h"

namespace client {
namespace {

TEST_P(RenderTest, TheFieldIsTealWhereNothingStandsOnIt) {
  wire::Snapshot state = scripted_play(0.35);
  state.ball_in_play = false;
  const draw::Image image = draw(state);
  // Between the rods, off the markings, outside all shadows at this moment.
  for (const std::array<float, 3>& p :
       {std::array{0.02f, -0.28f, 0.0f}, std::array{-0.30f, 0.20f, 0.0f}}) {
    const glm::ivec2 at = pixel_of(p);
    const glm::vec3 c = mean(image, at - 3, at + 3);
    EXPECT_GT(c.g, c.r + 15) << c.r << " " << c.g << " " << c.b;
    EXPECT_GT(c.b, c.r + 15);
    EXPECT_GT(c.g, 45);
    EXPECT_LT(c.g, 190);
  }
}

TEST_P(RenderTest, TheBallIsWhereItsPixelsAre) {
  for (const double moment : {0.35, 1.62, 2.4}) {
    wire::Snapshot with = scripted_play(moment);
    with.ball.position = {0.05f + 0.2f * static_cast<float>(moment), -0.24f, 0.0173f};
    wire::Snapshot without = with;
    without.ball_in_play = false;
    const glm::ivec2 at = pixel_of(with.ball.position);
    const draw::Image image = draw(with), empty = draw(without);
    EXPECT_GT(changed(image, empty, at, 8), 60) << moment;
    const glm::vec3 c = mean(image, at - 5, at + 5);
    EXPECT_GT(std::min({c.r, c.g, c.b}), 75.0f) << moment;  // white with dark patches, on dark teal
    EXPECT_LT(changed(image, empty, {kSize.x / 8, kSize.y / 2}, 30), 5);
  }
}

TEST_P(RenderTest, TheFieldMirrorsWhatIsAboveItAndNothingWhereNothingIs) {
  wire::Snapshot with = scripted_play(0.35);
  with.ball.position = {0.12f, -0.05f, 0.06f};
  wire::Snapshot without = with;
  without.ball_in_play = false;
  const draw::Image image = draw(with), empty = draw(without);
  const glm::ivec2 mirrored = pixel_of({0.12f, -0.05f, -0.06f}),
                   beside = pixel_of({0.16f, -0.15f, 0});
  const auto brighter = [&](glm::ivec2 at) {
    const glm::vec3 more = mean(image, at - 2, at + 3) - mean(empty, at - 2, at + 3);
    return (more.r + more.g + more.b) / 3.0f;
  };
  EXPECT_GT(brighter(mirrored), 8.0f);
  EXPECT_LT(std::abs(brighter(beside)), 2.0f);
}

TEST_P(RenderTest, MenAreAtTheirPlacesInTheirTeamsColours) {
  for (const double moment : {0.35, 1.62, 2.4}) {
    wire::Snapshot state = scripted_play(moment);
    state.ball_in_play = false;
    wire::Snapshot nobody = state;
    nobody.men.clear();
    const draw::Image image = draw(state), empty = draw(nobody);
    const auto& table = foosball::table_spec(foosball::Layout::tournament);
    for (const wire::ManState& man : state.men) {
      const glm::ivec2 at = pixel_of(man.body.position);
      if (at.y < 70) continue;
      EXPECT_GT(changed(image, empty, at, 14), 40)
          << moment << " rod " << int{man.rod} << " man " << int{man.man};
      int orange = 0, blue = 0;
      for (int y = at.y - 20; y < at.y + 20; ++y) {
        for (int x = at.x - 20; x < at.x + 20; ++x) {
          const glm::ivec3 c = image.at(x, y), before = empty.at(x, y);
          if (c == before) continue;
          orange += c.r > c.b + 40;
          blue += c.b > c.r + 60;
        }
      }
      const bool first_team = table.rods[man.rod].team == 0;
      EXPECT_GT(first_team ? orange : blue, 8)
          << moment << " rod " << int{man.rod} << " man " << int{man.man};
    }
  }
}

TEST_P(RenderTest, AManThatMovesLeavesHisPlace) {
  wire::Snapshot here = scripted_play(0.0), there = here;
  here.ball_in_play = there.ball_in_play = false;
  for (auto* s : {&here, &there}) {
    for (auto& rod : s->rods) rod.slide = rod.angle = 0;
  }
  there.rods[3].slide = 0.06f;
  place_men(here);
  place_men(there);
  const draw::Image a = draw(here), b = draw(there);
  const wire::ManState &moved = here.men[8], &still = here.men[4];
  ASSERT_EQ(moved.rod, 3);
  ASSERT_EQ(still.rod, 2);
  EXPECT_GT(changed(a, b, pixel_of(moved.body.position), 14), 60);
  EXPECT_EQ(changed(a, b, pixel_of(still.body.position), 6), 0);
}

// The longest time during which less than half of the ball is visible, over scripted play [s].
double longest_hidden(Scene& scene, foosball::Layout layout, int team, View kind) {
  constexpr double kStep = 0.06;
  constexpr glm::ivec2 kPicture{400, 225};
  const CameraView from{.layout = layout, .team = team};
  double hidden = 0.0, longest = 0.0;
  for (double t = 0.0; t < 8.0; t += kStep) {
    wire::Snapshot state = scripted_play(t, layout);
    // Half of the time on the field's surface, where feet hide most of it.
    if (std::fmod(t, 2.0) < 1.0) state.ball.position[2] = 0.0173f;
    SceneView view;
    const auto& at = state.ball.position;
    view.camera = kind == View::above ? above_camera(foosball::table_spec(layout), team, kPicture)
                  : kind == View::follow ? follow_camera(from, {at[0], at[1], at[2]}, kPicture)
                                         : player_camera(from, kPicture);
    const float seen = scene.ball_visibility(state, view, kPicture);
    hidden = seen < 0.5f ? hidden + kStep : 0.0;
    longest = std::max(longest, hidden);
  }
  return longest;
}

// Men and rods in front of the ball become transparent: it is never more than half hidden for
// longer than 0.3 s, in any view for play, from either side. The paper's layout has 32 men.
TEST_P(RenderTest, TheBallIsSeenInEveryViewMeantForPlay) {
  if (GetParam() == draw::Quality::high) GTEST_SKIP() << "the same places are left out";
  for (const auto layout : {foosball::Layout::tournament, foosball::Layout::paper}) {
    for (const auto& [name, kind] : {std::pair("seat", View::seat), std::pair("above", View::above),
                                     std::pair("follow", View::follow)}) {
      for (int team = 0; team < 2; ++team) {
        const double longest = longest_hidden(*scene, layout, team, kind);
        std::printf("%s of team %d, layout %d: below half for %.2f s at most\n", name, team,
                    static_cast<int>(layout), longest);
        EXPECT_LE(longest, 0.3) << name << " of team " << team << ", layout "
                                << static_cast<int>(layout);
      }
    }
  }
}

TEST_P(RenderTest, TheBallLooksLargerWithHeightAndLiesInTheGoalAfterIt) {
  const auto& table = foosball::table_spec(foosball::Layout::tournament);
  const auto radius = static_cast<float>(table.ball_radius);
  EXPECT_EQ(Scene::drawn_ball_radius(table, radius), radius);
  EXPECT_GT(Scene::drawn_ball_radius(table, radius + 0.030f), 1.2f * radius);
  EXPECT_LT(Scene::drawn_ball_radius(table, 5.0f), (1.001f + kMaxBallGrowth) * radius);
  wire::Snapshot state = scripted_play(0.35);
  state.screen = 3;
  state.ball_in_play = false;
  state.ball_visible = true;
  state.ball.position = {0.655f, 0.03f, radius};
  wire::Snapshot parked = state;
  parked.ball_visible = false;
  EXPECT_TRUE(ball_is_seen(state));
  EXPECT_FALSE(ball_is_seen(parked));
  camera = above_camera(table, 0, kSize);
  EXPECT_GT(changed(draw(state), draw(parked), pixel_of(state.ball.position), 12), 60);
}

TEST_P(RenderTest, HandlesOutsideTheScreenShiftRodsWithTheirMenAndTheBall) {
  std::array<float, 8> shift{};
  shift[3] = 0.02f;
  wire::Snapshot state = scripted_play(0.35);
  const auto& table = foosball::table_spec(foosball::Layout::tournament);
  state.ball.position[0] = static_cast<float>(table.rods[3].x);
  const wire::Snapshot before = state;
  shift_scene(state, shift);
  EXPECT_NEAR(state.ball.position[0], before.ball.position[0] + 0.02f, 1e-6);
  for (std::size_t i = 0; i < state.men.size(); ++i) {
    EXPECT_NEAR(state.men[i].body.position[0] - before.men[i].body.position[0],
                state.men[i].rod == 3 ? 0.02f : 0.0f, 1e-6);
  }
}

TEST_P(RenderTest, ThePaperLayoutHasFourMenOnEachRod) {
  wire::Snapshot state = scripted_play(0.35, foosball::Layout::paper);
  state.ball_in_play = false;
  ASSERT_EQ(state.men.size(), 32u);
  wire::Snapshot nobody = state;
  nobody.men.clear();
  const draw::Image image = draw(state), empty = draw(nobody);
  for (const wire::ManState& man : state.men) {
    const glm::ivec2 at = pixel_of(man.body.position);
    EXPECT_GT(changed(image, empty, at, 14), 40)
        << "rod " << int{man.rod} << " man " << int{man.man};
  }
}

TEST_P(RenderTest, FromAboveTheHeadOfAnUprightManIsOfHisTeamsColour) {
  const auto& table = foosball::table_spec(foosball::Layout::tournament);
  camera = above_camera(table, 0, kSize);
  const auto characters = static_cast<std::uint8_t>(foosball::built_in_characters().size());
  for (std::uint8_t character = 0; character < characters; ++character) {
    wire::Snapshot state = scripted_play(0.35);
    state.ball_in_play = false;
    state.character = {character, character};
    for (auto& rod : state.rods) rod.slide = rod.angle = 0.0f;
    place_men(state);
    const draw::Image image = draw(state);
    std::array<int, 2> of_team{}, pixels{};
    for (const wire::ManState& man : state.men) {
      const auto team = static_cast<std::size_t>(table.rods[man.rod].team);
      const glm::ivec2 at = pixel_of(man.body.position);
      for (int y = at.y - 4; y <= at.y + 4; ++y) {
        for (int x = at.x - 4; x <= at.x + 4; ++x) {
          const glm::ivec3 c = image.at(x, y);
          of_team[team] += team == 0 ? c.r > c.b + 25 : c.b > c.r + 25;
          ++pixels[team];
        }
      }
    }
    for (std::size_t team = 0; team < 2; ++team) {
      const double share = static_cast<double>(of_team[team]) / pixels[team];
      std::printf("character %d, team %zu: %.0f %%\n", int{character}, team, 100.0 * share);
      EXPECT_GT(share, 0.5) << int{character} << " of team " << team;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothQualities, RenderTest,
                         ::testing::Values(draw::Quality::low, draw::Quality::high),
                         [](const auto& which) {
                           return which.param == draw::Quality::low ? "low" : "high";
                         });

}  // namespace
}  // namespace client
